//! Nonlinear expressions in models: statements of every kind, texts, files, errors, limits.

use std::time::Duration;

use carom::ErrorKind;
use carom::interval::Interval;
use carom::model::{Function, Nonlinear, SmoothFunction};
use carom::prelude::*;

fn solve(model: &Model) -> Solution {
    BranchAndBound::default().solve(model).unwrap()
}

fn assert_near(found: f64, meant: f64) {
    assert!((found - meant).abs() <= 1e-4 * meant.abs().max(1.0), "{found} for {meant}");
}

#[test]
fn values_of_expressions_are_those_of_floats() {
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.5, 0.5).unwrap();
    let y = model.continuous("y", -0.25, -0.25).unwrap();
    let (a, b) = (0.5_f64, -0.25_f64);
    let all: Vec<(Nonlinear, f64)> = vec![
        (x.sin() + y.cos() * 2.0 - x.tan(), a.sin() + 2.0 * b.cos() - a.tan()),
        (x.exp() * y.exp() / (x - y), a.exp() * b.exp() / (a - b)),
        ((x * y * x).ln_of_square(), ((a * b * a).powi(2)).ln()),
        (x.sqrt() + y.abs() + x.pow(-2.0), a.sqrt() + b.abs() + a.powi(-2)),
        (y.atan2(x) + x.hypot(y), b.atan2(a) + a.hypot(b)),
        (y.sinh() + y.cosh() + y.tanh(), b.sinh() + b.cosh() + b.tanh()),
        (x.asin() + x.acos() + y.atan(), a.asin() + a.acos() + b.atan()),
        (Nonlinear::from(x).max(y) - Nonlinear::from(x).min(y), a - b),
        ((x - y).square() / 3.0 - y.square() * x, (a - b).powi(2) / 3.0 - b * b * a),
        (2.0 / x - (3.0 * y + 1.0) / (x + 1.0), 2.0 / a - (3.0 * b + 1.0) / (a + 1.0)),
    ];
    for (k, (expression, value)) in all.into_iter().enumerate() {
        let z = model.continuous(("z", k), -100.0, 100.0).unwrap();
        model.add(("z", k), expression.equals(z)).unwrap();
        let point = solve(&model);
        assert!((point.value(z).unwrap() - value).abs() < 1e-6, "{k}: {value}");
    }
}

trait LnOfSquare {
    fn ln_of_square(self) -> Nonlinear;
}

impl LnOfSquare for Nonlinear {
    fn ln_of_square(self) -> Nonlinear {
        self.square().ln()
    }
}

#[test]
fn rows_hold_under_conditions_and_in_disjunctions() {
    let mut model = Model::new("rooms");
    let x = model.continuous("x", -2.0, 2.0).unwrap();
    let y = model.continuous("y", -2.0, 2.0).unwrap();
    let on = model.binary("on").unwrap();
    // Outside of a ring, or inside of a smaller one.
    let radius = x.square() + y.square();
    let ring = Nonlinear::from(radius);
    model.add("ring", either(ring.ge(4.0)).or(ring.le(0.25))).unwrap();
    model.add("sine", on.on().implies(x.sin().ge(y))).unwrap();
    model.add("both", on.off().implies_all([x.exp().le(1.0), y.exp().le(1.0)])).unwrap();
    model.maximize(x + 3.0 * y - 0.5 * on).unwrap();
    // On: outside, y = sin x with the slope -1/3; off: x and y at most 0.
    let angle = (-1.0_f64 / 3.0).acos();
    assert_near(solve(&model).objective().unwrap(), angle + 3.0 * angle.sin() - 0.5);
    model.set_bounds(on, 0.0, 0.0).unwrap();
    assert_near(solve(&model).objective().unwrap(), 0.0);
}

#[test]
fn shared_parts_are_one_variable() {
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.0, 1.0).unwrap();
    let wave = (3.0 * x).sin();
    model.add("first", (&wave * &wave + &wave).le(1.0)).unwrap();
    model.add("second", (3.0 * x).sin().ge(0.1)).unwrap();
    let functions: Vec<String> = model
        .functions()
        .map(|own| own.function().text(&|v| model.name_of(v).to_string()))
        .collect();
    assert_eq!(functions, ["sin(3 x)", "(first_part1)²"]);
    assert!(model.to_string().contains("first_part1 = sin(3 x)"));
}

#[test]
fn functions_of_affine_and_binary_arguments_stay_simple() {
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.0, 1.0).unwrap();
    let z = model.binary("z").unwrap();
    model.add("affine", Nonlinear::from(x).pow(1.0).le(0.5)).unwrap();
    model.add("binary", (Nonlinear::from(z) * (x + 1.0)).le(1.2)).unwrap();
    model.add("constant", (Nonlinear::from(4.0).sqrt() * x).le(1.0)).unwrap();
    let kinds: Vec<bool> = model.functions().map(|own| own.function().is_smooth()).collect();
    assert_eq!(kinds, [false]);
    assert!(matches!(model.functions().next().unwrap().function(), Function::Product { .. }));
}

