//! The relaxed point of a root, and its value, for what strengthens a program before the search.

use crate::presolve::{Domain, Reduction, reduce};
use crate::program::Program;
use crate::relaxation::{Claim, Ladder, Purpose};
use crate::solver::StopToken;

/// The relaxed point of a program, and its value.
#[derive(Debug, Clone)]
pub(crate) struct RootPoint {
    pub(super) value: f64,
    pub(super) x: Vec<f64>,
}

impl RootPoint {
    /// Relaxes a program within a domain; `None` if nothing is left to relax, or without an optimum.
    pub(super) fn new(
        program: &Program,
        domain: &Domain,
        ladder: &mut Ladder,
        token: &StopToken,
    ) -> Option<RootPoint> {
        let Reduction::Reduced(reduced) = reduce(program, domain) else { return None };
        if reduced.columns.is_empty() {
            return None;
        }
        ladder.solve_until(&reduced, Purpose::Separation, token, |answer| {
            let solved = answer.claim == Claim::Solved && answer.x.iter().all(|v| v.is_finite());
            let value = reduced.objective(&answer.x);
            solved.then(|| RootPoint { value, x: reduced.lift(&answer.x) })
        })
    }

    /// Whether another value is higher by at least a part of this one.
    pub(super) fn is_lifted_by(&self, part: f64, value: f64) -> bool {
        value - self.value >= part * self.value.abs().max(1e-6)
    }
}
