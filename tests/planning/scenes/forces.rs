//! Forces and headings: steps are what their formulas say, in any units, and plans turn to stop.

use carom::ErrorKind;
use carom::hybrid::Restitution;
use carom::hybrid::scene::{Body, BodyPath, Scene, SceneError, Shape, Solid, Surface};
use carom::prelude::*;

const STEP: f64 = 0.1;

/// A car on a line, from 1.5 m at 3 m/s towards a wall at 0 m, to 2 m going away at 1 m/s or more.
fn car(drag: f64, origin: f64, length: f64, time: f64) -> Scene {
    let x = |x: f64| origin + length * x;
    let v = |v: f64| length / time * v;
    let a = |a: f64| length / time / time * a;
    let body = Body::new("car", [x(0.0)..=x(4.0)], v(6.0), a(2.0))
        .with_drag(drag / length)
        .with_start([x(1.5), v(-3.0)])
        .with_goal([x(1.9)..=x(2.1), v(1.0)..=v(6.0)]);
    let wall = Surface::bounce(Restitution::new(0.8).unwrap());
    Scene::new(STEP * time).with_body(body).with_obstacle(Solid::halfspace(
        "wall",
        [1.0],
        x(0.0),
        wall,
    ))
}

/// By how much the flights of a path are off, with `-c |v| v` held over each step.
fn off(path: &BodyPath, drag: f64, hits: &[usize]) -> f64 {
    let mut most = 0.0_f64;
    for t in (0..path.acceleration.len()).filter(|t| !hits.contains(t)) {
        let speed = path.velocity[t].iter().map(|v| v * v).sum::<f64>().sqrt();
        for (i, u) in path.acceleration[t].iter().enumerate() {
            let (x, v) = (path.position[t][i], path.velocity[t][i]);
            let a = u - drag * speed * v;
            let x = x + STEP * v + 0.5 * STEP * STEP * a;
            most = most.max((x - path.position[t + 1][i]).abs());
            most = most.max((v + STEP * a - path.velocity[t + 1][i]).abs());
        }
    }
    most
}

#[test]
fn drag_slows_a_rebound() {
    let shortest = |drag: f64| {
        let found = car(drag, 0.0, 1.0, 1.0).shortest(&mut BranchAndBound::default()).unwrap();
        let (steps, refuted) = (found.steps.unwrap(), found.refuted_steps);
        assert_eq!(refuted, Some(steps - 1));
        found.plan.unwrap()
    };
    let (free, slowed) = (shortest(0.0), shortest(0.1));
    assert!(free.steps() < slowed.steps(), "{} {}", free.steps(), slowed.steps());
    assert_eq!(slowed.hits.len(), 1);
    let hits: Vec<usize> = slowed.hits.iter().map(|hit| hit.step).collect();
    assert!(off(&slowed.bodies[0], 0.1, &hits) < 1e-6);
    // The hit reverses what the flight would have been, by the formulas of the contact law.
    let (t, path) = (hits[0], &slowed.bodies[0]);
    let (x, v, u) = (path.position[t][0], path.velocity[t][0], path.acceleration[t][0]);
    let a = u - 0.1 * v.abs() * v;
    let (p, w) = (x + STEP * v + 0.5 * STEP * STEP * a, v + STEP * a);
    assert!((path.velocity[t + 1][0] + 0.8 * w).abs() < 1e-6);
    assert!((path.position[t + 1][0] + 0.8 * p).abs() < 1e-6);
}

#[test]
fn units_and_origins_change_no_plan() {
    let steps = |origin: f64, length: f64, time: f64| {
        let scene = car(0.1, origin, length, time);
        scene.shortest(&mut BranchAndBound::default()).unwrap().steps
    };
    let plain = steps(0.0, 1.0, 1.0);
    assert!(plain.is_some());
    for (origin, length, time) in
        [(1e5, 1.0, 1.0), (0.0, 1e-4, 1.0), (-3e4, 1e4, 60.0), (0.0, 1.0, 1e-3)]
    {
        assert_eq!(steps(origin, length, time), plain, "{origin} {length} {time}");
    }
}

