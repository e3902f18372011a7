//! Shadow prices and reduced costs of models without integers.

use carom::ErrorKind;
use carom::prelude::*;
use carom::reformulate::relaxed;
use carom::solution::Multipliers;
use proptest::prelude::*;

use crate::common::case::Case;
use crate::common::config;
use crate::common::generate::{Shape, case};

fn solve(model: &Model, presolve: bool) -> Solution {
    let options = Options::default().with_presolve(presolve);
    BranchAndBound::new(options).solve(model).unwrap()
}

fn multipliers(model: &Model) -> Multipliers {
    solve(model, true).multipliers().expect("verified multipliers").clone()
}

fn is_close(one: f64, other: f64) -> bool {
    (one - other).abs() <= 1e-6
}

/// The case without integers.
fn continuous(mut case: Case) -> Case {
    case.columns.iter_mut().for_each(|column| column.kind = VariableKind::Continuous);
    case.switches.clear();
    case
}

proptest! {
    #![proptest_config(config(200, "tests/regressions/multipliers.txt"))]

    /// The optimum is a convex function of limits and bounds (of a minimisation), and multipliers
    /// are a slope of it: wherever limits and bounds move, the new optimum is not below the line.
    #[test]
    fn they_are_a_slope_of_the_optimum(
        case in case(Shape::QUADRATIC),
        shifts in prop::collection::vec(-4..=4_i32, 20),
        presolve in any::<bool>(),
    ) {
        let case = continuous(case);
        let (mut model, variables) = case.build();
        let solution = solve(&model, presolve);
        prop_assume!(solution.is_optimal());
        let multipliers = solution.multipliers();
        prop_assert!(multipliers.is_some(), "no multipliers");
        let (multipliers, objective) = (multipliers.unwrap(), solution.objective().unwrap());
        let mut line = objective;
        let mut shifts = shifts.into_iter().map(|t| f64::from(t) / 4.0);
        let rows: Vec<_> = model.constraints().map(|row| (row.id(), row.limits())).collect();
        for ((row, limits), t) in rows.into_iter().zip(&mut shifts) {
            line += multipliers.shadow_price(row).unwrap() * t;
            model.set_limits(row, limits.lower + t, limits.upper + t).unwrap();
        }
        for (&variable, t) in variables.iter().zip(&mut shifts) {
            let bounds = model.variable_ref(variable).unwrap().bounds();
            line += multipliers.reduced_cost(variable).unwrap() * t;
            model.set_bounds(variable, bounds.lower + t, bounds.upper + t).unwrap();
        }
        let moved = solve(&model, true);
        if moved.is_optimal() {
            let above = case.sign() * (moved.objective().unwrap() - line);
            prop_assert!(above >= -1e-5 * (1.0 + objective.abs()), "{} below the line", -above);
        }
    }
}

proptest! {
    #![proptest_config(config(100, "tests/regressions/multipliers.txt"))]

    /// The relaxation is a bound, and its multipliers are a slope of its optimum: wherever the
    /// limits of the model's own rows move, the new optimum is not below the line.
    #[test]
    fn those_of_relaxations_are_a_slope(
        case in case(Shape::BOUNDED),
        shifts in prop::collection::vec(-4..=4_i32, 20),
    ) {
        let (mut model, variables) = case.build();
        let solution = solve(&relaxed(&model).unwrap(), true);
        prop_assume!(solution.is_optimal());
        let objective = solution.objective().unwrap();
        if let Some(whole) = solve(&model, true).objective() {
            let above = case.sign() * (whole - objective);
            prop_assert!(above >= -1e-5 * (1.0 + objective.abs()), "{} below", -above);
        }
        prop_assert!(variables.iter().all(|&v| solution.reduced_cost(v).is_ok()));
        let mut line = objective;
        let rows: Vec<_> = model.constraints().map(|row| (row.id(), row.limits())).collect();
        for ((row, limits), t) in rows.into_iter().zip(shifts) {
            let t = f64::from(t) / 4.0;
            line += solution.shadow_price(row).unwrap() * t;
            model.set_limits(row, limits.lower + t, limits.upper + t).unwrap();
        }
        let moved = solve(&relaxed(&model).unwrap(), true);
        if moved.is_optimal() {
            let above = case.sign() * (moved.objective().unwrap() - line);
            prop_assert!(above >= -1e-5 * (1.0 + objective.abs()), "{} below the line", -above);
        }
    }
}

