//! What can be concluded without a relaxation: domains, bound propagation, reduction.
//!
//! The same parts serve the root and every node of the tree: a [`Domain`] holds the current
//! bounds and undoes them, [`Propagator`] tightens them row by row until nothing moves or a
//! contradiction appears, and [`reduce`](reduce()) turns what is left into a smaller continuous
//! program. What is done once, before the search, and undone after it, is in [`root`].

mod big_m_tightening;
mod change_log;
mod coefficients;
mod conflict_analysis;
mod disjunctive_tightening;
mod domain;
mod implication_probing;
mod implications;
mod learning;
mod no_goods;
mod parallel;
mod probing;
mod projection;
mod propagation;
mod reduce;
pub mod root;
mod tightening;
mod worklist;

pub use big_m_tightening::tighten_big_ms;
pub use coefficients::tighten_coefficients;
pub use disjunctive_tightening::{covering_rows, tighten_by_disjunctions};
pub use domain::{Domain, Reason};
pub use implication_probing::probe_implications;
pub use implications::Implications;
pub use no_goods::{ConflictCounts, Literal, NoGood};
pub use probing::{ProbingRecord, Trials, probe, probe_again};
pub use projection::{Projection, project};
pub use propagation::{Conflict, Propagator};
pub use reduce::{Compressed, Reduced, Reducer, Reduction, reduce};
