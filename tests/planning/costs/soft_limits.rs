//! Limits that a run may exceed at a price.

use carom::ErrorKind;
use carom::hybrid::{HybridSystem, LinearSystem, Region, When};
use carom::internals::hybrid::{Halfspace, SystemVariables, Transition};
use carom::interval::Interval;
use carom::prelude::*;
use proptest::prelude::*;

use crate::common::config;

fn cart(steps: usize, start: f64) -> (Model, SystemVariables) {
    let system = HybridSystem::new(1.0)
        .with_state("x", Interval::new(-9.0, 9.0))
        .with_input("u", Interval::new(-1.0, 1.0))
        .with_transition(Transition::new(
            "go",
            LinearSystem::new([[1.0]], [[1.0]], [0.0]).unwrap(),
        ));
    let mut model = Model::new("m");
    let program = system.write(&mut model, "", steps).unwrap();
    program.require(&mut model, "start", &Region::point([start]), When::At(0)).unwrap();
    (model, program)
}

proptest! {
    #![proptest_config(config(30, "tests/regressions/soft_limits.txt"))]

    /// The run falls by 1 a step as long as it is above the limit.
    #[test]
    fn the_price_is_the_sum_over_the_samples(
        start in -5.0..8.0_f64, limit in -3.0..5.0_f64, linear in 0.0..3.0_f64, square in 0.1..3.0_f64,
    ) {
        let (mut model, program) = cart(5, start);
        let low = Halfspace::new("low", [1.0], limit);
        let price = program.soften(&mut model, "low", &low, linear, square).unwrap();
        model.minimize(price).unwrap();
        let solution = BranchAndBound::default().solve(&model).unwrap();
        let excess = (0..=5).map(|t| (start - f64::from(t) - limit).max(0.0));
        let expected: f64 = excess.map(|e| linear * e + square * e * e).sum();
        let objective = solution.objective().unwrap();
        prop_assert!((objective - expected).abs() <= 1e-5 * expected.max(1.0));
    }
}

#[test]
fn a_high_price_keeps_a_limit_that_can_be_kept() {
    let (mut model, program) = cart(4, 3.0);
    let low = Halfspace::new("low", [1.0], 3.0);
    let price = program.soften(&mut model, "low", &low, 100.0, 0.0).unwrap();
    let x = program.state("x").unwrap().clone();
    model.minimize(price - x[4]).unwrap();
    let solution = BranchAndBound::default().solve(&model).unwrap();
    assert!((solution.value(x[4]).unwrap() - 3.0).abs() < 1e-6);
    // For a low one, the run goes as far as it can: 4 above the limit for a price of 0.1 each.
    let (mut model, program) = cart(4, 3.0);
    let price = program.soften(&mut model, "low", &low, 0.1, 0.0).unwrap();
    let x = program.state("x").unwrap().clone();
    model.minimize(price - x[4]).unwrap();
    let solution = BranchAndBound::default().solve(&model).unwrap();
    assert!((solution.value(x[4]).unwrap() - 7.0).abs() < 1e-6);
    let excess = model.variable_by_name("low_excess[4]").unwrap();
    assert!((solution.value(excess).unwrap() - 4.0).abs() < 1e-6);
}

#[test]
fn limits_of_inputs_hold_by_step() {
    let (mut model, program) = cart(3, 0.0);
    // u >= 1/2 in step 1 only, against a price on u.
    let half = Halfspace::new("half", [0.0, -1.0], vec![f64::INFINITY, -0.5, f64::INFINITY]);
    let price = program.soften(&mut model, "half", &half, 10.0, 0.0).unwrap();
    let u = program.input("u").unwrap().clone();
    let effort: Affine = u.iter().map(Affine::from).sum();
    model.minimize(price + effort).unwrap();
    let solution = BranchAndBound::default().solve(&model).unwrap();
    let inputs: Vec<f64> = (0..3).map(|t| solution.value(u[t]).unwrap()).collect();
    for (value, expected) in inputs.iter().zip([-1.0, 0.5, -1.0]) {
        assert!((value - expected).abs() < 1e-6, "{inputs:?}");
    }
    // There are an excess and a row at step 1 only.
    assert!(model.variable_by_name("half_excess[0]").is_err());
    assert!(model.constraint_by_name("half[1]").is_ok());
}

#[test]
fn bad_prices_are_refused() {
    let (mut model, program) = cart(2, 0.0);
    let before = model.to_string();
    for (linear, square) in [(-1.0, 1.0), (0.0, 0.0), (1.0, -0.5)] {
        let low = Halfspace::new("low", [1.0], 0.0);
        let error = program.soften(&mut model, "low", &low, linear, square).unwrap_err();
        assert!(matches!(error.kind(), ErrorKind::OutOfRange { .. }), "{error}");
    }
    let low = Halfspace::new("low", [1.0], 0.0);
    let error = program.soften(&mut model, "low", &low, f64::NAN, 0.0).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::NotFinite { .. }));
    let wide = Halfspace::new("wide", [1.0, 0.0, 0.0], 0.0);
    let error = program.soften(&mut model, "low", &wide, 1.0, 0.0).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the length of the normal of the half-space `wide` is 3; it must be 1, one entry per state, \
         or 2, with the inputs"
    );
    assert_eq!(model.to_string(), before);
}
