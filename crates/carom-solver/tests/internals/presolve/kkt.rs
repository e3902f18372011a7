//! The conditions of Karush, Kuhn and Tucker hold for restored pairs as they do for presolved ones.
//!
//! The integers of a presolved optimum are fixed and the continuous program that is left is solved;
//! the pair of point and multipliers that comes out is restored, and its residuals on the original
//! program are computed here from the matrices alone.

use carom::prelude::*;
use carom::solver::StopToken;
use carom_solver::internals::presolve::Reduced;
use carom_solver::internals::presolve::root::{Presolve, PresolveRule, Presolved, presolve};
use carom_solver::internals::program::Program;
use carom_solver::internals::relaxation::{
    ClarabelRelaxation, Effort, Relaxation, RelaxationClaim,
};
use proptest::prelude::*;

use super::logical_programs::{coded, conjunctions, routes};
use super::programs::program;
use super::search_alone;
use crate::common::case::Case;
use crate::common::config;

const REGRESSIONS: &str = "tests/regressions/presolve.txt";

/// The largest residual: of rows, bounds, reduced costs, and signs.
fn residual(program: &Program, x: &[f64], y: &[f64], d: &[f64]) -> f64 {
    let mut worst = 0.0_f64;
    // What presses must press on something: the multiplier or the distance is small.
    let mut pressed = |multiplier: f64, room_above: f64, room_below: f64| {
        worst = worst.max(-room_above).max(-room_below);
        let room = if multiplier > 0.0 { room_above } else { room_below };
        worst = worst.max(multiplier.abs().min(room.abs()));
    };
    for (i, &multiplier) in y.iter().enumerate() {
        let (columns, values) = program.row(i);
        let activity: f64 = columns.iter().zip(values).map(|(&j, a)| a * x[j]).sum();
        pressed(multiplier, program.row_upper[i] - activity, activity - program.row_lower[i]);
    }
    for j in (0..x.len()).filter(|&j| !program.integral[j]) {
        pressed(-d[j], program.upper[j] - x[j], x[j] - program.lower[j]);
    }
    for (j, &reduced_cost) in d.iter().enumerate() {
        let (rows, products) = program.quadratic_column(j);
        let mut gradient = program.linear[j];
        gradient += rows.iter().zip(products).map(|(&i, p)| p * x[i]).sum::<f64>();
        let (rows, values) = program.column(j);
        gradient += rows.iter().zip(values).map(|(&i, a)| a * y[i]).sum::<f64>();
        worst = worst.max((gradient - reduced_cost).abs());
    }
    worst
}

/// Point and multipliers of a program with its integers fixed at those of a point.
fn continuous_pair(program: &Program, at: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
    let open: Vec<usize> = (0..at.len()).filter(|&j| !program.integral[j]).collect();
    let mut position = vec![usize::MAX; at.len()];
    open.iter().enumerate().for_each(|(k, &j)| position[j] = k);
    let pick = |from: &[f64]| -> Vec<f64> { open.iter().map(|&j| from[j]).collect() };
    let mut left = Reduced {
        linear: pick(&program.linear),
        lower: pick(&program.lower),
        upper: pick(&program.upper),
        columns: open.clone(),
        ..Reduced::default()
    };
    (left.rows.start, left.quadratic.start) = (vec![0], vec![0]);
    for (k, &j) in open.iter().enumerate() {
        let (rows, products) = program.quadratic_column(j);
        for (&i, &p) in rows.iter().zip(products) {
            if program.integral[i] {
                left.linear[k] += p * at[i];
            } else if i <= j {
                left.quadratic.index.push(position[i]);
                left.quadratic.value.push(p);
            }
        }
        left.quadratic.start.push(left.quadratic.index.len());
    }
    let mut kept = Vec::new();
    for i in 0..program.row_count() {
        let (columns, values) = program.row(i);
        let mut constant = 0.0;
        for (&j, &a) in columns.iter().zip(values) {
            if program.integral[j] {
                constant += a * at[j];
            } else {
                left.rows.index.push(position[j]);
                left.rows.value.push(a);
            }
        }
        if columns.iter().any(|&j| !program.integral[j]) {
            left.rows.start.push(left.rows.index.len());
            left.row_lower.push(program.row_lower[i] - constant);
            left.row_upper.push(program.row_upper[i] - constant);
            kept.push(i);
        }
    }
    let mut y = vec![0.0; program.row_count()];
    let mut x = at.to_vec();
    if open.is_empty() {
        return Some((x, y));
    }
    let effort = Effort {
        iterations: 200,
        tolerance: 1e-11,
        refinements: 10,
        cutoff: f64::INFINITY,
        token: &StopToken::default(),
        warm: None,
    };
    let answer = ClarabelRelaxation::new().solve(&left, &effort);
    if answer.claim != RelaxationClaim::Solved {
        return None;
    }
    open.iter().zip(&answer.x).for_each(|(&j, &v)| x[j] = v);
    kept.iter().zip(&answer.y).for_each(|(&i, &v)| y[i] = v);
    Some((x, y))
}