#[test]
fn multipliers_of_a_relaxation_are_its_differences() {
    let mut model = Model::new("m");
    let x = model.integer_family("x", 3, 0.0, 9.0).unwrap();
    let z = model.binary("z").unwrap();
    let need = model.add("need", (2.0 * x[0] + 3.0 * x[1] + x[2]).ge(10.5)).unwrap();
    let room = model.add("room", (x[0] + x[1]).le(3.7)).unwrap();
    model.add("some", z.on().implies(x[2].ge(2.0))).unwrap();
    model.minimize(1.5 * x[0] + 2.0 * x[1] + 1.9 * x[2] - 0.7 * z).unwrap();
    let value = |model: &Model| solve(&relaxed(model).unwrap(), true).objective().unwrap();
    let relaxed = solve(&relaxed(&model).unwrap(), true);
    for row in [need, room] {
        let limits = model.constraints().nth(usize::from(row == room)).unwrap().limits();
        let mut moved = [1e-3, -1e-3].map(|t| {
            let mut model = model.clone();
            model.set_limits(row, limits.lower + t, limits.upper + t).unwrap();
            value(&model)
        });
        moved.reverse();
        let slope = (moved[1] - moved[0]) / 2e-3;
        let price = relaxed.shadow_price(row).unwrap();
        assert!((slope - price).abs() < 1e-4, "{slope} beside {price}");
    }
    // The model itself has none, and says which model does.
    let error = solve(&model, true).shadow_price(need).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the solution has no multipliers (`optimal`); they come with an optimal solution of \
         `BranchAndBound` for a model without integers, such as `reformulate::relaxed(&model)`"
    );
}

/// A product mix: the prices are those of the textbook, with signs for either sense.
#[test]
fn signs_are_those_of_the_models_own_sense() {
    let mut model = Model::new("mix");
    let doors = model.continuous("doors", 0.0, f64::INFINITY).unwrap();
    let windows = model.continuous("windows", 0.0, f64::INFINITY).unwrap();
    let first = model.add("first", doors.le(4.0)).unwrap();
    let second = model.add("second", (2.0 * windows).le(12.0)).unwrap();
    let third = model.add("third", (3.0 * doors + 2.0 * windows).le(18.0)).unwrap();
    for sign in [1.0, -1.0] {
        let profit = sign * (3.0 * doors + 5.0 * windows);
        let sense = if sign > 0.0 { Sense::Maximize } else { Sense::Minimize };
        model.set_objective(sense, profit).unwrap();
        let found = multipliers(&model);
        let prices = [first, second, third].map(|row| found.shadow_price(row).unwrap());
        assert_eq!(prices[0], 0.0);
        assert!(is_close(prices[1], sign * 1.5) && is_close(prices[2], sign), "{prices:?}");
        assert_eq!(found.reduced_cost(doors).unwrap(), 0.0);
    }
}

#[test]
fn bounds_equalities_curvature_and_parameters() {
    let mut model = Model::new("m");
    let x = model.continuous("x", -10.0, 10.0).unwrap();
    let y = model.continuous("y", 2.0, 10.0).unwrap();
    let p = model.parameter("p", 1.0, 0.0, 5.0).unwrap();
    let sum = model.add("sum", (x + y - p).equals(4.0)).unwrap();
    // x = 3 and y = 2: the slope along the row is 6 for x and 20 for y.
    model.minimize(x.square() + 5.0 * y.square()).unwrap();
    let found = multipliers(&model);
    assert!(is_close(found.shadow_price(sum).unwrap(), 6.0));
    assert!(is_close(found.reduced_cost(y).unwrap(), 14.0));
    assert!(is_close(found.reduced_cost(p).unwrap(), 6.0));
    assert_eq!(found.reduced_cost(x).unwrap(), 0.0);
}

