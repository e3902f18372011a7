//! Statements of nonlinear systems, and those that are refused.

use carom::ErrorKind;
use carom::hybrid::{Discretization, Feedback, Matrix};
use carom::prelude::*;

use super::fields::{METHODS, stated};

/// An arm of two links in a plane whose joints turn at given rates (rad/s).
fn arm() -> (HybridSystem, [carom::hybrid::State; 2]) {
    let mut arm = HybridSystem::new(0.5); // s
    let shoulder = arm.state("shoulder", -1.5, 3.0).unwrap(); // rad
    let elbow = arm.state("elbow", 0.0, 2.8).unwrap(); // rad
    let [u, w] = ["u", "w"].map(|name| arm.input(name, -1.0, 1.0).unwrap()); // rad/s
    arm.mode("turn").unwrap().rates([shoulder.is(u), elbow.is(w)]).unwrap();
    (arm, [shoulder, elbow])
}

#[test]
fn limits_and_goals_are_of_functions() {
    let (mut arm, [shoulder, elbow]) = arm();
    let (x, y) =
        (shoulder.cos() + (shoulder + elbow).cos(), shoulder.sin() + (shoulder + elbow).sin());
    // The hand stays to the right of a wall.
    arm.limit("wall", x.ge(0.3)).unwrap();
    let start = [shoulder.equals(-1.0), elbow.equals(0.5)];
    let goal = [x.within(0.6, 0.7), y.ge(1.2)];
    let found = arm.shortest(start, goal, &mut BranchAndBound::default()).unwrap();
    let run = found.plan.unwrap().run;
    let [a, b] = ["shoulder", "elbow"].map(|name| run.state(name).unwrap().to_vec());
    let hand = |t: usize| (a[t].cos() + (a[t] + b[t]).cos(), a[t].sin() + (a[t] + b[t]).sin());
    assert!((0..a.len()).all(|t| hand(t).0 >= 0.3 - 1e-5));
    let (x, y) = hand(a.len() - 1);
    assert!((0.6 - 1e-5..=0.7 + 1e-5).contains(&x) && y >= 1.2 - 1e-5, "{x} {y}");
    // A run that leaves the limit is refused by the certificate.
    let mut wrong = run.clone();
    let spread = |values: &mut [(String, Vec<f64>)], value: f64| {
        values.iter_mut().for_each(|(_, own)| own.iter_mut().for_each(|x| *x = value));
    };
    spread(&mut wrong.states, 2.0);
    spread(&mut wrong.inputs, 0.0);
    let error = arm.certify(&wrong).unwrap_err();
    assert!(error.to_string().contains("`wall`"), "{error}");
}

#[test]
fn guards_and_outputs_are_of_functions() {
    // A boat whose motor works only where the current is weak; power is speed cubed.
    let mut boat = HybridSystem::new(1.0); // s
    let x = boat.state("x", 0.0, 10.0).unwrap(); // m
    let v = boat.input("v", 0.0, 2.0).unwrap(); // m/s
    let power = boat.output("power").unwrap();
    boat.next([x.is(x + v - 0.5 * x.sin())]).unwrap();
    boat.mode("motor")
        .unwrap()
        .guard((0.5 * x.sin()).le(0.2))
        .unwrap()
        .output(power, v.pow(3.0))
        .unwrap();
    boat.mode("sail").unwrap().guard(v.le(1.0)).unwrap();
    let mut program = boat.program(4).unwrap();
    program.start([x.equals(0.0)]).unwrap();
    program.goal([x.ge(4.0)]).unwrap();
    let cost = program.sum(power).unwrap();
    program.minimize(cost).unwrap();
    let plan = program.solve(&mut BranchAndBound::default()).unwrap();
    assert!(plan.solution.is_optimal());
    let (xs, vs) = (plan.values(x).unwrap(), plan.values(v).unwrap());
    let taken = plan.run.transitions("mode").unwrap();
    let mut total = 0.0;
    for t in 0..4 {
        let motor = taken[t] == "motor";
        assert!(if motor { 0.5 * xs[t].sin() <= 0.2 + 1e-5 } else { vs[t] <= 1.0 + 1e-6 });
        total += if motor { vs[t].powi(3) } else { 0.0 };
    }
    assert!((plan.solution.objective().unwrap() - total).abs() < 1e-4);
}

