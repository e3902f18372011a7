//! A solver's answer to a small program beside the exact one.

use carom::prelude::{Solution, Termination};
use proptest::test_runner::TestCaseError;
use proptest::{prop_assert, prop_assert_eq};

use super::case::Case;
use super::enumeration::optimum;
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