#[test]
fn poles_and_missing_bounds_are_errors_with_names() {
    let mut model = Model::new("m");
    let x = model.continuous("x", -1.0, 1.0).unwrap();
    model.minimize(1.0 / x).unwrap();
    let error = BranchAndBound::default().solve(&model).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::Pole { .. }) && error.code() == "pole", "{error}");
    assert!(error.to_string().contains("(x)^-1") && error.to_string().contains("-1"), "{error}");
    model.set_bounds(x, 0.5, 1.0).unwrap();
    let solution = solve(&model);
    assert_near(solution.objective().unwrap(), 1.0);
    assert!(solution.is_optimal());

    let mut model = Model::new("m");
    let x = model.continuous("x", f64::NEG_INFINITY, f64::INFINITY).unwrap();
    let y = model.continuous("y", 0.0, 1.0).unwrap();
    model.minimize(Nonlinear::from(x * y) + x).unwrap();
    let error = BranchAndBound::default().solve(&model).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::UnboundedFunction { .. }), "{error}");
    assert!(error.code() == "no-bound" && error.to_string().contains("`x` has no lower bound"));
}

#[test]
fn objectives_without_a_limit_are_told_apart_from_contradictions() {
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.0, 3.0).unwrap();
    let z = model.continuous("z", f64::NEG_INFINITY, f64::INFINITY).unwrap();
    model.add("row", (x.sin() + 0.0 * z).le(0.5)).unwrap();
    model.minimize(z + x.exp()).unwrap();
    let unbounded = solve(&model);
    assert_eq!(unbounded.termination(), Termination::Unbounded);
    assert_eq!(unbounded.bound(), f64::NEG_INFINITY);
    model.add("more", x.sin().ge(0.75)).unwrap();
    assert!(solve(&model).is_infeasible());

    // The logarithm has no least value at the end of the range.
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.0, 1.0).unwrap();
    let y = model.continuous("y", 0.0, 1.0).unwrap();
    model.minimize(x.ln() + (5.0 * y).sin()).unwrap();
    let mut solver = BranchAndBound::default();
    solver.options_mut().time_limit = Some(Duration::from_secs(20));
    match solver.solve(&model) {
        Err(error) => assert_eq!(error.code(), "pole"),
        Ok(solution) => assert_eq!(solution.termination(), Termination::Stalled),
    }
}

#[test]
fn functions_are_not_nested_without_end() {
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.0, 1.0).unwrap();
    let mut wave = Nonlinear::from(x);
    for _ in 0..100_000 {
        wave = wave.sin();
    }
    let error = model.add("row", wave.le(0.5)).unwrap_err();
    assert!(error.to_string().contains("functions inside each other in `row`"), "{error}");
    assert_eq!((model.variable_count(), model.function_count()), (1, 0));
}

#[test]
fn arguments_stay_in_domains() {
    let mut model = Model::new("m");
    let x = model.continuous("x", -5.0, 5.0).unwrap();
    let root = model.nonlinear("root", (x - 1.0).sqrt()).unwrap();
    model.minimize(x + 0.0 * root).unwrap();
    assert_near(solve(&model).value(x).unwrap(), 1.0);
    model.set_bounds(x, -5.0, 0.5).unwrap();
    assert!(solve(&model).is_infeasible());
}

#[test]
fn limits_leave_the_best_point_and_a_bound() {
    let mut model = Model::new("waves");
    let x = model.continuous_family("x", 6, -9.0, 9.0).unwrap();
    let mut cost = Nonlinear::zero();
    for k in 0..6 {
        let next = x[(k + 1) % 6];
        cost += (3.0 * x[k]).sin() * (2.0 * next).cos() + 0.01 * x[k] * next;
    }
    model.minimize(cost).unwrap();
    let mut solver = BranchAndBound::default();
    solver.options_mut().node_limit = Some(20);
    let solution = solver.solve(&model).unwrap();
    assert_eq!(solution.termination(), Termination::NodeLimit);
    assert!(solution.bound() <= solution.objective().unwrap() && solution.bound() >= -20.0);
    assert!(solution.verification().unwrap().holds());
    solver.options_mut().node_limit = None;
    solver.options_mut().time_limit = Some(Duration::ZERO);
    assert_eq!(solver.solve(&model).unwrap().termination(), Termination::TimeLimit);
}

#[test]
fn an_incumbent_callback_ends_the_search() {
    let mut model = Model::new("m");
    let x = model.continuous_family("x", 3, -3.0, 3.0).unwrap();
    model.minimize(x[0].sin() * x[1].cos() * x[2].sin() + x[0].square() * 0.01).unwrap();
    let mut seen = 0;
    let mut stop = |best: &carom::solver::Incumbent<'_>| {
        seen += 1;
        assert!(best.point.value(x[0]).is_ok());
        std::ops::ControlFlow::Break(())
    };
    let mut control = Control::default().with_incumbent(&mut stop);
    let solution = BranchAndBound::default().solve_with(&model, &mut control).unwrap();
    assert!(solution.point().is_some());
    assert!(seen >= 1);
}

