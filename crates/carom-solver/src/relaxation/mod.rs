//! Continuous relaxations: methods that solve them, and proofs of what the methods claim.
//!
//! A method implements the trait [`Relaxation`]. [`DualSimplex`] solves linear programs from their
//! parent's basis, and [`ActiveSet`] small dense ones with curvature from its multipliers.
//! [`InteriorPoint`] is quick on the small sparse programs of a tree and gives up early, and
//! [`ClarabelRelaxation`] solves the rest. The [`MethodCascade`] chooses the method and its effort;
//! the rest of the crate uses nothing else. It checks what a method claims: [`Prover`] recomputes a
//! rigorous bound from the multipliers, and infeasibility is accepted only if the same computation
//! proves it.

mod active_set;
mod attempts;
mod borderline;
mod bound;
mod cascade_pool;
mod clarabel;
mod cone_cut;
mod conic;
mod conic_form;
mod correction;
mod descent;
mod extended;
mod interior;
mod loosened;
mod method_cascade;
mod plain_bound;
mod polish;
mod polish_cones;
mod recession;
mod record;
mod scaling;
mod sequential_quadratic;
mod simplex;
mod spent;
#[cfg(feature = "nonlinear")]
mod unproved;
mod verdict;
mod warm_state;

pub use active_set::ActiveSet;
pub(crate) use attempts::Purpose;
pub use bound::Prover;
pub use cascade_pool::CascadePool;
pub use clarabel::ClarabelRelaxation;
pub(crate) use cone_cut::ConeCut;
pub use extended::Extended;
pub use interior::InteriorPoint;
pub use loosened::loosened;
pub use method_cascade::MethodCascade;
pub use polish::polish;
pub(crate) use polish::polish_leaf;
pub(crate) use polish_cones::polish_cones;
pub use record::Record;
pub use simplex::DualSimplex;
pub(crate) use simplex::inverse_rows;
pub(crate) use verdict::{RelaxationQuestion, RelaxationVerdict};
pub(crate) use warm_state::ConeCutRow;
pub use warm_state::WarmState;

use crate::presolve::Reduced;
use crate::solver::StopToken;

/// The effort of a solve, when to stop, and a warm start.
#[derive(Debug, Clone, Copy)]
pub struct Effort<'a> {
    /// Largest number of iterations.
    pub iterations: u32,
    /// Tolerance on gap and residuals, relative.
    pub tolerance: f64,
    /// Steps of iterative refinement in each linear solve.
    pub refinements: u32,
    /// The solve may end as soon as its dual objective reaches this bound; infinite for a complete
    /// solve.
    pub cutoff: f64,
    /// Ends the solve once it is over.
    pub token: &'a StopToken,
    /// The state that the parent's relaxation left, of this method or of another one.
    pub warm: Option<&'a WarmState>,
}

/// The relative margin by which a bound must exceed the cutoff before a method stops: the proof of
/// the bound loses a little.
const CUTOFF_MARGIN: f64 = 1e-7;

impl Effort<'_> {
    /// The bound at which a method may stop.
    fn sufficient_bound(&self) -> f64 {
        self.cutoff + CUTOFF_MARGIN * self.cutoff.abs().max(1.0)
    }
}

/// The claim of a method about a reduced program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RelaxationClaim {
    /// `x` is optimal and `y` the multipliers.
    Solved,
    /// There is no feasible point; `y` is the certificate.
    Infeasible,
    /// The objective is unbounded; `x` is a ray.
    Unbounded,
    /// The dual objective of `y` reaches the cutoff; `x` is the last iterate.
    Beyond,
    /// No claim; `x` and `y` are the last iterates.
    Unknown,
}

/// The unchecked result of a method.
#[derive(Debug, Clone)]
pub struct RelaxationResult {
    /// The claim.
    pub claim: RelaxationClaim,
    /// Point or ray, one entry per reduced column.
    pub x: Vec<f64>,
    /// Multipliers of the rows: positive for active upper limits, negative for active lower limits.
    pub y: Vec<f64>,
    /// Iterations taken.
    pub iterations: u64,
    /// A warm start for the relaxations of the children; `None` if the method keeps no state.
    pub warm: Option<WarmState>,
}

impl RelaxationResult {
    /// A result without a claim and without a point.
    fn nothing(program: &Reduced) -> Self {
        RelaxationResult {
            claim: RelaxationClaim::Unknown,
            x: vec![f64::NAN; program.columns.len()],
            y: vec![0.0; program.rows.len()],
            iterations: 0,
            warm: None,
        }
    }
}

/// A solver of reduced programs (convex quadratic, continuous).
pub trait Relaxation: Send {
    /// Solves a program. It must not panic; its result is checked.
    fn solve(&mut self, program: &Reduced, effort: &Effort<'_>) -> RelaxationResult;

    /// Takes back a result that is no longer needed, for its memory. It may be that of another
    /// method.
    fn reuse(&mut self, _: RelaxationResult) {}
}
