//! The same program in other words has the same answer.
//!
//! Random small programs (binaries, integers, continuous and free variables, indicators of both
//! polarities, linear and convex quadratic costs) are solved, rewritten and solved again. No
//! knowledge of the optimum is needed: order of variables and rows, their units and that of the
//! objective, complements of variables, signs of rows, origins of variables, and minimising or
//! maximising must not show in status and optimum; less freedom never gives a smaller minimum;
//! threads change nothing but the time; one thread is deterministic; what is undone leaves no
//! trace.

use crate::common::case::Case;
use crate::common::config;
use crate::common::generate::{Shape, case};
use crate::common::other_words::{complemented, in_units, negated, rows};
use crate::common::quadratic_program::dot;
use carom::prelude::*;
use proptest::prelude::*;
use proptest::sample::select;

/// Agreement of optima, relative and absolute: the relative gap that a solve may leave.
const AGREEMENT: f64 = 1e-6;

/// Most columns and most rows of a kind of a case.
const MOST: usize = 8;

const REGRESSIONS: &str = "tests/regressions/invariance.txt";

fn solve(model: &Model) -> Solution {
    BranchAndBound::default().solve(model).expect("a solvable model")
}

/// Status and, where there is an optimum, the cost that is minimised.
fn answer(case: &Case) -> (Termination, f64) {
    let (model, _) = case.build();
    cost(&solve(&model), case.sign())
}

/// Status and minimised cost of a solution; infinite as the status says where there is none.
fn cost(solution: &Solution, sign: f64) -> (Termination, f64) {
    let cost = match solution.termination() {
        Termination::Optimal => sign * solution.objective().expect("an optimum"),
        Termination::Infeasible => f64::INFINITY,
        Termination::Unbounded => f64::NEG_INFINITY,
        other => panic!("a small program ended with `{other}`"),
    };
    (solution.termination(), cost)
}

fn near(a: f64, b: f64) -> bool {
    a == b || (a - b).abs() <= AGREEMENT * a.abs().max(1.0)
}

fn same(a: (Termination, f64), b: (Termination, f64)) -> bool {
    a.0 == b.0 && near(a.1, b.1)
}

fn programs() -> impl Strategy<Value = Case> {
    prop_oneof![case(Shape::LINEAR), case(Shape::QUADRATIC), case(Shape::BOUNDED)]
}

fn order() -> impl Strategy<Value = Vec<usize>> {
    Just((0..MOST).collect::<Vec<_>>()).prop_shuffle()
}

/// The items in the order of `order`, which may name more than there are.
fn reordered<T: Clone>(items: &[T], order: &[usize]) -> Vec<T> {
    order.iter().filter_map(|&k| items.get(k).cloned()).collect()
}

/// The program with its column `order[k]` in place `k`.
fn with_columns_in(case: &Case, order: &[usize]) -> Case {
    let order: Vec<usize> = order.iter().copied().filter(|&j| j < case.columns.len()).collect();
    let mut other = case.clone();
    other.columns = reordered(&case.columns, &order);
    other.linear = reordered(&case.linear, &order);
    for square in &mut other.squares {
        square.coefficients = reordered(&square.coefficients, &order);
    }
    for line in rows(&mut other) {
        line.coefficients = reordered(&line.coefficients, &order);
    }
    for switch in &mut other.switches {
        switch.binary = order.iter().position(|&j| j == switch.binary).expect("a permutation");
    }
    other
}

/// The program in the variables `x + shift`.
fn translated(case: &Case, shift: &[f64]) -> Case {
    let mut other = case.clone();
    for (column, shift) in other.columns.iter_mut().zip(shift) {
        column.lower += shift;
        column.upper += shift;
    }
    other.constant -= dot(&case.linear, shift);
    for square in &mut other.squares {
        square.constant -= dot(&square.coefficients, shift);
    }
    for line in rows(&mut other) {
        let change = dot(&line.coefficients, shift);
        line.lower += change;
        line.upper += change;
    }
    other
}

/// Raises a lower limit by `up` and lowers an upper one by `down`, where that leaves something.
fn tightened(lower: f64, upper: f64, up: f64, down: f64) -> (f64, f64) {
    let lower = if lower + up <= upper { lower + up } else { lower };
    (lower, if upper - down >= lower { upper - down } else { upper })
}

