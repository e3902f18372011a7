//! Structure is recognised in any units, with complements in place of columns, and with rows from
//! the other side.

use carom::solver::StopToken;
use carom_solver::internals::presolve::root::{Presolve, PresolveRule, presolve};
use carom_solver::internals::program::Program;
use proptest::prelude::*;
use proptest::sample::select;

use super::logical_programs::{coded, conjunctions, routes, selections};
use super::rules::compare;
use crate::common::case::Case;
use crate::common::config;
use crate::common::other_words::{complemented, in_units, negated};

const REGRESSIONS: &str = "tests/regressions/presolve.txt";

/// Most columns, and most rows, of a case.
const MOST: usize = 24;

/// Columns, integral columns and rows that rules leave; `None` if they refute the program.
fn left(case: &Case, rules: &[PresolveRule]) -> Option<[usize; 3]> {
    let program = Program::assemble(&case.build().0).unwrap();
    match presolve(&program, rules, &StopToken::default()).unwrap() {
        Presolve::Presolved(presolved) => {
            let program = &presolved.program;
            Some([program.column_count(), program.integers.len(), program.row_count()])
        }
        Presolve::Stopped => unreachable!("the default token never stops"),
        Presolve::Infeasible => None,
    }
}

fn structured() -> impl Strategy<Value = Case> {
    prop_oneof![coded(), conjunctions(), routes(), selections()]
}

/// Powers that no program takes for its own: those of columns and of rows are far apart.
fn powers() -> impl Strategy<Value = Vec<i32>> {
    prop::collection::vec(select(vec![-13, -9, -6, 6, 9, 13]), 2 * MOST)
}

proptest! {
    #![proptest_config(config(150, REGRESSIONS))]

    #[test]
    fn structure_is_recognised_in_any_units(case in structured(), powers in powers()) {
        let [first, second] =
            [&powers, &powers.iter().rev().map(|power| -power).collect::<Vec<i32>>()]
                .map(|powers| in_units(&case, &powers[..MOST], &powers[MOST..]));
        let all = &PresolveRule::ALL;
        prop_assert_eq!(left(&first, all), left(&second, all));
        compare(&first, &PresolveRule::ALL)?;
    }

    #[test]
    fn codes_are_recognised_in_any_words(
        case in coded(),
        powers in powers(),
        which in prop::collection::vec(any::<bool>(), 2 * MOST),
    ) {
        let counts = |case: &Case| left(case, &[PresolveRule::BinaryCodes]);
        let other = negated(&complemented(&case, &which[..MOST]), &which[MOST..]);
        prop_assert_eq!(counts(&other), counts(&case));
        let other = in_units(&other, &powers[..MOST], &powers[MOST..]);
        prop_assert_eq!(counts(&other), counts(&case));
    }

    #[test]
    fn structure_in_other_words_has_the_same_optimum(
        case in structured(),
        which in prop::collection::vec(any::<bool>(), 2 * MOST),
    ) {
        let other = negated(&complemented(&case, &which[..MOST]), &which[MOST..]);
        compare(&other, &PresolveRule::ALL)?;
        compare(&other, &[PresolveRule::Complements])?;
        compare(&other, &[PresolveRule::BinaryCodes])?;
    }
}

/// "Exactly one of these" over complements of some binaries becomes one over binaries, and
/// conjunctions stay.
#[test]
fn choices_are_turned_around_and_conjunctions_are_not() {
    use carom::prelude::Model;
    let rules = [PresolveRule::Complements];
    let row_of = |coefficients: &[f64], lower: f64, upper: f64| {
        let mut model = Model::new("words");
        let mut sum = carom::prelude::Affine::default();
        for (k, a) in coefficients.iter().enumerate() {
            sum += *a * model.binary(format!("b{k}")).unwrap();
        }
        model.add("row", sum.within(lower, upper)).unwrap();
        let program = Program::assemble(&model).unwrap();
        match presolve(&program, &rules, &StopToken::default()).unwrap() {
            Presolve::Presolved(presolved) => presolved.program.row(0).1.to_vec(),
            other => panic!("{other:?}"),
        }
    };
    let inf = f64::INFINITY;
    assert_eq!(row_of(&[1.0, -1.0, 1.0, -1.0], -1.0, -1.0), [1.0; 4]);
    assert_eq!(row_of(&[-1.0, -1.0, 1.0, 1.0], 1.0, 1.0), [-1.0; 4]);
    assert_eq!(row_of(&[1.0, -1.0, -1.0, 1.0, 1.0], -1.0, inf), [1.0; 5]);
    for (stays, lower) in [([1.0, -1.0, -1.0], -1.0), ([1.0, 1.0, -1.0], 0.0)] {
        assert_eq!(row_of(&stays, lower, inf), stays);
    }
}
