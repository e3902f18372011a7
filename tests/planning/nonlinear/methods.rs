//! The steps of methods, and the motion between them.

use carom::hybrid::Discretization;
use carom::prelude::*;
use proptest::prelude::*;

use super::fields::{FIELDS, METHODS, STATES, lead, stated, step, value};
use crate::common::config;

proptest! {
    #![proptest_config(config(150, "tests/regressions/nonlinear_methods.txt"))]

    #[test]
    fn simulated_steps_are_those_of_the_formulas(
        field in 0..FIELDS,
        method in 0..METHODS.len(),
        start in prop::array::uniform3(-1.5..1.5_f64),
        inputs in prop::collection::vec(-1.0..1.0_f64, 1..5),
    ) {
        let method = METHODS[method].0;
        let own = stated(field, 0.1, method);
        let mut x = start[..STATES[field]].to_vec();
        let list: Vec<[f64; 1]> = inputs.iter().map(|u| [*u]).collect();
        let run = own.system.simulate(&x, &list).unwrap();
        prop_assert!(run.is_complete());
        for (u, sample) in inputs.iter().zip(&run.states[1..]) {
            x = lead(method, &|x| value(field, x, *u), 0.1, &x);
            for (own, expected) in sample.iter().zip(&x) {
                prop_assert!((own - expected).abs() < 1e-10, "{own} instead of {expected}");
            }
        }
        let certificate = own.system.certify(&run.to_run()).unwrap();
        prop_assert!(certificate.largest_residual < 1e-10);
    }

    #[test]
    fn the_motion_is_the_limit_of_short_steps(
        field in 0..FIELDS,
        start in prop::array::uniform3(-1.5..1.5_f64),
        u in -1.0..1.0_f64,
    ) {
        let own = stated(field, 0.4, Discretization::Midpoint);
        let start = &start[..STATES[field]];
        let run = own.system.simulate(start, &[[u]]).unwrap().to_run();
        let motion = own.system.motion(&run).unwrap();
        let mut x = start.to_vec();
        for _ in 0..400 {
            x = step(Discretization::RungeKutta4, &|x| value(field, x, u), 0.001, &x, &x);
        }
        for (own, expected) in motion.samples[1].iter().zip(&x) {
            // Drag has a kink at rest, where the formula here has not its order.
            prop_assert!((own - expected).abs() < 1e-7, "{own} instead of {expected}");
        }
    }
}

proptest! {
    #![proptest_config(config(60, "tests/regressions/nonlinear_enclosures.txt"))]

    #[test]
    fn the_motion_is_within_its_enclosure(
        field in 0..FIELDS,
        start in prop::array::uniform3(-1.5..1.5_f64),
        inputs in prop::collection::vec(-1.0..1.0_f64, 1..6),
    ) {
        let own = stated(field, 0.2, Discretization::Midpoint);
        let start = &start[..STATES[field]];
        let list: Vec<[f64; 1]> = inputs.iter().map(|u| [*u]).collect();
        let run = own.system.simulate(start, &list).unwrap();
        prop_assume!(run.is_complete());
        let run = run.to_run();
        let enclosed = own.system.enclose_motion(&run).unwrap();
        let mut x = start.to_vec();
        for (t, u) in inputs.iter().enumerate() {
            for _ in 0..200 {
                x = step(Discretization::RungeKutta4, &|x| value(field, x, *u), 0.001, &x, &x);
            }
            for (i, x) in x.iter().enumerate() {
                let (centre, radius) = (enclosed.samples[t + 1][i], enclosed.radii[t + 1][i]);
                // The formula here errs by some 1e-12, and by more at a kink.
                let slack = if field == 0 { 1e-7 } else { 1e-10 };
                prop_assert!((x - centre).abs() <= radius + slack, "{x}, {centre} +- {radius}");
                prop_assert!(radius < if field == 0 { 1e-2 } else { 1e-6 }, "{radius}");
            }
        }
        let motion = own.system.motion(&run).unwrap();
        for (proved, simulated) in enclosed.errors.iter().zip(&motion.errors) {
            prop_assert!(*proved >= simulated - 1e-8, "{proved} below {simulated}");
        }
    }
}

#[test]
fn errors_shrink_with_the_order_of_the_method() {
    for (method, order) in METHODS {
        let error = |steps: usize| {
            let own = stated(3, 1.0 / steps as f64, method);
            let inputs = vec![[0.3]; steps];
            let run = own.system.simulate(&[0.4, 0.8], &inputs).unwrap().to_run();
            own.system.motion(&run).unwrap().errors[0]
        };
        let measured = (error(8) / error(16)).log2();
        assert!((measured - order).abs() < 0.25, "{method}: {measured} instead of {order}");
    }
}

#[test]
fn the_motion_of_linear_rates_is_their_step() {
    let mut cart = HybridSystem::new(0.5); // s
    let x = cart.state("x", -9.0, 9.0).unwrap(); // m
    let v = cart.state("v", -9.0, 9.0).unwrap(); // m/s
    let a = cart.input("a", -1.0, 1.0).unwrap(); // m/s²
    cart.mode("roll").unwrap().rates([x.is(v), v.is(a - 0.2 * v)]).unwrap();
    let run = cart.simulate(&[0.0, 1.0], &[[1.0], [-1.0], [0.5]]).unwrap().to_run();
    let motion = cart.motion(&run).unwrap();
    assert_eq!(motion.errors, [0.0, 0.0]);
    assert_eq!(cart.discretized_by(), None);
}

#[test]
fn resets_are_part_of_the_motion() {
    // A ball with drag on the floor.
    let mut ball = HybridSystem::new(0.1); // s
    let height = ball.state("height", -1.0, 5.0).unwrap(); // m
    let speed = ball.state("speed", -9.0, 9.0).unwrap(); // m/s
    ball.discretization(Discretization::RungeKutta4).unwrap();
    ball.rates([height.is(speed), speed.is(-9.81 - 0.1 * speed * speed.abs())]).unwrap();
    ball.mode("flight").unwrap().guard(height.predicted().ge(0.0)).unwrap();
    ball.event("bounce")
        .unwrap()
        .guard(height.predicted().le(0.0))
        .unwrap()
        .reset([height.is(-1.0 * height.predicted()), speed.is(-0.5 * speed.predicted())])
        .unwrap();
    let none: Vec<[f64; 0]> = vec![[]; 12];
    let run = ball.simulate(&[1.0, 0.0], &none).unwrap();
    assert!(run.events() >= 1);
    let motion = ball.motion(&run.to_run()).unwrap();
    // Drag has a kink at rest, where no method has its order.
    assert!(motion.errors.iter().all(|error| *error < 5e-4), "{:?}", motion.errors);
}
