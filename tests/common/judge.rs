//! A solver's answer to a small program beside the exact one.

use carom::prelude::{Solution, Termination, VariableKind};
use proptest::test_runner::TestCaseError;
use proptest::{prop_assert, prop_assert_eq};

use super::case::Case;
use super::enumeration::{all_optima, optimum};
use super::quadratic_program::Minimum;

/// Whether a solution is solved to the end and has the optimum of the case.
pub(crate) fn is_right(case: &Case, solution: &Solution) -> Result<(), TestCaseError> {
    match optimum(case) {
        Minimum::Attained { value, .. } => {
            prop_assert!(solution.is_optimal(), "{:?}", solution);
            let found = case.sign() * solution.objective().unwrap();
            prop_assert!((found - value).abs() < 1e-5 * value.abs().max(1.0));
        }
        Minimum::Infeasible => prop_assert!(solution.is_infeasible(), "{:?}", solution),
        Minimum::Unbounded => prop_assert_eq!(solution.termination(), Termination::Unbounded),
    }
    Ok(())
}

/// Compares a pool with the best points of a program without continuous columns beyond finite
/// bounds.
///
/// # Arguments
///
/// * `is_best`: whether the best points were asked for.
pub(crate) fn is_right_pool(
    case: &Case,
    solution: &Solution,
    size: usize,
    is_best: bool,
) -> Result<(), TestCaseError> {
    let (pool, optima) = (solution.pool(), all_optima(case));
    prop_assert!(pool.is_complete() == is_best, "complete: {}", pool.is_complete());
    let wanted = size.min(optima.len());
    prop_assert!(pool.len() <= wanted && (!is_best || pool.len() == wanted), "{optima:?}");
    let mut seen: Vec<Vec<i64>> = Vec::new();
    for (k, found) in pool.iter().enumerate() {
        let values = found.point().as_slice().iter().zip(&case.columns);
        let integral = values.filter(|(_, column)| column.kind != VariableKind::Continuous);
        let integers: Vec<i64> = integral.map(|(value, _)| value.round() as i64).collect();
        let own = optima.iter().find(|(other, _)| *other == integers).map(|(_, value)| *value);
        let cost = case.sign() * found.objective();
        let near = |value: f64| (cost - value).abs() <= 1e-5 * value.abs().max(1.0);
        prop_assert!(own.is_some_and(|value| !is_best || near(value)), "{integers:?}: {cost}");
        prop_assert!(!is_best || near(optima[k].1), "{cost}, not {}", optima[k].1);
        prop_assert!(!seen.contains(&integers), "{integers:?} twice");
        seen.push(integers);
    }
    Ok(())
}
