//! Everything that needs no relaxation: domains, bound propagation, reductions.
//!
//! The same parts serve the root and every node of the tree: a [`Domain`] holds the current bounds
//! and undoes them, [`Propagator`] tightens them row by row until nothing moves or a contradiction
//! appears, and [`reduce`](reduce()) turns the rest into a smaller continuous program. Presolve
//! before the search, with its postsolve, is in [`root`].

mod big_m_tightening;
mod big_m_witness;
mod case_row;
mod change_log;
mod coefficients;
mod conditional_cones;
mod congruence;
mod conic_tightening;
mod determined;
mod disjunctive_tightening;
mod domain;
mod implication_probing;
mod implications;
mod parallel;
mod parameters;
mod probing;
mod projection;
mod propagation;
mod reduce;
mod reduced;
mod reduced_cone;
pub(crate) mod root;
mod switched_cones;
mod tightening;
mod worklist;

pub use big_m_tightening::tighten_big_ms;
pub(crate) use case_row::CaseRow;
pub use coefficients::tighten_coefficients;
pub use conditional_cones::tighten_conditional_cones;
pub(crate) use determined::{DeterminedColumns, LeafColumns};
pub use disjunctive_tightening::tighten_by_disjunctions;
pub(crate) use disjunctive_tightening::{
    CASE_COUNTS, MAX_CASE_TRIALS, covering_rows, narrow_to_hull, tighten_rows,
};
pub use domain::Domain;
pub use implication_probing::probe_implications;
pub(crate) use implication_probing::{ColumnBounds, write_changes};
pub use implications::ImplicationGraph;
pub use probing::probe;
pub(crate) use probing::{ProbingRecord, Trials, probe_again};
pub(crate) use projection::Projection;
pub use projection::project;
pub(crate) use propagation::Conflict;
pub use propagation::Propagator;
pub(crate) use reduce::Reducer;
pub use reduce::reduce;
pub(crate) use reduced::refill;
pub use reduced::{Compressed, Reduced};
pub(crate) use reduced_cone::FIXED;
pub(crate) use reduced_cone::{ConeEntry, ReducedCone};
pub use switched_cones::tighten_switched_cones;
pub use worklist::Worklist;