/// `|x|` needs no integers here, and the price of the row goes through it.
#[test]
fn functions_without_integers_have_prices() {
    let mut model = Model::new("m");
    let x = model.continuous("x", -10.0, 10.0).unwrap();
    let size = model.absolute("size", x).unwrap();
    let row = model.add("row", x.le(-3.0)).unwrap();
    model.minimize(2.0 * size).unwrap();
    assert!(is_close(multipliers(&model).shadow_price(row).unwrap(), -2.0));
}

#[test]
fn there_are_none_with_integers_or_without_an_optimum() {
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.0, 10.0).unwrap();
    let row = model.add("row", x.ge(1.5)).unwrap();
    model.minimize(x).unwrap();
    let mut other = model.clone();
    let found = multipliers(&model);
    assert!(is_close(found.shadow_price(row).unwrap(), 1.0));

    let free = model.continuous("free", f64::NEG_INFINITY, 0.0).unwrap();
    let error = found.reduced_cost(free).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::ForeignHandle { .. }));
    model.minimize(free).unwrap();
    assert!(solve(&model, true).multipliers().is_none());
    other.integer("k", 0.0, 3.0).unwrap();
    assert!(solve(&other, true).multipliers().is_none());
    other.set_limits(row, 11.0, 12.0).unwrap();
    assert!(solve(&other, true).multipliers().is_none());

    let mut stranger = Model::new("stranger");
    let x = stranger.continuous("x", 0.0, 1.0).unwrap();
    let row = stranger.add("row", x.le(0.5)).unwrap();
    assert!(found.shadow_price(row).is_err() && found.reduced_cost(x).is_err());
}

#[test]
fn a_lowered_model_passes_them_on() {
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.0, 10.0).unwrap();
    let row = model.add("row", x.ge(1.5)).unwrap();
    model.minimize(2.0 * x).unwrap();
    let lowered = carom::reformulate::lower(&model).unwrap();
    let solution = lowered.solve(&model, &mut BranchAndBound::default()).unwrap();
    let found = solution.multipliers().expect("multipliers of the lowered model");
    assert!(is_close(found.shadow_price(row).unwrap(), 2.0));
}

#[test]
fn programs_with_norms_have_multipliers() {
    let mut model = Model::new("norm");
    let (x, y) =
        (model.continuous("x", -9.0, 9.0).unwrap(), model.continuous("y", -9.0, 9.0).unwrap());
    let length = model.continuous("length", 0.0, 20.0).unwrap();
    model.add("length", carom::model::norm([3.0 * x, 4.0 * y]).le(length)).unwrap();
    let far = model.add("far", (x + y).ge(5.0)).unwrap();
    model.minimize(length + 0.5).unwrap();
    let solution = BranchAndBound::default().solve(&model).unwrap();
    // At (3.2, 1.8) the length is 12, and proportional to the limit of the row.
    assert!((solution.objective().unwrap() - 12.5).abs() < 1e-6);
    assert!((solution.shadow_price(far).unwrap() - 2.4).abs() < 1e-5);
    for variable in [x, y, length] {
        assert!(solution.reduced_cost(variable).unwrap().abs() < 1e-5);
    }
    // A bound that presses: less of `x` makes it longer, by 16 * 4 / sqrt(3^2 + 16^2) less 9 /
    // sqrt(...).
    model.set_bounds(x, -9.0, 1.0).unwrap();
    let solution = BranchAndBound::default().solve(&model).unwrap();
    let root = 265_f64.sqrt();
    assert!((solution.objective().unwrap() - 0.5 - root).abs() < 1e-6);
    assert!((solution.shadow_price(far).unwrap() - 64.0 / root).abs() < 1e-5);
    assert!((solution.reduced_cost(x).unwrap() - (9.0 - 64.0) / root).abs() < 1e-5);
}
