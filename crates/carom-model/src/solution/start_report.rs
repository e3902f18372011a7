//! The report on a MIP start.

use crate::model::Variable;

/// The report on a [`MipStart`](crate::solver::MipStart) after a solve.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StartReport {
    /// The outcome; `None` if the start has no values or the solver did not try it.
    pub status: Option<StartStatus>,
    /// Number of values that were ignored because they name a variable of another model or a
    /// continuous one, or are not finite.
    pub ignored: usize,
}

/// The outcome of a MIP start.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum StartStatus {
    /// The solver found a verified point with all values of the start.
    Accepted,
    /// The solver found a verified point, but these variables had to change.
    Repaired {
        /// The variables.
        changed: Vec<Variable>,
    },
    /// The solver found no point from the start.
    Rejected {
        /// Why, in words.
        reason: String,
    },
}
