//! Bodies whose speed and thrust are limited in length: turned scenes, shortest plans, replays.

use std::f64::consts::TAU;

use carom::ErrorKind;
use carom::hybrid::scene::{Body, Scene, SceneError, ScenePlan, Solid, Surface};
use carom::hybrid::{Region, Restitution, ShortestOptions};
use carom::model::norm;
use carom::prelude::*;

/// The scene's error within an error.
fn scene_error(error: Error) -> SceneError {
    let ErrorKind::Scene(own) = error.kind() else { panic!("{error}") };
    own.clone()
}

/// A point turned by an angle.
fn turned(angle: f64, [x, y]: [f64; 2]) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    [cos * x - sin * y, sin * x + cos * y]
}

/// A puck that goes around a half-plane with a wall that it may bounce off, turned by an angle.
fn scene(angle: f64, balls: bool) -> Scene {
    let state = |x: [f64; 2], v: [f64; 2]| {
        let ([x, y], [v, w]) = (turned(angle, x), turned(angle, v));
        Region::point([x, y, v, w])
    };
    let mut puck = Body::new("puck", [-9.0..=9.0, -9.0..=9.0], 2.0, 3.0)
        .with_start(state([0.5, 2.0], [1.5, -1.2]))
        .with_goal(state([3.0, 2.5], [0.0, 0.0]));
    if balls {
        puck = puck.with_speed_ball(2.0).with_acceleration_ball(3.0);
    }
    let floor = Surface::bounce(Restitution::new(0.8).unwrap());
    let floor = Solid::halfspace("floor", turned(angle, [0.0, 1.0]), 0.0, floor);
    Scene::new(0.2).with_body(puck).with_obstacle(floor)
}

fn least_fuel(scene: &Scene, steps: usize) -> ScenePlan {
    let mut program = scene.program(steps).unwrap();
    let fuel = program.fuel().unwrap();
    program.minimize(fuel).unwrap();
    program.solve(&mut BranchAndBound::default()).unwrap()
}

fn length(v: &[f64]) -> f64 {
    v.iter().fold(0.0_f64, |length, v| length.hypot(*v))
}

#[test]
fn turned_scenes_have_the_same_optimum() {
    let fuel =
        |plan: &ScenePlan| -> f64 { plan.bodies[0].acceleration.iter().map(|a| length(a)).sum() };
    let straight = fuel(&least_fuel(&scene(0.0, true), 12));
    for angle in [0.4, 0.9, 2.3] {
        let plan = least_fuel(&scene(angle, true), 12);
        let found = fuel(&plan);
        assert!((found - straight).abs() < 1e-4 * straight, "{angle}: {found}, {straight}");
        let path = &plan.bodies[0];
        assert!(path.velocity.iter().all(|v| length(v) <= 2.0 + 2e-6));
        assert!(path.acceleration.iter().all(|a| length(a) <= 3.0 + 2e-6));
        assert!(plan.certificate.largest_residual < 1e-6);
    }
}

#[test]
fn shortest_plans_keep_lengths_and_sets_refute_the_rest() {
    let options = ShortestOptions::default().with_max_steps(40);
    let shortest = |scene: &Scene| {
        let found = scene.shortest_with(&options, &mut BranchAndBound::default()).unwrap();
        let plan = found.plan.unwrap();
        (plan.steps(), plan)
    };
    let (boxes, _) = shortest(&scene(0.7, false));
    let (balls, plan) = shortest(&scene(0.7, true));
    assert!(boxes <= balls && balls <= boxes + 6, "{boxes}, {balls}");
    assert!(plan.bodies[0].velocity.iter().all(|v| length(v) <= 2.0 + 2e-6));
    let infeasible = scene(0.7, true).program(balls - 1).unwrap();
    assert!(BranchAndBound::default().solve(infeasible.model()).unwrap().is_infeasible());
    let sets = scene(0.7, true).reach_sets().unwrap();
    assert!((sets.norm_excess() - (1.0 / (TAU / 32.0).cos() - 1.0)).abs() < 1e-12);
}

#[test]
fn goals_are_discs() {
    let own = |body: Body| Scene::new(0.25).with_body(body);
    let puck = Body::new("puck", [0.0..=9.0, 0.0..=9.0], 2.0, 2.0)
        .with_speed_ball(2.0)
        .with_acceleration_ball(2.0)
        .with_start([1.0, 1.0, 0.0, 0.0]);
    let goal = |x: &[carom::hybrid::State], _: &[carom::hybrid::State]| {
        [norm([x[0] - 4.0, x[1] - 4.0]).le(1.0)]
    };
    let puck = puck.with_goal_where(goal).unwrap();
    let plan = least_fuel(&own(puck.clone()), 16);
    let end = &plan.bodies[0].position[16];
    assert!((length(&[end[0] - 4.0, end[1] - 4.0]) - 1.0).abs() < 1e-3, "{end:?}");
    let mut wrong = plan.clone();
    wrong.bodies[0].position[16][0] -= 0.1;
    assert!(own(puck).replay(&wrong).is_err());
}

