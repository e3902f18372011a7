//! Dense quadratic objectives over columns with two values and a few others: the answer is that of
//! enumeration, whatever is asked for, and however it is searched.

use std::fs;
use std::path::PathBuf;

use carom::model::{Affine, Quadratic};
use carom::prelude::*;
use carom::solution::Point;
use carom::solver::{MipStart, PoolMode};
use carom_proof::{Claim, check};
use proptest::prelude::*;

use crate::common::case::{Case, Column, Line};
use crate::common::config;
use crate::common::enumeration::all_optima;
use crate::common::generate::unusual_options;
use crate::common::judge::{is_right, is_right_pool};
use crate::common::quadratic_program::{Minimum, QuadraticProgram};
use crate::torture::families::Family;
use crate::torture::generator::Random;

fn is_integral(column: &Column) -> bool {
    column.kind != VariableKind::Continuous
}

/// Values of the integers, each within its bounds.
fn start(case: &Case, variables: &[Variable], bits: u32) -> MipStart {
    let integers = case.columns.iter().zip(variables).filter(|(column, _)| is_integral(column));
    MipStart::new().with_values(integers.enumerate().map(|(k, (column, &variable))| {
        (variable, if bits >> (k % 32) & 1 == 1 { column.upper } else { column.lower })
    }))
}

fn misses(line: &Line, point: &Point) -> bool {
    line.excess(point.as_slice(), 1e-6) > 0.0
}

proptest! {
    #![proptest_config(config(200, "tests/regressions/dense_quadratics.txt"))]

    /// Pools have the best points, rows may come late, starts may be anything, and the ends of a
    /// tree have all assignments.
    #[test]
    fn no_way_of_searching_loses_a_point(
        seed in any::<u64>(),
        options in unusual_options(),
        bits in any::<u32>(),
        (is_started, is_late, is_prepared) in any::<(bool, bool, bool)>(),
    ) {
        let case = Family::Dense.program(seed);
        let mut known = case.clone();
        let late = if is_late { known.lines.split_off(known.lines.len() / 2) } else { Vec::new() };
        let (model, variables) = known.build();
        let source = |point: &Point| {
            let missed = late.iter().filter(|line| misses(line, point));
            Ok(missed.map(|line| line.row(&variables)).collect())
        };
        let given = start(&case, &variables, bits);
        let mut control = Control::default();
        if is_late {
            control = control.with_lazy_constraints(&source);
        }
        if is_started {
            control = control.with_start(&given);
        }
        let mut solver = BranchAndBound::new(options.clone());
        let solution = match is_prepared && !is_late && options.pool == 1 {
            true => solver.prepare(&model)?.solve(&[], &mut control)?,
            false => solver.solve_with(&model, &mut control)?,
        };
        is_right(&case, &solution)?;
        prop_assert_eq!(solution.statistics().contradictions, 0);
        let optima = all_optima(&case);
        if options.pool > 1 && solution.is_optimal() {
            is_right_pool(&case, &solution, options.pool, options.pool_mode == PoolMode::Best)?;
        }
        let is_cut_short = is_late || options.pool > 1 || solution.leaves().is_empty();
        for (assignment, value) in optima.iter().filter(|_| !is_cut_short) {
            let integers = variables.iter().zip(&case.columns).filter(|(_, c)| is_integral(c));
            let at: Vec<(Variable, f64)> =
                integers.zip(assignment).map(|((&v, _), &value)| (v, value as f64)).collect();
            let around = solution.leaves().iter().filter(|leaf| {
                leaf.bounds.iter().all(|b| {
                    at.iter().all(|(v, x)| *v != b.variable || (b.lower <= *x && *x <= b.upper))
                })
            });
            let bounds: Vec<f64> = around.map(|leaf| case.sign() * leaf.bound).collect();
            prop_assert_eq!(bounds.len(), 1, "{:?}", at);
            // The bound of an end holds for its points, up to the cutoff.
            let least = bounds[0].min(optima[0].1);
            prop_assert!(least <= value + 1e-5 * value.abs().max(1.0), "{at:?}: {least}, {value}");
        }
    }

    /// A log is complete, or says that it is not; a complete one proves the optimum.
    #[test]
    fn proofs_are_of_the_optimum(seed in any::<u64>()) {
        let case = Family::Dense.program(seed);
        let (model, _) = case.build();
        let name = format!("dense_quadratics_{}.proof", seed % 8);
        let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
        let solution = BranchAndBound::new(Options::default().with_proof(&path)).solve(&model)?;
        is_right(&case, &solution)?;
        let log = fs::read(&path).expect("a log");
        let checked = check(&log[..]);
        let is_complete = solution.proof().expect("a report").is_complete;
        prop_assert_eq!(is_complete, checked.is_ok(), "{:?}\n{}", checked, model);
        let best = all_optima(&case).first().map(|best| best.1);
        match (checked.map(|proved| proved.claim), best) {
            (Ok(Claim::Bound(bound)), Some(best)) => {
                prop_assert!((bound - best).abs() <= 1e-4 * best.abs().max(1.0), "{bound}, {best}");
            }
            (Ok(claim), Some(best)) => prop_assert!(false, "{claim:?}, not {best}"),
            (Ok(Claim::Bound(bound)), None) => prop_assert!(false, "{bound} of no point"),
            _ => {}
        }
    }

    /// Sums of few squares, rounded to six digits: nearly convex, or accepted as not convex over
    /// columns with two values.
    #[test]
    fn rounded_squares_have_the_optimum_of_enumeration(
        seed in any::<u64>(),
        (n, m) in (6_usize..12, 0_usize..4),
        maximize in any::<bool>(),
    ) {
        rounded(seed, n, m, maximize)?;
    }
}