proptest! {
    #![proptest_config(config(200, REGRESSIONS))]

    #[test]
    fn the_order_of_variables_and_rows(
        case in programs(),
        columns in order(),
        lines in order(),
        switches in order(),
    ) {
        let mut other = with_columns_in(&case, &columns);
        other.lines = reordered(&other.lines, &lines);
        other.switches = reordered(&other.switches, &switches);
        let (a, b) = (answer(&case), answer(&other));
        prop_assert!(same(a, b), "{a:?}, reordered {b:?}\n{}\n{}", case.build().0, other.build().0);
    }

    #[test]
    fn the_units_of_rows(
        case in programs(),
        factors in prop::collection::vec(select(vec![0.5, 1.0, 2.0, 3.0, 10.0, 64.0]), 2 * MOST),
    ) {
        let mut other = case.clone();
        rows(&mut other).zip(&factors).for_each(|(line, factor)| line.scale *= factor);
        let (a, b) = (answer(&case), answer(&other));
        prop_assert!(same(a, b), "{a:?}, scaled {b:?}\n{}\n{}", case.build().0, other.build().0);
    }

    #[test]
    fn the_units_of_variables_and_rows(
        case in programs(),
        powers in prop::collection::vec(-16i32..=16, 3 * MOST),
    ) {
        let other = in_units(&case, &powers[..MOST], &powers[MOST..]);
        let (a, b) = (answer(&case), answer(&other));
        prop_assert!(same(a, b), "{a:?}, in units {b:?}\n{}\n{}", case.build().0, other.build().0);
    }

    #[test]
    fn complements_and_signs(
        case in programs(),
        which in prop::collection::vec(any::<bool>(), 3 * MOST),
    ) {
        let other = negated(&complemented(&case, &which[..MOST]), &which[MOST..]);
        let (a, b) = (answer(&case), answer(&other));
        prop_assert!(same(a, b), "{a:?}, turned {b:?}\n{}\n{}", case.build().0, other.build().0);
    }

    #[test]
    fn the_unit_of_the_objective(
        case in programs(),
        factor in select(vec![0.25, 0.5, 3.0, 8.0, 100.0]),
    ) {
        let mut other = case.clone();
        other.constant *= factor;
        other.linear.iter_mut().for_each(|a| *a *= factor);
        other.squares.iter_mut().for_each(|square| square.weight *= factor);
        // The absolute gap is in the objective's unit, so it is another number in another unit.
        let gap = factor * Options::default().absolute_gap;
        let mut solver = BranchAndBound::new(Options::default().with_absolute_gap(gap));
        let scaled = solver.solve(&other.build().0).expect("a solvable model");
        let (a, b) = (answer(&case), cost(&scaled, other.sign()));
        let back = (b.0, b.1 / factor);
        prop_assert!(same(a, back), "{a:?}, scaled {back:?}\n{}", case.build().0);
    }

    #[test]
    fn the_origin_of_variables(
        case in programs(),
        shift in prop::collection::vec(-6i32..=6, MOST),
    ) {
        // Continuous variables by halves, integers by whole numbers, binaries not at all.
        let shift: Vec<f64> = case.columns.iter().zip(shift).map(|(column, by)| match column.kind {
            VariableKind::Continuous => 0.5 * f64::from(by),
            VariableKind::Integer => f64::from(by),
            VariableKind::Binary => 0.0,
        }).collect();
        let other = translated(&case, &shift);
        let (a, b) = (answer(&case), answer(&other));
        prop_assert!(same(a, b), "{a:?}, moved {b:?}\n{}\n{}", case.build().0, other.build().0);
    }

    #[test]
    fn maximising_is_minimising_the_negative(case in programs()) {
        let other = Case { maximize: !case.maximize, ..case.clone() };
        let (a, b) = (solve(&case.build().0), solve(&other.build().0));
        prop_assert_eq!(a.termination(), b.termination());
        // Multiplying by -1 is exact, so everything is the same to the last bit.
        prop_assert_eq!(a.bound(), -b.bound());
        prop_assert_eq!(a.objective(), b.objective().map(|objective| -objective));
        prop_assert_eq!(a.point().map(|p| p.as_slice()), b.point().map(|p| p.as_slice()));
        prop_assert_eq!(a.gap(), b.gap());
        prop_assert_eq!(a.statistics().nodes, b.statistics().nodes);
    }

    #[test]
    fn less_freedom_costs_no_less(
        case in programs(),
        steps in prop::collection::vec(select(vec![0.0, 0.0, 0.5, 1.0, 2.0]), 6 * MOST),
    ) {
        let (mut model, variables) = case.build();
        let (sign, before) = (case.sign(), cost(&solve(&model), case.sign()));
        let mut steps = steps.into_iter();
        let mut step = || steps.next().expect("enough steps");
        for (column, &variable) in case.columns.iter().zip(&variables) {
            let (lower, upper) = tightened(column.lower, column.upper, step(), step());
            model.set_bounds(variable, lower, upper).expect("bounds in order");
        }
        let bounds = cost(&solve(&model), sign);
        for (i, line) in case.lines.iter().enumerate() {
            let row = model.constraint_by_name(format!("r{i}")).expect("a row");
            let (lower, upper) = tightened(line.lower, line.upper, step(), step());
            model.set_limits(row, lower, upper).expect("limits in order");
        }
        for (i, switch) in case.switches.iter().enumerate() {
            let row = model.indicator_by_name(format!("i{i}")).expect("an indicator");
            let (lower, upper) = tightened(switch.line.lower, switch.line.upper, step(), step());
            model.set_indicator_limits(row, lower, upper).expect("limits in order");
        }
        let limits = cost(&solve(&model), sign);
        for (wider, tighter) in [(before, bounds), (bounds, limits)] {
            let fine = tighter.1 >= wider.1 || near(wider.1, tighter.1);
            prop_assert!(fine, "{wider:?}, tighter {tighter:?}\n{}\n{model}", case.build().0);
        }
    }

    #[test]
    fn two_threads_agree_with_one(case in programs()) {
        let (model, _) = case.build();
        let two = BranchAndBound::new(Options::default().with_threads(2)).solve(&model);
        let two = two.expect("a solvable model");
        let (a, b) = (cost(&solve(&model), case.sign()), cost(&two, case.sign()));
        prop_assert!(same(a, b), "{a:?}, two threads {b:?}\n{model}");
        prop_assert!(two.verification().is_none_or(Verification::holds));
    }

    #[test]
    fn one_thread_is_deterministic(case in programs()) {
        let (model, _) = case.build();
        let mut used = BranchAndBound::default();
        let first = used.solve(&model).expect("a solvable model");
        let again = [
            used.solve(&model).expect("the same solver"),
            solve(&model.clone()),
            solve(&case.build().0),
        ];
        for other in again {
            assert_identical(&first, &other)?;
        }
    }

    #[test]
    fn what_is_undone_leaves_no_trace(
        case in programs(),
        which in 0..MOST,
        value in any::<bool>(),
    ) {
        let (mut model, variables) = case.build();
        let mut solver = BranchAndBound::default();
        let first = solver.solve(&model).expect("a solvable model");
        let which = which % case.columns.len();
        let (column, variable) = (case.columns[which], variables[which]);
        let end = if value { column.upper } else { column.lower };
        model.fix(variable, if end.is_finite() { end } else { 0.0 }).expect("a value");
        let row = model.constraint_by_name("r0").ok();
        if let Some(row) = row {
            let limits = (case.lines[0].lower - 1.0, case.lines[0].upper + 1.0);
            model.set_limits(row, limits.0, limits.1).expect("wider limits");
        }
        let _ = solver.solve(&model).expect("a solvable model");
        model.set_bounds(variable, column.lower, column.upper).expect("the old bounds");
        if let Some(row) = row {
            model.set_limits(row, case.lines[0].lower, case.lines[0].upper).expect("old limits");
        }
        prop_assert_eq!(model.to_string(), case.build().0.to_string());
        assert_identical(&first, &solver.solve(&model).expect("a solvable model"))?;
    }
}

