//! Scenes that contradict themselves are typed errors that name the thing.

use std::error::Error as _;

use carom::hybrid::scene::{
    Body, DamageMeasure, DamageRule, Scene, SceneError, Shape, Solid, Surface,
};
use carom::hybrid::{Region, Restitution};
use carom::interval::Interval;
use carom::{Error, ErrorKind};

fn body() -> Body {
    Body::new("puck", [Interval::new(0.0, 2.0); 2], 3.0, 3.0)
}

fn refused(scene: &Scene) -> SceneError {
    let error = scene.program(4).unwrap_err();
    error.source().and_then(|source| source.downcast_ref::<SceneError>()).unwrap().clone()
}

fn error(scene: &Scene) -> Error {
    scene.hybrid_system().unwrap_err()
}

fn with(obstacle: Solid) -> Scene {
    Scene::new(0.1).with_body(body()).with_obstacle(obstacle)
}

#[test]
fn obstacles_without_inside_or_extent() {
    let avoid = Surface::avoid();
    let crossed = [([1.0, 0.0], 0.0), ([-1.0, 0.0], -1.0)];
    let found = refused(&with(Solid::polytope("slit", crossed, avoid)));
    assert_eq!(found, SceneError::Crossed { obstacle: "slit".into() });
    let cut = [
        ([1.0, 0.0], 1.0),
        ([-1.0, 0.0], 0.0),
        ([0.0, 1.0], 1.0),
        ([0.0, -1.0], 0.0),
        ([1.0, 0.0], 3.0),
    ];
    let found = refused(&with(Solid::polytope("box", cut, avoid)));
    assert_eq!(found, SceneError::NoExtent { obstacle: "box".into(), face: 4 });
    let found = refused(&with(Solid::halfspace("wall", [0.0, 0.0], 0.0, avoid)));
    assert_eq!(found, SceneError::Normal { obstacle: "wall".into(), face: 0 });
    let found = refused(&with(Solid::halfspace("wall", [1.0], 0.0, avoid)));
    assert_eq!(found, SceneError::Axes { name: "wall".into(), found: 1, expected: 2 });
}

#[test]
fn bodies_inside_obstacles() {
    let pillar = Solid::cuboid("pillar", &[Interval::new(0.5, 1.0); 2], Surface::avoid());
    let inside = |x: f64| Region::point([x, x, 0.0, 0.0]);
    let scene = Scene::new(0.1).with_obstacle(pillar);
    let starts = scene.clone().with_body(body().with_start(inside(0.7)));
    let expected =
        SceneError::Inside { body: "puck".into(), end: "starts", obstacle: "pillar".into() };
    assert_eq!(refused(&starts), expected);
    // A disc needs more room than a point.
    let near = body().with_goal(Region::point([0.45, 0.7, 0.0, 0.0]));
    assert!(scene.clone().with_body(near.clone()).hybrid_system().is_ok());
    let disc = scene.with_body(near.with_shape(Shape::Ball(0.1)));
    assert!(matches!(refused(&disc), SceneError::Inside { end: "ends", .. }));
}

#[test]
fn courses_that_end_too_soon() {
    let gate = Solid::halfspace("gate", [1.0, 0.0], -1.0, Surface::avoid());
    let course = (0..4).map(|t| [0.1 * f64::from(t), 0.0]);
    let found = refused(&with(gate.with_course(course)));
    assert_eq!(found, SceneError::Course { obstacle: "gate".into(), last: 3, needed: 4 });
}

#[test]
fn numbers_out_of_range() {
    let scene = |body| Scene::new(0.1).with_body(body);
    let kinds = [
        error(&scene(body().with_mass(0.0))),
        error(&scene(body().with_shape(Shape::Ball(-1.0)))),
        error(&Scene::new(0.0).with_body(body())),
        error(&Scene::new(0.1)),
        error(
            &scene(body())
                .with_rule(DamageRule::new("r", DamageMeasure::ImpactSpeed).with_incidence(2.0)),
        ),
    ];
    for error in kinds {
        assert!(matches!(error.kind(), ErrorKind::OutOfRange { .. }), "{error}");
    }
    let bounce = Surface::bounce(Restitution::new(0.5).unwrap());
    for surface in [bounce.with_friction(-1.0), bounce.with_linear_map(1.5, 0.0)] {
        let found = refused(&with(Solid::halfspace("wall", [1.0, 0.0], -1.0, surface)));
        assert!(matches!(found, SceneError::Surface { obstacle, .. } if obstacle == "wall"));
    }
}

#[test]
fn names_that_nothing_has() {
    let scene = Scene::new(0.1).with_body(body());
    let pair = scene.clone().with_pair("puck", "ghost", Surface::avoid());
    assert!(matches!(error(&pair).kind(), ErrorKind::UnknownName { name, .. } if name == "ghost"));
    let rule = DamageRule::new("r", DamageMeasure::ImpactSpeed).with_obstacle("ghost");
    let rule = error(&scene.with_rule(rule));
    assert!(matches!(rule.kind(), ErrorKind::UnknownName { name, .. } if name == "ghost"));
}
