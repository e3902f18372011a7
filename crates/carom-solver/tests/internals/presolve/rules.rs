//! Each rule alone, and all of them: the optimum by enumeration, and its point by the way back.

use carom::prelude::*;
use carom::solver::StopToken;
use carom_solver::internals::presolve::root::{Presolve, PresolveRule, presolve};
use carom_solver::internals::program::Program;
use proptest::prelude::*;

use super::logical_programs::{coded, conjunctions, routes, selections};
use super::programs::program;
use super::search_alone;
use crate::common::case::Case;
use crate::common::config;
use crate::common::enumeration::optimum;
use crate::common::quadratic_program::Minimum;

const REGRESSIONS: &str = "tests/regressions/presolve.txt";

/// The optimum of a case when presolved by some rules, searched, and restored.
pub(super) fn compare(case: &Case, rules: &[PresolveRule]) -> Result<(), TestCaseError> {
    let (model, _) = case.build();
    let program = Program::assemble(&model).unwrap();
    let expected = optimum(case);
    let presolved = match presolve(&program, rules, &StopToken::default()).unwrap() {
        Presolve::Presolved(presolved) => presolved,
        Presolve::Stopped => unreachable!("the default token never stops"),
        Presolve::Infeasible => {
            prop_assert_eq!(&expected, &Minimum::Infeasible);
            return Ok(());
        }
    };
    let accept = |x: &[f64]| case.violation(&presolved.postsolve.point(x), 1e-6).is_none();
    let found = search_alone(&presolved.program, &accept);
    match expected {
        Minimum::Infeasible => {
            // With free columns the search may be unable to prove it, and says so.
            let open = found.termination == Termination::Stalled && found.points.is_empty();
            prop_assert!(open || found.termination == Termination::Infeasible);
        }
        Minimum::Unbounded => prop_assert_eq!(found.termination, Termination::Unbounded),
        Minimum::Attained { value, .. } => {
            prop_assert_eq!(found.termination, Termination::Optimal);
            let x = found.points.first().expect("a point").clone();
            let tolerance = 1e-5 * value.abs().max(1.0);
            let restored = presolved.postsolve.point(&x);
            let here = presolved.program.objective(&x);
            prop_assert!((here - value).abs() <= tolerance, "{here} instead of {value}");
            prop_assert!((here - case.cost(&restored)).abs() <= tolerance);
            prop_assert!(found.bound <= value + tolerance);
        }
    }
    Ok(())
}

/// Moves the columns that are in no square far away; the costs stay what they are.
fn far(case: &mut Case, moves: &[i8], digits: i32) {
    for (j, &by) in moves.iter().enumerate() {
        let is_square = case.squares.iter().any(|square| square.coefficients[j] != 0.0);
        if case.columns[j].kind == VariableKind::Binary || is_square {
            continue;
        }
        let by = f64::from(by) * 10.0_f64.powi(digits);
        case.columns[j].lower += by;
        case.columns[j].upper += by;
        for line in &mut case.lines {
            line.lower += line.coefficients[j] * by;
            line.upper += line.coefficients[j] * by;
        }
        case.constant -= case.linear[j] * by;
    }
}

