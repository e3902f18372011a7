//! Events of a search while it runs.

use super::outcome::{HorizonAttempt, HorizonProof};
use crate::solver::Progress;

/// A progress event of a search.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[expect(
    clippy::large_enum_variant,
    reason = "there are few events, and each lives as long as a callback"
)]
pub enum HorizonEvent {
    /// A horizon is about to be solved.
    Started {
        /// The horizon, in steps.
        steps: usize,
        /// The largest horizon refuted so far together with every smaller one; 0 if there is none.
        refuted: usize,
        /// The smallest horizon found feasible so far.
        feasible: Option<usize>,
    },
    /// Progress of the current solve.
    Solving {
        /// The horizon, in steps.
        steps: usize,
        /// The solver's progress.
        progress: Progress,
    },
    /// A horizon is decided, by reach sets or by a solve.
    Decided(HorizonAttempt),
    /// The log of a horizon is written, or it is known that there is none.
    Logged(HorizonProof),
}