#[test]
fn parameters_are_arguments() {
    let mut model = Model::new("m");
    let p = model.parameter("p", 1.0, 0.5, 2.0).unwrap();
    let x = model.continuous("x", 0.0, 3.0).unwrap();
    model.add("row", (x * x * p).le(2.0)).unwrap();
    model.maximize(x).unwrap();
    let mut solver = BranchAndBound::default();
    let mut prepared = solver.prepare(&model).unwrap();
    for value in [0.5, 1.0, 2.0] {
        let solution = prepared.solve(&[(p, value)], &mut Control::default()).unwrap();
        assert_near(solution.objective().unwrap(), (2.0 / value).sqrt());
    }
}

#[test]
fn what_rows_cannot_say_is_refused() {
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.0, 3.0).unwrap();
    model.add("row", x.exp().le(2.0)).unwrap();
    model.maximize(x).unwrap();
    let error = carom::reformulate::lower(&model).unwrap_err();
    assert!(error.code() == "unsupported" && error.to_string().contains("row_part1"), "{error}");
    assert!(carom::model::lp::write(&model).is_err() && carom::model::mps::write(&model).is_err());
    // A variable of another model.
    let mut other = Model::new("other");
    let foreign = other.add("row", x.sin().le(0.5)).unwrap_err();
    assert!(matches!(foreign.kind(), ErrorKind::ForeignHandle { .. }));
    assert_eq!((other.variable_count(), other.function_count()), (0, 0));
}

/// A line with a kink that is rounded off.
#[derive(Debug)]
struct Softplus;

impl SmoothFunction for Softplus {
    fn name(&self) -> &str {
        "softplus"
    }

    fn value(&self, x: f64) -> f64 {
        x.max(0.0) + (-x.abs()).exp().ln_1p()
    }

    fn derivative(&self, x: f64) -> f64 {
        1.0 / (1.0 + (-x).exp())
    }

    fn range(&self, x: Interval) -> Interval {
        Interval::new(self.value(x.lower) * (1.0 - 1e-14), self.value(x.upper) * (1.0 + 1e-14))
    }

    fn slope_range(&self, x: Interval) -> Interval {
        Interval::new(self.derivative(x.lower) - 1e-14, self.derivative(x.upper) + 1e-14)
    }

    fn curvature_range(&self, _: Interval) -> Interval {
        Interval::new(0.0, 0.25)
    }
}

#[test]
fn functions_of_ones_own_are_minimised_and_maximised() {
    let mut model = Model::new("m");
    let x = model.continuous("x", -4.0, 4.0).unwrap();
    model.minimize(x.own(Softplus) - 0.25 * x).unwrap();
    // Where the slope is 1/4.
    assert_near(solve(&model).value(x).unwrap(), -(3.0_f64.ln()));
    model.maximize(x.own(Softplus) - 0.25 * x).unwrap();
    assert_near(solve(&model).objective().unwrap(), Softplus.value(4.0) - 1.0);
}

#[test]
fn contradictions_are_explained() {
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.0, 3.0).unwrap();
    model.add("low", x.exp().le(2.0)).unwrap();
    model.add("high", x.ge(1.0)).unwrap();
    model.add("idle", x.le(2.5)).unwrap();
    let mut solver = BranchAndBound::default();
    let explanation = carom::explain::infeasibility(
        &model,
        &carom::explain::ExplainOptions::default(),
        &mut solver,
    )
    .unwrap();
    let text = explanation.to_string();
    assert!(text.contains("low") && text.contains("high") && !text.contains("idle"), "{text}");
}

#[cfg(feature = "serde")]
#[test]
fn models_and_expressions_survive_serde() {
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.1, 3.0).unwrap();
    let y = model.continuous("y", 0.1, 3.0).unwrap();
    let row = (x.ln() * y.sin() / (x + y) + x.pow(1.5)).within(f64::NEG_INFINITY, 2.0);
    let text = serde_json::to_string(&row).unwrap();
    let read: carom::model::NonlinearRow = serde_json::from_str(&text).unwrap();
    assert_eq!(read, row);
    model.add("row", row).unwrap();
    model.maximize(x + y).unwrap();
    let text = serde_json::to_string(&model).unwrap();
    let read: Model = serde_json::from_str(&text).unwrap();
    assert_eq!(read.to_string(), model.to_string());
    assert_near(solve(&read).objective().unwrap(), solve(&model).objective().unwrap());
    let own = x.own(Softplus).le(1.0);
    assert!(serde_json::to_string(&own).unwrap_err().to_string().contains("softplus"));
}