/// Residuals of a presolved pair and of the restored one; nothing without an optimum.
fn residuals(case: &Case, rules: &[PresolveRule]) -> Option<(f64, f64)> {
    let (model, _) = case.build();
    let program = Program::assemble(&model).unwrap();
    let Presolve::Presolved(presolved) = presolve(&program, rules, &StopToken::default()).unwrap()
    else {
        return None;
    };
    let Presolved { program: small, .. } = &*presolved;
    let found = search_alone(small, &|_: &[f64]| true);
    if found.termination != Termination::Optimal {
        return None;
    }
    let (x, y) = continuous_pair(small, found.points.first()?)?;
    let restored = presolved.restore(&x, &y).unwrap();
    // Without rules, restoring only computes the reduced costs.
    let Presolve::Presolved(same) = presolve(small, &[], &StopToken::default()).unwrap() else {
        return None;
    };
    let own = same.restore(&x, &y).unwrap();
    let before = residual(small, &x, &y, &own.d);
    Some((before, residual(&program, &restored.x, &restored.y, &restored.d)))
}

fn check(case: &Case, rules: &[PresolveRule]) -> Result<(), TestCaseError> {
    const TOLERANCE: f64 = 1e-6;
    // These restore multipliers of continuous programs only; nobody asks for others.
    let mut rules = rules.to_vec();
    let whole = case.columns.iter().any(|column| column.kind != VariableKind::Continuous);
    let without = [PresolveRule::ImpliedBinaries, PresolveRule::HeldColumns];
    rules.retain(|rule| !whole || !without.contains(rule));
    if let Some((before, after)) = residuals(case, &rules) {
        prop_assume!(before <= 0.01 * TOLERANCE);
        prop_assert!(after <= TOLERANCE, "{} instead of {}", after, before);
    }
    Ok(())
}

proptest! {
    #![proptest_config(config(300, REGRESSIONS))]

    #[test]
    fn each_rule(case in program(true), rule in 0..PresolveRule::ALL.len()) {
        check(&case, &[PresolveRule::ALL[rule]])?;
        check(&case, &[PresolveRule::SingletonRows, PresolveRule::ALL[rule]])?;
    }

    #[test]
    fn held_columns_of_continuous_programs(mut case in conjunctions(), all in any::<bool>()) {
        case.columns.iter_mut().for_each(|column| column.kind = VariableKind::Continuous);
        let some = [PresolveRule::HeldColumns, PresolveRule::Doubletons];
        check(&case, if all { &PresolveRule::ALL } else { &some })?;
    }

    #[test]
    fn binary_codes(case in coded()) {
        check(&case, &[PresolveRule::BinaryCodes])?;
        check(&case, &PresolveRule::ALL)?;
    }

    #[test]
    fn exclusive_rows(case in routes()) {
        check(&case, &[PresolveRule::ExclusiveRows])?;
        check(&case, &PresolveRule::ALL)?;
    }

    #[test]
    fn all_rules_on_linear_programs(case in program(false)) {
        check(&case, &PresolveRule::ALL)?;
    }

    #[test]
    fn all_rules_on_curved_programs(case in program(true)) {
        check(&case, &PresolveRule::ALL)?;
    }

    #[test]
    fn all_rules_on_continuous_programs(mut case in program(true)) {
        case.columns.iter_mut().for_each(|column| column.kind = VariableKind::Continuous);
        check(&case, &PresolveRule::ALL)?;
    }
}

#[test]
fn wrong_lengths_are_refused() {
    let mut model = Model::new("m");
    model.continuous("x", 0.0, 1.0).unwrap();
    let program = Program::assemble(&model).unwrap();
    let Presolve::Presolved(presolved) = presolve(&program, &[], &StopToken::default()).unwrap()
    else {
        panic!("nothing contradicts")
    };
    assert!(presolved.restore(&[0.0], &[]).is_ok());
    assert!(presolved.restore(&[], &[]).is_err());
    assert!(presolved.restore(&[0.0], &[1.0]).is_err());
}
