//! Starts and goals against the limits of their bodies, half-spaces of regions, ties at surfaces,
//! explanations that name what is in the way.

use carom_hybrid::internals::HasParts;
use std::time::Duration;

use carom::ErrorKind;
use carom::hybrid::scene::{Body, Scene, Shape, Solid, Surface};
use carom::hybrid::{Region, Restitution};
use carom::interval::Interval;
use carom::prelude::*;
use carom_hybrid::internals::Halfspace;

fn body() -> Body {
    Body::new("puck", [Interval::new(0.0, 2.0), Interval::new(0.0, 1.0)], 3.0, 3.0)
}

fn refused(body: Body) -> String {
    Scene::new(0.1).with_body(body).program(4).unwrap_err().to_string()
}

#[test]
fn starts_and_goals_beyond_the_limits_of_their_body() {
    assert_eq!(
        refused(body().with_start(Region::point([2.5, 0.5, 0.0, 0.0]))),
        "`puck` starts with x 2.5, outside its domain, 0 to 2 m; move it, or widen the limit"
    );
    let low = Interval::new(-1.0, -0.5);
    let still = Interval::point(0.0);
    assert_eq!(
        refused(body().with_goal(Region::from([Interval::REALS, low, still, still]))),
        "`puck` ends with y from -1 to -0.5, outside its domain, 0 to 1 m; move it, or widen the \
         limit"
    );
    assert_eq!(
        refused(body().with_start(Region::point([0.5, 0.5, 0.0, -3.5]))),
        "`puck` starts with vy -3.5, outside its largest speed, -3 to 3 m/s; move it, or widen the \
         limit"
    );
    // A start that is partly within the limits, or off by less than rows are, is one.
    let wide = Interval::new(-5.0, 5.0);
    for x in [wide, Interval::point(2.0 + 1e-8)] {
        let start = Region::from([x, still, still, still]);
        assert!(Scene::new(0.1).with_body(body().with_start(start)).program(2).is_ok());
    }
}

#[test]
fn half_spaces_of_starts_are_named() {
    let start = |side: Halfspace| {
        let wide = Interval::new(-5.0, 5.0);
        refused(body().with_start(Region::from([wide; 4]).with_halfspace(side)))
    };
    assert_eq!(
        start(Halfspace::new("side", [1.0, 0.0], 1.0)),
        "`the half-space side of the start of puck` has 2 entries and the scene needs 4; give one \
         per axis, and in starts and goals one per position, one per velocity, one for a spin, and one for a heading"
    );
    assert_eq!(
        start(Halfspace::new("side", [0.0; 4], 1.0)),
        "the largest entry of the normal of the half-space `side` is 0; it must be another number \
         than 0; give a direction"
    );
    // Within the box of the start, but not within the body's limits.
    assert_eq!(
        start(Halfspace::new("side", [1.0, 1.0, 0.0, 0.0], -1.0)),
        "`puck` starts where the half-space `side` does not allow it: 0 at least, and -1 at most; \
         move one of them"
    );
}

#[test]
fn explanations_name_the_obstacle() {
    let start = Region::point([1.2, 0.5, 2.9, 0.0]);
    let pillar = [Interval::new(1.5, 1.8), Interval::new(0.0, 1.0)];
    let scene = Scene::new(0.1)
        .with_body(body().with_start(start).with_goal(Region::point([0.2, 0.5, 0.0, 0.0])))
        .with_obstacle(Solid::cuboid("pillar", pillar, Surface::avoid()));
    let text = scene.reach_sets().unwrap().explain(20).unwrap().unwrap().to_string();
    let reason = "puck cannot keep clear of pillar: at least ";
    assert!(
        text.starts_with("no plan has 20 steps (2 s): after ") && text.contains(reason),
        "{text}"
    );
}

#[test]
fn explanations_of_scenes_are_sentences() {
    let far = body().with_start([0.2, 0.5, 0.0, 0.0]).with_goal([1.8, 0.5, 0.0, 0.0]);
    let scene = Scene::new(0.1).with_body(far);
    let mut sets = scene.reach_sets().unwrap();
    let within = Duration::from_secs(3600);
    let reason = sets.explain_within(8, within).unwrap().unwrap();
    assert_eq!(Some(&reason), sets.explain(8).unwrap().as_ref());
    assert_eq!(
        reason.to_string(),
        "no plan has 8 steps (0.8 s): at the end, x of puck is at most 1.16 m, and 1.8 m is needed"
    );
    // Without time there is nothing to say.
    assert!(sets.explain_within(8, Duration::ZERO).unwrap().is_none());
}

#[test]
fn bodies_in_the_plane_meet_along_four_normals_or_eight() {
    let normals = |first: Shape, second: Shape| {
        let other = Body::new("other", [Interval::new(0.0, 2.0); 2], 3.0, 3.0);
        let mut scene = Scene::new(0.1);
        let puck = scene.body(body().with_shape(first)).unwrap();
        let other = scene.body(other.with_shape(second)).unwrap();
        scene.pair(puck, other, Surface::avoid()).unwrap();
        let system = scene.hybrid_system().unwrap();
        system.parts().choices[0].transitions.len()
    };
    let square = || Shape::Box(vec![0.1, 0.1]);
    assert_eq!(normals(Shape::Point, square()), 4);
    assert_eq!(normals(square(), square()), 4);
    assert_eq!(normals(Shape::Ball(0.1), square()), 8);
    assert_eq!(normals(Shape::Point, Shape::Ball(0.1)), 8);
}

#[test]
fn a_margin_keeps_steps_away_from_ties() {
    // It arrives at the wall exactly when the step ends: it may hit or fly.
    let least = |margin: f64, x: f64, hits: f64| {
        let line = Body::new("b", [Interval::new(0.0, 2.0)], 3.0, 0.0)
            .with_start(Region::point([x, -1.0]));
        let surface = Surface::bounce(Restitution::new(0.5).unwrap());
        let scene = Scene::new(0.1)
            .with_body(line)
            .with_obstacle(Solid::halfspace("wall", [1.0], 0.0, surface))
            .with_margin(margin);
        let mut program = scene.program(1).unwrap();
        let wanted = program.hits();
        program.add("wanted", wanted.equals(hits)).unwrap();
        BranchAndBound::default().solve(program.model()).unwrap().point().is_some()
    };
    assert!(least(0.0, 0.1, 0.0) && least(0.0, 0.1, 1.0));
    assert!(!least(0.001, 0.1, 0.0) && !least(0.001, 0.1, 1.0));
    assert!(least(0.001, 0.102, 0.0) && !least(0.001, 0.102, 1.0));
    assert!(least(0.001, 0.098, 1.0) && !least(0.001, 0.098, 0.0));
    let scene = Scene::new(0.1).with_body(body()).with_margin(-1.0);
    let error = scene.program(1).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::OutOfRange { .. }), "{error}");
}
