//! The start of a search: integers to complete, a point to beat, and the tree of an earlier solve.

use std::sync::Arc;

use super::saved_tree::SavedTree;
use crate::solution::Heuristic;

/// The start of a search, from the user or from earlier searches, in columns of the program. It
/// is checked like any other point.
#[derive(Debug, Clone, Default)]
pub struct Start {
    /// Values of integral columns to complete to a point, the most certain ones first.
    pub integers: Vec<(usize, f64)>,
    /// A point to beat, which was verified before.
    pub(crate) point: Option<StartPoint>,
    /// Whether rounding and roll-outs have been tried at the search's own root; `None` if the point
    /// comes from elsewhere.
    pub(crate) is_rounded: Option<bool>,
    /// The tree of an earlier solve, to be gone through again. `None` if the tree of this search
    /// need not be kept either.
    pub(crate) saved_tree: Option<Arc<SavedTree>>,
}

/// A verified point that a search begins with.
#[derive(Debug, Clone)]
pub struct StartPoint {
    /// A value a column.
    pub values: Vec<f64>,
    /// The heuristic that found it.
    pub found_by: Heuristic,
    /// Whether the user has been told of it.
    pub is_reported: bool,
}

impl Start {
    /// A start with only a point to beat.
    pub fn from_point(point: Option<StartPoint>) -> Self {
        Start { point, ..Start::default() }
    }
}

/// The outcome of completing the integers of a start.
#[derive(Debug, Clone, PartialEq)]
pub enum Completion {
    /// A verified point, with all of the values or most of them.
    Point(Vec<f64>),
    /// No point was found, and propagation contradicts the value of this column.
    Contradiction(usize),
    /// No point with these values was found.
    Nothing,
    /// A limit was reached first.
    Stopped,
}