proptest! {
    #![proptest_config(config(100, REGRESSIONS))]

    #[test]
    fn far_columns(mut case in program(true), moves in prop::collection::vec(-9i8..=9, 7), digits in 4i32..7) {
        far(&mut case, &moves, digits);
        compare(&case, &[PresolveRule::FarColumns])?;
        compare(&case, &PresolveRule::ALL)?;
    }

    #[test]
    fn fixed_columns(case in program(true)) {
        compare(&case, &[PresolveRule::SingletonRows, PresolveRule::FixedColumns])?;
    }

    #[test]
    fn singleton_rows(case in program(true)) {
        compare(&case, &[PresolveRule::SingletonRows])?;
    }

    #[test]
    fn redundant_rows(case in program(true)) {
        compare(&case, &[PresolveRule::RedundantRows])?;
    }

    #[test]
    fn parallel_rows(case in program(true)) {
        compare(&case, &[PresolveRule::ParallelRows])?;
    }

    #[test]
    fn doubletons(case in program(true)) {
        compare(&case, &[PresolveRule::Doubletons])?;
        compare(&case, &[PresolveRule::Doubletons, PresolveRule::SingletonRows])?;
    }

    #[test]
    fn slack_columns(case in program(false)) {
        compare(&case, &[PresolveRule::SlackColumns])?;
    }

    #[test]
    fn implied_free(case in program(false)) {
        compare(&case, &[PresolveRule::ImpliedFree])?;
    }

    #[test]
    fn dominated_columns(case in program(false)) {
        compare(&case, &[PresolveRule::DominatedColumns])?;
    }

    #[test]
    fn parallel_columns(case in program(false)) {
        compare(&case, &[PresolveRule::ParallelColumns])?;
    }

    #[test]
    fn coefficients(case in program(true)) {
        compare(&case, &[PresolveRule::Coefficients])?;
    }

    #[test]
    fn exclusive_rows(case in routes()) {
        compare(&case, &[PresolveRule::ExclusiveRows])?;
        compare(&case, &PresolveRule::ALL)?;
    }

    #[test]
    fn open_integers(case in program(true)) {
        compare(&case, &[PresolveRule::OpenIntegers])?;
    }

    #[test]
    fn dominated_columns_with_curvature(case in program(true)) {
        compare(&case, &[PresolveRule::DominatedColumns])?;
    }

    #[test]
    fn lineality(case in program(true)) {
        compare(&case, &[PresolveRule::Lineality])?;
    }

    #[test]
    fn binary_codes(case in coded()) {
        compare(&case, &[PresolveRule::BinaryCodes])?;
        compare(&case, &PresolveRule::ALL)?;
    }

    #[test]
    fn implied_binaries(case in conjunctions(), other in program(false)) {
        compare(&case, &[PresolveRule::ImpliedBinaries])?;
        compare(&other, &[PresolveRule::ImpliedBinaries])?;
    }

    #[test]
    fn selections_of_one(case in selections()) {
        compare(&case, &PresolveRule::ALL)?;
    }

    #[test]
    fn held_columns(case in conjunctions(), other in program(false)) {
        compare(&case, &[PresolveRule::HeldColumns])?;
        compare(&case, &[PresolveRule::ImpliedBinaries, PresolveRule::HeldColumns, PresolveRule::Doubletons])?;
        compare(&case, &PresolveRule::ALL)?;
        compare(&other, &[PresolveRule::HeldColumns])?;
    }

    #[test]
    fn all_rules_on_linear_programs(case in program(false)) {
        compare(&case, &PresolveRule::ALL)?;
    }

    #[test]
    fn all_rules_on_curved_programs(case in program(true)) {
        compare(&case, &PresolveRule::ALL)?;
    }
}

/// What stands far out, between bounds or by its rows, is a program of small numbers.
#[test]
fn far_columns_are_measured_from_their_bounds() {
    let mut model = Model::new("far");
    let x = model.continuous("x", 6e8, 6e8 + 6.0).unwrap();
    let k = model.integer("k", -7e7 - 2.0, -7e7).unwrap();
    let free = model.continuous("free", f64::NEG_INFINITY, f64::INFINITY).unwrap();
    model.add("between", (free - x).ge(-3.5)).unwrap();
    model.add("below", (free + k).le(6e8 - 7e7 + 1.0)).unwrap();
    model.minimize(free + 2.0 * x - k).unwrap();
    let program = Program::assemble(&model).unwrap();
    let rules = [PresolveRule::FarColumns];
    let Presolve::Presolved(presolved) = presolve(&program, &rules, &StopToken::default()).unwrap()
    else {
        panic!("nothing contradicts")
    };
    let small = &presolved.program;
    let limits = small.row_lower.iter().chain(&small.row_upper).filter(|limit| limit.is_finite());
    assert!(limits.chain(&small.lower[..2]).all(|number| number.abs() < 100.0));
    assert_eq!((small.lower[2], small.upper[2]), (f64::NEG_INFINITY, f64::INFINITY));
    let point = presolved.postsolve.point(&[2.0, 0.0, 1.5]);
    assert_eq!(program.objective(&point), small.objective(&[2.0, 0.0, 1.5]));
    assert_eq!(point[0], 6e8 + 2.0);
}

