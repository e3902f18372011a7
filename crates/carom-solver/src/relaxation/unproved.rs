//! Points of programs that no bound is asked of, such as the steps of a local search.

use super::active_set::ActiveSet;
use super::attempts::{MethodAttempt, Purpose, Stage};
use super::method_cascade::{MethodCascade, Request, WarmMethod};
use super::simplex::DualSimplex;
use super::warm_state::WarmState;
use super::{RelaxationClaim, RelaxationResult};
use crate::presolve::Reduced;
use crate::solver::StopToken;

/// The method that starts warm.
const QUICK: MethodAttempt =
    MethodAttempt { stage: Stage::Warm, iterations: 2000, tolerance: 1e-12, refinements: 1 };

/// The method that starts from nothing.
const THOROUGH: MethodAttempt =
    MethodAttempt { stage: Stage::Cold, iterations: 60, tolerance: 1e-10, refinements: 1 };

impl MethodCascade {
    /// A solution of a program without cones that a method claims, with its multipliers: from the
    /// state of another solve, then without it, and last by the method for all programs. `None` if
    /// none of them ends, or if there is none.
    pub(crate) fn solve_unproved(
        &mut self,
        program: &Reduced,
        warm: Option<&WarmState>,
        token: &StopToken,
    ) -> Option<RelaxationResult> {
        let warm_method = match (ActiveSet::suits(program), DualSimplex::suits(program)) {
            (true, _) => Some(WarmMethod::ActiveSet),
            (false, true) => Some(WarmMethod::Simplex),
            (false, false) => None,
        };
        let mut request = Request::complete(Purpose::Leaf, token);
        if warm_method.is_some() && self.has_warm_methods() {
            request.warm_method = warm_method;
            for state in [warm, None] {
                request.warm = state;
                let result = self.solve_by(QUICK, program, &request);
                if result.claim == RelaxationClaim::Solved {
                    return Some(result);
                }
                if state.is_none() {
                    break;
                }
            }
            (request.warm_method, request.warm) = (None, None);
        }
        let result = self.solve_by(THOROUGH, program, &request);
        (result.claim == RelaxationClaim::Solved).then_some(result)
    }
}
