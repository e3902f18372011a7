//! Statuses of a solve.

use std::fmt;

/// Why a solver stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Termination {
    /// Bound and incumbent meet the requested gap. If variables have no bounds, the bound is valid
    /// for points within [`FREE_RADIUS`](crate::tolerance::FREE_RADIUS).
    Optimal,
    /// It is proved that no point satisfies the model.
    Infeasible,
    /// The objective improves without limit over feasible points.
    Unbounded,
    /// The time limit was reached.
    TimeLimit,
    /// The node limit was reached.
    NodeLimit,
    /// The memory limit of the tree was reached.
    MemoryLimit,
    /// The [`Interrupt`](crate::solver::Interrupt) was triggered.
    Interrupted,
    /// For numerical reasons, part of the search could be neither refuted nor finished. The bound,
    /// and the point if there is one, are still valid. What the nearest point violates that was
    /// refused is in [`Solution::refused`](crate::solution::Solution::refused).
    Stalled,
}

impl Termination {
    /// Whether the search stopped at a limit or an interrupt.
    pub fn is_limit(self) -> bool {
        use Termination::{Interrupted, MemoryLimit, NodeLimit, TimeLimit};
        matches!(self, TimeLimit | NodeLimit | MemoryLimit | Interrupted)
    }
}

impl fmt::Display for Termination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Termination::Optimal => "optimal",
            Termination::Infeasible => "infeasible",
            Termination::Unbounded => "unbounded",
            Termination::TimeLimit => "time limit",
            Termination::NodeLimit => "node limit",
            Termination::MemoryLimit => "memory limit",
            Termination::Interrupted => "interrupted",
            Termination::Stalled => "stalled",
        })
    }
}

/// Whether a solution holds a point, apart from why the solver stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum PrimalStatus {
    /// No point.
    None,
    /// A verified feasible point.
    Feasible,
}