/// As `rounded_squares_have_the_optimum_of_enumeration`, with `n` columns of two values and `m`
/// continuous ones.
fn rounded(seed: u64, n: usize, m: usize, maximize: bool) -> Result<(), TestCaseError> {
    let r = &mut Random::new(seed);
    let digit = |r: &mut Random| 1e-3 * f64::from(r.within(-1000, 1000));
    let mut model = Model::new("rounded");
    let (mut lower, mut columns) = (Vec::new(), Vec::new());
    for k in 0..n + m {
        lower.push(if r.chance(0.6) { 0.0 } else { f64::from(r.within(-3, 3)) });
        let (least, most) = (lower[k], lower[k] + 1.0);
        columns.push(match k < n {
            true => model.integer(format!("n{k}"), least, most)?,
            false => model.continuous(format!("x{k}"), least, most)?,
        });
    }
    // The matrix of the form and the linear costs.
    let (all, mut matrix) = (n + m, vec![vec![0.0; n + m]; n + m]);
    for _ in 0..1 + r.below(3) {
        let row: Vec<f64> = (0..all).map(|_| digit(r)).collect();
        (0..all).for_each(|i| (0..all).for_each(|j| matrix[i][j] += row[i] * row[j]));
    }
    matrix.iter_mut().flatten().for_each(|q| *q = (*q * 1e6).round() / 1e6);
    let linear: Vec<f64> = (0..all).map(|_| 0.5 * digit(r)).collect();
    let sign = if maximize { -1.0 } else { 1.0 };
    let mut objective = Quadratic::from(2.0);
    for i in 0..all {
        objective += sign * linear[i] * columns[i];
        (0..all).for_each(|j| objective.add_product(sign * matrix[i][j], columns[i], columns[j]));
    }
    let count = r.chance(0.5).then(|| lower[..n].iter().sum::<f64>() + r.below(n + 1) as f64);
    if let Some(count) = count {
        let sum = columns[..n].iter().fold(Affine::zero(), |sum, &v| sum + v);
        model.add("count", sum.equals(count))?;
    }
    model.set_objective(if maximize { Sense::Maximize } else { Sense::Minimize }, objective)?;
    let solution = match BranchAndBound::default().solve(&model) {
        Ok(solution) => solution,
        // Digits that are missing in continuous columns may be more than the gap.
        Err(error) => {
            prop_assert!(m > 0, "{error}");
            return Ok(());
        }
    };
    let mut best = f64::INFINITY;
    for bits in 0..1_u32 << n {
        let at = |k: usize| lower[k] + f64::from(bits >> k & 1);
        if count.is_some_and(|count| (0..n).map(at).sum::<f64>() != count) {
            continue;
        }
        let mut rest = QuadraticProgram::new(m);
        let mut value = 2.0;
        for i in 0..n {
            value += linear[i] * at(i) + (0..n).map(|j| matrix[i][j] * at(i) * at(j)).sum::<f64>();
        }
        for k in 0..m {
            let mixed: f64 = (0..n).map(|i| 2.0 * matrix[i][n + k] * at(i)).sum();
            rest.linear[k] = linear[n + k] + mixed;
            for l in 0..m {
                rest.curvature[k][l] = 2.0 * matrix[n + k][n + l];
            }
            let unit: Vec<f64> = (0..m).map(|l| f64::from(u8::from(l == k))).collect();
            rest.add_range(&unit, lower[n + k], lower[n + k] + 1.0);
        }
        match rest.solve() {
            Minimum::Attained { value: more, .. } => best = best.min(value + more),
            other => prop_assert!(false, "{other:?}"),
        }
    }
    prop_assert!(solution.is_optimal(), "{}\n{model}", solution.termination());
    let found = sign * (solution.objective().unwrap_or(f64::NAN) - 2.0) + 2.0;
    prop_assert!(
        (found - best).abs() <= 2e-5 * best.abs().max(1.0),
        "{found}, not {best}\n{model}"
    );
    Ok(())
}
