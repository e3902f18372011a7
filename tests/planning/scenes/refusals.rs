//! Scenes that contradict themselves are typed errors that name the thing.

use carom::ErrorKind;
use carom::hybrid::scene::{
    Body, DamageMeasure, DamageRule, Scene, SceneError, Shape, Solid, Surface,
};
use carom::hybrid::{ImpactEstimate, Region, Restitution};
use carom::interval::Interval;
use carom::prelude::*;

fn body() -> Body {
    Body::new("puck", [Interval::new(0.0, 2.0); 2], 3.0, 3.0)
}

fn refused(scene: &Scene) -> SceneError {
    let error = scene.program(4).unwrap_err();
    let ErrorKind::Scene(own) = error.kind() else { panic!("{error}") };
    own.clone()
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
    let pillar = Solid::cuboid("pillar", [Interval::new(0.5, 1.0); 2], Surface::avoid());
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
fn handles_and_names_that_nothing_has() {
    let scene = Scene::new(0.1).with_body(body());
    let ghost = scene.body_named("ghost").unwrap_err();
    assert!(matches!(ghost.kind(), ErrorKind::UnknownName { name, .. } if name == "ghost"));
    assert!(scene.obstacle_named("puck").is_err());
    // Handles of another scene.
    let mut other = Scene::new(0.1);
    let foreign = other.body(body()).unwrap();
    let wall = Solid::halfspace("wall", [1.0, 0.0], -1.0, Surface::avoid());
    let wall = other.obstacle(wall).unwrap();
    let is_foreign = |error: Error, own: &str| match error.kind() {
        ErrorKind::ForeignHandle { kind, .. } => assert_eq!(*kind, own),
        other => panic!("{other:?}"),
    };
    let puck = scene.body_named("puck").unwrap();
    let mut paired = scene.clone();
    is_foreign(paired.pair(puck, foreign, Surface::avoid()).unwrap_err(), "body");
    let rule = || DamageRule::new("r", DamageMeasure::ImpactSpeed);
    is_foreign(error(&scene.clone().with_rule(rule().with_obstacle(wall))), "obstacle");
    is_foreign(error(&scene.clone().with_rule(rule().with_face(wall, 0))), "obstacle");
    is_foreign(error(&scene.clone().with_rule(rule().with_body(foreign))), "body");
    is_foreign(error(&scene.clone().with_rule(rule().with_pair(puck, foreign))), "body");
    let program = scene.program(3).unwrap();
    is_foreign(program.at(foreign.position(0), 0).unwrap_err(), "variable");
    // An axis that there is none.
    is_foreign(program.at(puck.position(2), 0).unwrap_err(), "variable");
    is_foreign(program.at(puck.velocity(2), 0).unwrap_err(), "variable");
    is_foreign(program.at(puck.acceleration(9), 0).unwrap_err(), "variable");
    // Names that are taken, or are none.
    let mut twice = scene.clone();
    let again = twice.body(body()).unwrap_err();
    assert!(matches!(again.kind(), ErrorKind::DuplicateName { .. }), "{again}");
    let named = Solid::halfspace("puck", [1.0, 0.0], -1.0, Surface::avoid());
    let again = twice.obstacle(named).unwrap_err();
    assert!(matches!(again.kind(), ErrorKind::DuplicateName { .. }), "{again}");
    let unnamed = twice.body(Body::new(" ", [0.0..=1.0, 0.0..=1.0], 1.0, 1.0)).unwrap_err();
    assert!(matches!(unnamed.kind(), ErrorKind::InvalidName { .. }), "{unnamed}");
    assert_eq!((twice.bodies.len(), twice.obstacles.len()), (1, 0));
}

#[test]
fn pairs_that_are_none() {
    let second = Body::new("q", [Interval::new(0.0, 2.0); 2], 3.0, 3.0);
    let mut scene = Scene::new(0.1);
    let (puck, q) = (scene.body(body()).unwrap(), scene.body(second).unwrap());
    let along = |normal: Vec<f64>| {
        let mut scene = scene.clone();
        scene.pair_along(puck, q, Surface::avoid(), [normal]).unwrap();
        refused(&scene)
    };
    let name = || "puck and q".to_owned();
    assert_eq!(along(vec![0.0, 0.0]), SceneError::Normal { obstacle: name(), face: 0 });
    assert_eq!(along(vec![1.0]), SceneError::Axes { name: name(), found: 1, expected: 2 });
    scene.pair(puck, q, Surface::avoid()).unwrap();
    let twice = scene.pair(q, puck, Surface::avoid()).unwrap_err();
    assert!(matches!(twice.kind(), ErrorKind::DuplicateName { .. }), "{twice}");
    let alone = scene.pair(puck, puck, Surface::avoid()).unwrap_err();
    assert!(matches!(alone.kind(), ErrorKind::DuplicateName { .. }), "{alone}");
    // A body that is taken away later.
    scene.bodies.pop();
    let gone = error(&scene);
    assert!(matches!(gone.kind(), ErrorKind::ForeignHandle { kind: "body", .. }), "{gone}");
}

#[test]
fn starts_that_are_regions() {
    let pillar = Solid::cuboid("pillar", [Interval::new(0.5, 1.0); 2], Surface::avoid());
    let scene = Scene::new(0.1).with_obstacle(pillar);
    let within = |low: f64, high: f64| {
        let speed = Interval::new(-1.0, 1.0);
        let place = Interval::new(low, high);
        scene.clone().with_body(body().with_start(Region::from(vec![place, place, speed, speed])))
    };
    assert!(matches!(refused(&within(0.6, 0.9)), SceneError::Inside { end: "starts", .. }));
    // Partly inside: plans start in the part outside, whatever counts of a step.
    for estimate in [ImpactEstimate::Sound, ImpactEstimate::EndOfStep] {
        let mut program = within(0.45, 0.9).with_estimate(estimate).program(2).unwrap();
        let place = |axis: &str| program.program().variables().state(axis).unwrap()[0];
        let middle = place("puck x") + place("puck y");
        program.maximize(middle).unwrap();
        let solution = BranchAndBound::default().solve(program.model()).unwrap();
        assert!((solution.objective().unwrap() - 1.4).abs() < 1e-5, "{estimate:?}");
        assert!(program.plan(&solution).is_ok());
    }
}

/// A rule about a second face of a half-space.
fn face_that_is_none() -> Scene {
    let mut scene = Scene::new(0.1).with_body(body());
    let wall = Solid::halfspace("wall", [1.0, 0.0], -1.0, Surface::avoid());
    let wall = scene.obstacle(wall).unwrap();
    scene.with_rule(DamageRule::new("r", DamageMeasure::ImpactSpeed).with_face(wall, 1))
}

#[test]
fn numbers_that_are_none() {
    let nan = f64::NAN;
    let scene = |body| Scene::new(0.1).with_body(body);
    let pull = |k: f64| body().with_dynamics([[k, 0.0], [0.0, 0.0]], [[0.0; 2]; 2]);
    let wall = |offset| Solid::halfspace("wall", [1.0, 0.0], offset, Surface::avoid());
    let bounce = Surface::bounce(Restitution::new(0.5).unwrap());
    let rule = |rule: DamageRule| Scene::new(0.1).with_body(body()).with_rule(rule);
    let speed = || DamageRule::new("r", DamageMeasure::ImpactSpeed);
    let scenes = [
        scene(body().with_mass(nan)),
        scene(body().with_mass(f64::INFINITY)),
        scene(body().with_shape(Shape::Ball(nan))),
        scene(body().with_shape(Shape::Box(vec![0.1, 0.0]))),
        scene(body().with_shape(Shape::Box(vec![0.1]))),
        scene(body().with_gravity([nan, 0.0])),
        scene(body().with_first_acceleration([nan, 0.0])),
        scene(body().with_first_acceleration([4.0, 0.0])),
        scene(body().with_start(Region::point([nan, 0.5, 0.0, 0.0]))),
        scene(body().with_start(Region::point([0.5, 0.5, 0.0]))),
        scene(body().with_acceleration([Interval::new(1.0, -1.0); 2])),
        scene(Body::new("puck", [Interval::new(2.0, 0.0); 2], 3.0, 3.0)),
        scene(Body::new("puck", [Interval::new(0.0, 2.0); 2], nan, 3.0)),
        scene(pull(nan)),
        with(wall(nan)),
        with(wall(-1.0).with_course([[0.0, nan]])),
        with(wall(-1.0).with_surface_of(1, Surface::avoid())),
        with(Solid::halfspace("wall", [1.0, 0.0], -1.0, bounce.with_friction(nan))),
        rule(speed().with_per_hit(nan)),
        rule(speed().with_total(-1.0)),
        rule(speed().with_window(0)),
        rule(speed().with_incidence(0.0)),
        rule(DamageRule::new("r", DamageMeasure::Convex(Vec::new()))),
        rule(DamageRule::new("r", DamageMeasure::Convex(vec![(-1.0, 0.0)]))),
        face_that_is_none(),
        Scene::new(nan).with_body(body()),
        scene(body()).with_body(body()),
    ];
    for (k, scene) in scenes.into_iter().enumerate() {
        let refused = scene.program(3);
        let text = refused.err().map(|error| error.to_string());
        // Names what is wrong.
        let named = |text: &String| {
            ["puck", "wall", "`r`", "time step", "Δt"].iter().any(|name| text.contains(name))
        };
        assert!(text.as_ref().is_some_and(named), "{k}: {text:?}");
    }
    assert!(Restitution::new(1.0 + 1e-9).is_err() && Restitution::new(nan).is_err());
}
