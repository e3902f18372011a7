//! Continuous relaxations: solve, and prove what was solved.
//!
//! The trait [`Relaxation`] is all the search knows of an interior-point or simplex code.
//! [`InteriorPoint`] is quick on the small sparse programs of a tree and gives up early;
//! [`ClarabelRelaxation`] settles the rest, and is the only one that names a library. Whatever a backend claims is
//! checked here: [`lower_bound`] recomputes a rigorous bound from the multipliers, and the
//! infeasibility of a node is believed only when the same computation proves it.

mod bound;
mod clarabel;
mod correction;
mod extended;
mod interior;
mod ladder;
mod polish;
mod recession;
mod warm_state;

pub use bound::{lower_bound, proves_infeasible, reduced_costs};
pub use clarabel::ClarabelRelaxation;
pub use interior::InteriorPoint;
pub use ladder::Ladder;
pub(crate) use ladder::{Purpose, Question, Verdict};
pub use polish::polish;
pub(crate) use polish::polish_leaf;
pub use warm_state::WarmState;

use crate::presolve::Reduced;
use crate::solver::StopToken;

/// How hard to try, when to stop, and what to start from.
#[derive(Debug, Clone, Copy)]
pub struct Effort<'a> {
    /// Largest number of iterations.
    pub iterations: u32,
    /// Tolerance on gap and residuals, relative.
    pub tolerance: f64,
    /// Steps of iterative refinement in each linear solve.
    pub refinements: u32,
    /// The solve may end as soon as its dual objective promises a bound of at least this; infinite
    /// for a solve to the end.
    pub cutoff: f64,
    /// Ends the solve when it is over.
    pub token: &'a StopToken,
    /// The state that the parent's relaxation left, of this method or of another one.
    pub warm: Option<&'a WarmState>,
}

/// What a backend claims about a reduced program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Claim {
    /// `x` is optimal and `y` the multipliers.
    Solved,
    /// There is no feasible point; `y` is the certificate.
    Infeasible,
    /// The objective is unbounded; `x` is a ray.
    Unbounded,
    /// `y` promises a bound of at least the cutoff; `x` is the last iterate.
    Beyond,
    /// Nothing; `x` and `y` hold the last iterates.
    Unknown,
}

/// What a method returns, to be checked.
#[derive(Debug, Clone)]
pub struct RelaxationResult {
    /// The claim.
    pub claim: Claim,
    /// Point or ray, one entry a reduced column.
    pub x: Vec<f64>,
    /// Multipliers of the rows; positive ones press on upper limits, negative ones on lower.
    pub y: Vec<f64>,
    /// Iterations taken.
    pub iterations: u64,
    /// What the relaxations of children may start from; `None` if the method keeps nothing.
    pub warm: Option<WarmState>,
}

/// A solver of reduced programs (convex quadratic, continuous).
pub trait Relaxation: Send {
    /// Solves a program; never panics, never trusted.
    fn solve(&mut self, program: &Reduced, effort: &Effort<'_>) -> RelaxationResult;
}