/// A craft that can only push forward.
fn craft() -> Body {
    Body::new("craft", [0.0..=3.0, -1.0..=1.0], 2.0, 2.0)
        .with_acceleration([0.0..=2.0, 0.0..=0.0])
        .with_shape(Shape::Ball(0.1))
        .with_spin(0.01, 4.0, 0.1)
        .with_heading(-4.0..=4.0)
}

#[test]
fn a_craft_turns_around_to_stop() {
    let body = craft().with_drag(0.1).with_start([0.5, 0.0, 0.0, 0.0, 0.0, 0.0]).with_goal([
        1.6..=2.0,
        -0.3..=0.3,
        -0.2..=0.2,
        -0.2..=0.2,
    ]);
    let mut scene = Scene::new(0.25);
    let craft = scene.body(body).unwrap();
    let found = scene.shortest(&mut BranchAndBound::default()).unwrap();
    let plan = found.plan.unwrap();
    let path = &plan.bodies[0];
    let h = 0.25;
    for t in 0..plan.steps() {
        let (angle, rate, torque) = (path.heading[t], path.spin[t], path.torque[t]);
        let turned = angle + h * rate + 0.5 * h * h * torque / 0.01;
        assert!((turned - path.heading[t + 1]).abs() < 1e-6);
        let middle = angle + 0.5 * h * rate + 0.125 * h * h * torque / 0.01;
        let push = path.acceleration[t][0];
        let v = &path.velocity[t];
        let speed = v[0].hypot(v[1]);
        for (i, along) in [middle.cos(), middle.sin()].into_iter().enumerate() {
            let next = v[i] + h * (push * along - 0.1 * speed * v[i]);
            assert!((next - path.velocity[t + 1][i]).abs() < 1e-6);
        }
    }
    assert!(path.heading.iter().any(|angle| angle.abs() > 1.5));
    assert!(scene.replay(&plan).is_ok());
    // A plan that pushes elsewhere is refused by a replay that knows no system.
    let mut other = plan.clone();
    other.bodies[0].heading[1] += 0.1;
    assert!(scene.replay(&other).is_err());
    // The heading stands in rows.
    let steps = plan.steps();
    let mut program = scene.program(steps).unwrap();
    program
        .require(
            "it never turns far",
            [craft.heading().le(1.0), craft.heading().ge(-1.0)],
            When::Throughout(0..=steps),
        )
        .unwrap();
    assert!(program.solve(&mut BranchAndBound::default()).is_err());
}

#[test]
fn what_has_no_force_is_refused() {
    let at = |body: Body| Scene::new(0.1).with_body(body).program(3).unwrap_err();
    let plain = || Body::new("puck", [0.0..=2.0, 0.0..=1.0], 3.0, 4.0);
    let error = at(plain().with_heading(-1.0..=1.0));
    assert!(error.to_string().contains("with_spin"), "{error}");
    let error = at(plain().with_forces(|x, _| [x[0].sin()]));
    assert!(
        matches!(error.kind(), ErrorKind::Scene(SceneError::Axes { found: 1, expected: 2, .. })),
        "{error}"
    );
    let zero = || [[0.0, 0.0], [0.0, 0.0]];
    let error = at(plain().with_dynamics(zero(), zero()).with_drag(0.1));
    assert!(error.to_string().contains("springs"), "{error}");
    let mut other = HybridSystem::new(0.1);
    let foreign = other.state("other", 0.0, 1.0).unwrap();
    let error = at(plain().with_forces(|_, _| [foreign.sin(), foreign.cos()]));
    assert!(matches!(error.kind(), ErrorKind::ForeignHandle { .. }), "{error}");
}