#[test]
fn bad_statements_name_the_way_out() {
    let kind = |error: carom::Error| error.to_string();
    // A pole within the domain.
    let mut system = HybridSystem::new(0.1);
    let x = system.state("x", -1.0, 1.0).unwrap();
    let error = system.mode("m").unwrap().rates([x.is(1.0 / x)]).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::Pole { .. }), "{error}");
    // No value anywhere.
    let mut system = HybridSystem::new(0.1);
    let x = system.state("x", -2.0, -1.0).unwrap();
    let error = system.mode("m").unwrap().rates([x.is(x.sqrt())]).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::CrossedBounds { .. }), "{error}");
    // An implicit method with a reset, and a method after a flow.
    let mut system = HybridSystem::new(0.1);
    let x = system.state("x", -1.0, 1.0).unwrap();
    let flow = system.mode("m").unwrap().rates([x.is(x.sin())]).unwrap();
    flow.reset([x.is(-1.0 * x.predicted())]).unwrap();
    let error = system.check().unwrap_err();
    assert!(kind(error).contains("explicit method"));
    assert!(system.discretization(Discretization::Euler).is_err());
    // A nonlinear reset.
    let mut system = HybridSystem::new(0.1);
    let x = system.state("x", -1.0, 1.0).unwrap();
    let mode = system.mode("m").unwrap();
    assert!(mode.reset([x.is(x.predicted().cos())]).is_err());
    // What knows linear flows only.
    let own = stated(0, 0.1, Discretization::Midpoint);
    let gain = Matrix::zeros(1, 2);
    assert!(Feedback::new(&own.system, gain).is_err());
    assert!(own.system.well_posedness(&mut BranchAndBound::default()).is_err());
    // An input is declared after a function of its name.
    let mut own = stated(0, 0.1, Discretization::Midpoint);
    assert!(own.system.input("b_part1", 0.0, 1.0).is_err());
}

#[test]
fn the_text_names_the_functions() {
    let own = stated(1, 0.1, Discretization::Euler);
    let text = own.system.to_string();
    assert!(text.contains("function a_part1 = cos(c) in"), "{text}");
    assert!(text.contains("a+ = a + 0.15000000000000002 a_part1"), "{text}");
}

#[test]
fn inputs_after_a_flow_and_units_change_nothing() {
    // The same car in metres, and in millimetres far from the origin.
    let steps = |scale: f64, origin: f64, method: Discretization| {
        let mut car = HybridSystem::new(0.5); // s
        let x = car.state("x", origin - 3.0 * scale, origin + 3.0 * scale).unwrap();
        let heading = car.state("heading", -1.5, 1.5).unwrap(); // rad
        let turn = car.input("turn", -0.8, 0.8).unwrap(); // rad/s
        car.discretization(method).unwrap();
        car.rates([x.is(scale * heading.sin()), heading.is(turn)]).unwrap();
        car.input("horn", 0.0, 1.0).unwrap();
        car.mode("drive").unwrap();
        let start = [x.equals(origin), heading.equals(0.0)];
        let goal = [x.ge(origin + scale), heading.within(-0.2, 0.2)];
        let found = car.shortest(start, goal, &mut BranchAndBound::default()).unwrap();
        let Some(solved) = &found.plan else { panic!("{method}, {scale}, {origin}: {found}") };
        car.certify(&solved.run).unwrap();
        found.steps
    };
    for (method, _) in METHODS {
        let plain = steps(1.0, 0.0, method);
        assert!(plain.is_some());
        assert_eq!(plain, steps(1000.0, 5e6, method), "{method}");
        assert_eq!(plain, steps(1e-4, 0.0, method), "{method}");
    }
}
