//! The task of a search.

use super::column_guidance::ColumnGuidance;
use super::root::Root;
use crate::program::Program;
use crate::relaxation::LadderPool;
use crate::solution::Point;
use crate::solver::{Options, StopToken};

/// A check of a full point against the model it came from; decides whether an incumbent is
/// accepted.
pub type Accept<'a> = dyn Fn(&[f64]) -> bool + Sync + 'a;

/// The input of a search.
#[derive(Clone, Copy)]
pub struct Task<'a> {
    /// The program.
    pub program: &'a Program,
    /// The same columns and rows before big-Ms were tightened, for what becomes an answer.
    pub exact: Option<&'a Program>,
    /// The root of the program, if it was probed before.
    pub root: Option<&'a Root>,
    /// The check of incumbents.
    pub accept: &'a Accept<'a>,
    /// The integers that tell two points apart.
    pub key: &'a (dyn Fn(&[f64]) -> Vec<i64> + Sync),
    /// The user's point that a point stands for.
    pub describe: &'a (dyn Fn(&[f64]) -> Option<Point> + Sync),
    /// The user's guidance of the search.
    pub guidance: &'a ColumnGuidance<'a>,
    /// The methods of the workers.
    pub ladders: &'a LadderPool,
    /// Gaps, tolerances, limits, threads.
    pub options: &'a Options,
    /// Points must be better than this (minimised objective); infinite if any will do.
    pub cutoff: f64,
    /// When the search must stop, and when the solve began.
    pub token: &'a StopToken,
}

impl Task<'_> {
    /// The (minimised) objective of a point, which may have further columns.
    pub fn value(&self, point: &[f64]) -> f64 {
        let program = self.exact.unwrap_or(self.program);
        program.objective(point.get(..program.column_count()).unwrap_or(point))
    }
}

impl std::fmt::Debug for Task<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Task").field("options", self.options).finish_non_exhaustive()
    }
}