#[test]
fn replays_refuse_what_only_the_box_allows() {
    let boxed = scene(0.3, false);
    let start = |scene: Scene, state: [f64; 4]| {
        let mut scene = scene;
        scene.bodies[0].start = Some(Region::point(state));
        scene.bodies[0].goal = None;
        scene
    };
    let plan = |thrust: [f64; 2]| {
        let scene = start(boxed.clone(), [0.0, 5.0, 1.93, 0.0]);
        let mut program = scene.program(1).unwrap();
        let puck = scene.body_named("puck").unwrap();
        for (k, value) in thrust.into_iter().enumerate() {
            let row = program.at(puck.acceleration(k).equals(value), 0).unwrap();
            program.add(("thrust", k), row).unwrap();
        }
        program.solve(&mut BranchAndBound::default()).unwrap()
    };
    let balls = start(scene(0.3, true), [0.0, 5.0, 1.93, 0.0]);
    let text = |thrust| scene_error(balls.replay(&plan(thrust)).unwrap_err()).to_string();
    balls.replay(&plan([0.0, 2.0])).unwrap();
    let fast = text([0.0, 2.9]);
    assert!(fast.contains("puck: is too fast (m/s)"), "{fast}");
    let strong = text([-2.9, 2.9]);
    assert!(strong.contains("puck: pushes beyond its largest acceleration (m/s²)"), "{strong}");

    let fast = start(scene(0.3, true), [0.0, 5.0, 1.9, 1.9]);
    assert_eq!(
        scene_error(fast.program(1).unwrap_err()).to_string(),
        "`puck` starts with the speed 2.6870057685088806, outside its largest speed, 0 to 2 m/s; \
         move it, or widen the limit",
    );
    let mut first = start(scene(0.3, true), [0.0, 5.0, 0.0, 0.0]);
    first.bodies[0] = first.bodies[0].clone().with_first_acceleration([2.9, 2.9]);
    let text = first.program(1).unwrap_err().to_string();
    assert!(text.contains("the length of the first acceleration of `puck`"), "{text}");
}

#[test]
fn bodies_stick_within_the_true_cone() {
    // A ball that falls on a floor with the friction 0.5 and no rebound at 4 m/s, and slides at
    // some share of what 2 m/s of impulse stop. Four directions: their pyramid has 0.71 of the
    // cone.
    let floor = Surface::bounce(Restitution::new(0.0).unwrap()).with_friction_along(0.5, 4);
    let end = |angle: f64, share: f64| -> Result<f64, Error> {
        let (sin, cos) = angle.sin_cos();
        let slide = [2.0 * share * cos, 2.0 * share * sin];
        let ball = Body::new("ball", [-9.0..=9.0, -9.0..=9.0, 0.0..=9.0], 9.0, 0.0)
            .with_start([0.0, 0.0, 0.2, slide[0], slide[1], -4.0]);
        let floor = Solid::halfspace("floor", [0.0, 0.0, 1.0], 0.0, floor);
        let scene = Scene::new(0.1).with_body(ball).with_obstacle(floor);
        let mut program = scene.program(1)?;
        let ball = scene.body_named("ball")?;
        let speed = [ball.velocity(0), ball.velocity(1)];
        let speed = program.program_mut().norm("end", speed, 1)?;
        program.minimize(speed)?;
        let plan = program.solve(&mut BranchAndBound::default())?;
        assert_eq!(plan.hits.len(), 1);
        assert!(plan.certificate.cone_excess < 2e-6, "{:?}", plan.certificate);
        Ok(length(&plan.bodies[0].velocity[1][..2]))
    };
    for angle in [0.0, 0.4, 0.25 * std::f64::consts::PI, 2.0] {
        for share in [0.5, 0.9, 0.99] {
            assert!(end(angle, share).unwrap() < 1e-5, "{angle}, {share}");
        }
        // It slips: the pyramid takes at most 1.42 m/s.
        let left = end(angle, 1.01).unwrap();
        assert!((0.5..1.5).contains(&left), "{angle}: {left}");
    }
}

#[test]
fn balls_of_nothing_and_of_wrong_sizes() {
    let scene = |speed: f64, most: f64| {
        let drone = Body::new("drone", [-9.0..=9.0, -9.0..=9.0, -9.0..=9.0], 1.0, 1.0)
            .with_speed_ball(speed)
            .with_acceleration_ball(most)
            .with_start([0.0, 0.0, 0.0, 0.6, 0.0, 0.8]);
        Scene::new(0.5).with_body(drone)
    };
    // Without thrust it flies on, at its largest speed.
    let plan = least_fuel(&scene(1.0, 0.0), 3);
    let end = &plan.bodies[0].position[3];
    assert!((end[0] - 0.9).abs() < 1e-5 && (end[2] - 1.2).abs() < 1e-5, "{end:?}");
    for (speed, most, text) in [
        (0.99, 1.0, "`drone` starts with the speed 1, outside its largest speed, 0 to 0.99 m/s"),
        (-1.0, 1.0, "the largest speed (m/s) of `drone` is -1"),
        (f64::NAN, 1.0, "the largest speed (m/s) of `drone`"),
        (1.0, -1.0, "drone"),
        (1.0, f64::NAN, "drone"),
    ] {
        let error = scene(speed, most).program(2).unwrap_err().to_string();
        assert!(error.contains(text), "{error}");
    }
}