#[test]
fn a_chain_of_equalities_is_solved() {
    let mut model = Model::new("chain");
    let v = model.continuous_family("v", 3, -10.0, 10.0).unwrap();
    model.add("start", v[0].equals(1.0)).unwrap();
    model.add("a", (v[1] - 2.0 * v[0]).equals(0.0)).unwrap();
    model.add("b", (v[2] - 2.0 * v[1]).equals(0.0)).unwrap();
    let program = Program::assemble(&model).unwrap();
    let presolved = match presolve(&program, &PresolveRule::ALL, &StopToken::default()).unwrap() {
        Presolve::Presolved(presolved) => presolved,
        other => panic!("{other:?}"),
    };
    assert_eq!(presolved.program.column_count(), 0);
    assert_eq!(presolved.postsolve.point(&[]), [1.0, 2.0, 4.0]);
}

/// A conjunction without a bound of its own, `x <= z_1` and `x <= z_2`, is what its two binaries
/// are.
#[test]
fn conjunctions_without_a_bound_leave_one_binary() {
    let mut model = Model::new("conjunction");
    let y = model.continuous("y", 0.0, 10.0).unwrap();
    let z = model.binary_family("z", 4).unwrap();
    let x = model.continuous_family("x", 2, 0.0, f64::INFINITY).unwrap();
    for k in 0..4 {
        model.add(format!("holds_{k}"), (y + 20.0 * z[k]).le(22.0 + k as f64)).unwrap();
        model.add(format!("part_{k}"), x[k / 2].le(z[k])).unwrap();
    }
    model.add("either", (x[0] + x[1]).ge(1.0)).unwrap();
    model.maximize(y).unwrap();
    let program = Program::assemble(&model).unwrap();
    let rules =
        [PresolveRule::ImpliedBinaries, PresolveRule::HeldColumns, PresolveRule::Doubletons];
    let presolved = match presolve(&program, &rules, &StopToken::default()).unwrap() {
        Presolve::Presolved(presolved) => presolved,
        other => panic!("{other:?}"),
    };
    assert_eq!(presolved.program.integers.len(), 2);
    assert_eq!(presolved.program.column_count(), 3);
}

/// One of eight, told by three binaries.
#[test]
fn codes_leave_the_columns_that_they_told() {
    let mut model = Model::new("codes");
    let z = model.continuous_family("z", 8, 0.0, 1.0).unwrap();
    let mut all = Affine::default();
    z.iter().for_each(|z| all += z);
    model.add("one", all.equals(1.0)).unwrap();
    for bit in 0..3 {
        let b = model.binary(format!("b{bit}")).unwrap();
        let (mut inside, mut outside) = (Affine::default(), Affine::default());
        for (code, z) in z.iter().enumerate() {
            if code >> bit & 1 == 1 { inside += z } else { outside += z }
        }
        model.add(format!("inside{bit}"), (inside - b).le(0.0)).unwrap();
        model.add(format!("outside{bit}"), (outside + b).le(1.0)).unwrap();
    }
    let program = Program::assemble(&model).unwrap();
    let Presolve::Presolved(presolved) =
        presolve(&program, &[PresolveRule::BinaryCodes], &StopToken::default()).unwrap()
    else {
        panic!("nothing contradicts")
    };
    assert_eq!(presolved.program.row_count(), 1);
    assert_eq!(presolved.program.integers, (0..8).collect::<Vec<_>>());
    let five = presolved.postsolve.point(&[0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    assert_eq!(five[8..], [1.0, 0.0, 1.0]);
}
