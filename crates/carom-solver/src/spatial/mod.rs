//! Spatial branch and bound: programs with functions that are neither affine nor piecewise affine.
//!
//! Each such function is a `SmoothTerm`: a column that equals a function of one or two others. At a
//! node, rows enclose it over the ranges of its arguments, so that the relaxation is linear.
//! Splitting a range makes both enclosures tighter.
//!
//! * `program.rs`: a lowered program with its terms; `term.rs`: what a term is.
//! * `logarithms.rs`: products once more, as exponentials.
//! * `enclosure.rs`: rows about a term over a box (McCormick 1976; tangents and chords).
//! * `propagation.rs`: ranges of arguments from those of values, and the reverse.
//! * `relaxation.rs`: the relaxation of a box, with rows that its point violates.
//! * `bound_tightening.rs`: the range of a column over the relaxation.
//! * `local.rs`: points from a sequence of quadratic programs; `points.rs`: those that count.
//! * `branching.rs`: where to split; `tree.rs`: open nodes; `search.rs`: the search;
//!   `state.rs`: its state and its result; `flaw.rs`: why there may be none.
//!
//! The overall method is that of Tawarmalani and Sahinidis, *Convexification and Global
//! Optimization in Continuous and Mixed-Integer Nonlinear Programming* (2002).

mod bound_tightening;
mod branching;
mod enclosure;
mod flaw;
mod local;
mod logarithms;
mod points;
mod program;
mod propagation;
mod relaxation;
mod search;
mod state;
mod term;
mod tree;

pub(crate) use branching::{BoxSplit, SplitHistory, choose};
pub(crate) use enclosure::{EnclosureRow, rows, separate};
pub(crate) use flaw::SearchFlaw;
pub(crate) use program::{SpatialProgram, middle};
pub(crate) use relaxation::{CONE_MISS, ROW_NAMES};
pub(crate) use search::{Occasion, SearchNews, SpatialSearch};
pub(crate) use state::SpatialResult;
pub(crate) use term::Shape;
