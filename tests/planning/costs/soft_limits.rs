//! Limits that a run may exceed at a price.

use carom::ErrorKind;
use carom::hybrid::{HybridProgram, HybridSystem, State};
use carom::prelude::*;
use proptest::prelude::*;

use crate::common::config;

/// A cart that moves by at most 1 a step, and a lower end of its push by step.
struct Cart {
    program: HybridProgram,
    x: State,
    u: Input,
    half: Variable,
}

fn cart(steps: usize, start: f64) -> Cart {
    let mut system = HybridSystem::new(1.0);
    let x = system.state("x", -9.0, 9.0).unwrap();
    let u = system.input("u", -1.0, 1.0).unwrap();
    let half = system.series("half", [-9.0, 0.5, -9.0]).unwrap();
    system.mode("go").unwrap().next([(x, x + u)]).unwrap();
    let mut program = system.program(steps).unwrap();
    program.start([x.equals(start)]).unwrap();
    Cart { program, x, u, half }
}

proptest! {
    #![proptest_config(config(30, "tests/regressions/soft_limits.txt"))]

    /// The run falls by 1 a step as long as it is above the limit.
    #[test]
    fn the_price_is_the_sum_over_the_samples(
        start in -5.0..8.0_f64, limit in -3.0..5.0_f64, linear in 0.0..3.0_f64, square in 0.1..3.0_f64,
    ) {
        let Cart { mut program, x, .. } = cart(5, start);
        let low = program.soften("low", x.le(limit), linear, square).unwrap();
        program.minimize(low.cost).unwrap();
        let plan = program.solve(&mut BranchAndBound::default()).unwrap();
        let excess = (0..=5).map(|t| (start - f64::from(t) - limit).max(0.0));
        let expected: f64 = excess.map(|e| linear * e + square * e * e).sum();
        let objective = plan.solution.objective().unwrap();
        prop_assert!((objective - expected).abs() <= 1e-5 * expected.max(1.0));
    }

    /// A limit at both ends costs the excess at each; with inputs fixed, that is a plain sum.
    #[test]
    fn both_ends_cost_their_excess(
        start in -4.0..4.0_f64, lower in -4.0..2.0_f64, width in 0.0..3.0_f64,
        inputs in prop::collection::vec(-1.0..1.0_f64, 5), factor in prop::sample::select(vec![-2.0, 0.5]),
    ) {
        let Cart { mut program, x, u, .. } = cart(5, start);
        for (t, value) in inputs.iter().enumerate() {
            let input = program.variable(u, t).unwrap();
            program.model_mut().fix(input, *value).unwrap();
        }
        let upper = lower + width;
        let band = program.soften("band", (factor * x + 0.5).within(lower, upper), 2.0, 1.0).unwrap();
        program.minimize(band.cost).unwrap();
        let plan = program.solve(&mut BranchAndBound::default()).unwrap();
        let (mut at, mut cost, mut sum) = (start, 0.0, 0.0);
        for t in 0..=5 {
            let value = factor * at + 0.5;
            let excess = (value - upper).max(lower - value).max(0.0);
            (cost, sum) = (cost + 2.0 * excess + excess * excess, sum + excess);
            at += inputs.get(t).copied().unwrap_or(0.0);
        }
        let objective = plan.solution.objective().unwrap();
        prop_assert!((objective - cost).abs() <= 1e-5 * cost.max(1.0), "{objective} {cost}");
        prop_assert!((plan.value(band.excess, 0).unwrap() - sum).abs() <= 1e-5 * sum.max(1.0));
    }
}

#[test]
fn a_high_price_keeps_a_limit_that_can_be_kept() {
    let Cart { mut program, x, .. } = cart(4, 3.0);
    let low = program.soften("low", x.le(3.0), 100.0, 0.0).unwrap();
    let end = program.end(x).unwrap();
    program.minimize(low.cost - &end).unwrap();
    let plan = program.solve(&mut BranchAndBound::default()).unwrap();
    assert!((plan.value(x, 4).unwrap() - 3.0).abs() < 1e-6);
    // For a low one, the run goes as far as it can: 4 above the limit for a price of 0.1 each.
    let Cart { mut program, x, .. } = cart(4, 3.0);
    let low = program.soften("low", x.le(3.0), 0.1, 0.0).unwrap();
    let end = program.end(x).unwrap();
    program.minimize(low.cost - &end).unwrap();
    let plan = program.solve(&mut BranchAndBound::default()).unwrap();
    assert!((plan.value(x, 4).unwrap() - 7.0).abs() < 1e-6);
    let excess = program.model().variable_by_name("low_excess[4]").unwrap();
    assert!((plan.value(excess, 0).unwrap() - 4.0).abs() < 1e-6);
    assert!((plan.value(low.excess, 0).unwrap() - 10.0).abs() < 1e-6);
}

#[test]
fn limits_of_inputs_hold_by_step() {
    // u >= 1/2 in step 1 only, against a price on u.
    let Cart { mut program, u, half, .. } = cart(3, 0.0);
    let soft = program.soften("half", u.ge(half), 10.0, 0.0).unwrap();
    let effort = program.sum(u).unwrap();
    program.minimize(soft.cost + effort).unwrap();
    let plan = program.solve(&mut BranchAndBound::default()).unwrap();
    let inputs = plan.values(u).unwrap();
    for (value, expected) in inputs.iter().zip([-1.0, 0.5, -1.0]) {
        assert!((value - expected).abs() < 1e-6, "{inputs:?}");
    }
    // There are an excess and a row at step 1 only.
    assert!(program.model().variable_by_name("half_excess[0]").is_err());
    assert!(program.model().constraint_by_name("half[1]").is_ok());
}

#[test]
fn bad_prices_are_refused() {
    let Cart { mut program, x, .. } = cart(2, 0.0);
    let before = program.model().to_string();
    for (linear, square) in [(-1.0, 1.0), (0.0, 0.0), (1.0, -0.5)] {
        let error = program.soften("low", x.le(0.0), linear, square).unwrap_err();
        assert!(matches!(error.kind(), ErrorKind::OutOfRange { .. }), "{error}");
    }
    let error = program.soften("low", x.le(0.0), f64::NAN, 0.0).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::NotFinite { .. }));
    let error = program.soften("low", x.predicted().le(0.0), 1.0, 0.0).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::Misplaced { .. }));
    let foreign = Model::new("other").continuous("y", 0.0, 1.0).unwrap();
    let error = program.soften("low", (x + foreign).le(0.0), 1.0, 0.0).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::ForeignHandle { .. }));
    // Rows that a model refuses are refused here too.
    let error = program.soften("low", x.within(2.0, 1.0), 1.0, 0.0).unwrap_err();
    assert_eq!(error.to_string(), "bounds of `low` are crossed: 2 > 1; swap or relax them");
    let error = program.soften("low", x.le(f64::NAN), 1.0, 0.0).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::NotFinite { .. }), "{error}");
    let endless = x.within(f64::NEG_INFINITY, f64::INFINITY);
    let error = program.soften("low", endless, 1.0, 0.0).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::UnlimitedRow { .. }), "{error}");
    let error = program.soften("low", (x - x).le(-1.0), 1.0, 0.0).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::EmptyRow { .. }), "{error}");
    assert_eq!(program.model().to_string(), before);
    let _ = program.soften("low", x.le(0.0), 1.0, 0.0).unwrap();
    let error = program.soften("low", x.le(0.0), 1.0, 0.0).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::DuplicateName { .. }), "{error}");
}