/// Everything but what is measured by clocks is the same, to the last bit.
fn assert_identical(a: &Solution, b: &Solution) -> Result<(), TestCaseError> {
    prop_assert_eq!(a.termination(), b.termination());
    prop_assert_eq!(a.objective(), b.objective());
    prop_assert_eq!(a.bound(), b.bound());
    prop_assert_eq!(a.point().map(|p| p.as_slice()), b.point().map(|p| p.as_slice()));
    prop_assert_eq!(a.statistics().without_times(), b.statistics().without_times());
    Ok(())
}

/// Terms of several hundred cancel to an optimum of 0, where the default absolute gap asks for ten
/// digits of them. Whether the gap is met or not, bound and point must be right.
#[test]
fn a_cancelled_optimum_in_a_large_unit() {
    let mut model = Model::new("cancelled");
    let x = model.continuous("x", -1.5, f64::INFINITY).unwrap();
    let y = model.continuous("y", 0.0, f64::INFINITY).unwrap();
    model.minimize(200.0 * (2.0 * y - 1.0).square() + 300.0 * x + 450.0).unwrap();
    let solution = solve(&model);
    let objective = solution.objective().expect("a point");
    assert!(solution.bound() <= 0.0 && objective.abs() <= AGREEMENT, "{solution:?}");
    assert!(solution.verification().is_some_and(Verification::holds));
    let mut in_unit = BranchAndBound::new(Options::default().with_absolute_gap(1e-5));
    assert!(in_unit.solve(&model).unwrap().is_optimal());
}
