//! The disagreement of a plan and its replay.

use thiserror::Error;

/// A plan that does not agree with its own replay.
///
/// In a [`carom::Error`](crate::Error) it is the [`source`](std::error::Error::source) of an error
/// of the kind [`ErrorKind::Other`](crate::ErrorKind::Other).
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ReplayError {
    /// Plan and replay disagree about a contact, or the replay has no successor for a step.
    #[error(
        "the plan is not certified: its replay disagrees about contact in step {step}; tighten the \
         solver's feasibility tolerance"
    )]
    Contact {
        /// The step.
        step: usize,
    },
    /// A sample of the plan is too far from its replay.
    #[error(
        "the plan is not certified: its {what} at step {step} is off by {residual:.3e} from the \
         replay, more than {allowed:.0e}; tighten the solver's feasibility tolerance"
    )]
    Sample {
        /// `position` or `velocity`.
        what: &'static str,
        /// The step.
        step: usize,
        /// The disagreement, in m or m/s.
        residual: f64,
        /// The largest allowed disagreement, in the same unit.
        allowed: f64,
    },
}

impl From<ReplayError> for crate::Error {
    fn from(error: ReplayError) -> Self {
        crate::Error::other(error)
    }
}
