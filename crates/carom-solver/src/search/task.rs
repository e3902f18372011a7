//! The task of a search, and the judgement of its points.

use super::root::Root;
use crate::presolve::LeafColumns;
use crate::program::Program;
use crate::relaxation::CascadePool;
use crate::solution::Point;
use crate::solver::{Options, StopToken};

/// Judges points of a program by the model that it came from.
pub trait PointJudge: Sync {
    /// Whether a point becomes an incumbent: the model's own verification accepts it.
    fn accepts(&self, x: &[f64]) -> bool;

    /// Whether an accepted point is excluded by rows that are found while the search runs.
    fn excludes(&self, _x: &[f64]) -> bool {
        false
    }

    /// Whether rows may be found while the search runs.
    fn finds_rows(&self) -> bool {
        false
    }

    /// The model's point behind a point of the program; `None` if there is none.
    fn point(&self, _x: &[f64]) -> Option<Point> {
        None
    }

    /// The integers of the model, which tell the points of a pool apart.
    fn key(&self, _x: &[f64]) -> Vec<i64> {
        Vec::new()
    }

    /// Whether an integer of the model follows from a column, which then is no auxiliary one.
    fn tells_apart(&self, _column: usize) -> bool {
        true
    }
}

/// Accepts the points that pass a check.
impl<F: Fn(&[f64]) -> bool + Sync> PointJudge for F {
    fn accepts(&self, x: &[f64]) -> bool {
        self(x)
    }

    fn key(&self, x: &[f64]) -> Vec<i64> {
        x.iter().map(|value| value.round() as i64).collect()
    }
}

/// A program to solve, with its judge, methods, options and token: the value that passes through
/// the phases of a solve.
#[derive(Clone, Copy)]
pub struct SolveTask<'a> {
    /// The program.
    pub program: &'a Program,
    /// The program before it was strengthened, with the same columns, for points that become
    /// answers.
    pub exact: Option<&'a Program>,
    /// A program whose columns in leaves are kept from solve to solve, and these.
    pub leaf_columns: Option<(&'a Program, &'a LeafColumns)>,
    /// The propagated and probed root of the program, if it is known.
    pub root: Option<&'a Root>,
    /// The judge of points.
    pub judge: &'a dyn PointJudge,
    /// The methods of the workers.
    pub cascades: &'a CascadePool,
    /// Gaps, tolerances, limits, threads.
    pub options: &'a Options,
    /// The value below which points are searched for (minimised objective); infinite for any point.
    pub cutoff: f64,
    /// Whether a point of a node may be passed over for a better one of the same node.
    pub may_settle: bool,
    /// The time at which the search must stop, and at which the solve began.
    pub token: &'a StopToken,
}

impl<'a> SolveTask<'a> {
    /// A task about a program as it is.
    pub fn new(
        program: &'a Program,
        judge: &'a dyn PointJudge,
        cascades: &'a CascadePool,
        options: &'a Options,
        token: &'a StopToken,
    ) -> Self {
        let cutoff = f64::INFINITY;
        SolveTask {
            program,
            exact: None,
            leaf_columns: None,
            root: None,
            judge,
            cascades,
            options,
            cutoff,
            may_settle: false,
            token,
        }
    }

    /// The (minimised) objective of a point, before the program was strengthened.
    pub fn value(&self, point: &[f64]) -> f64 {
        self.exact.unwrap_or(self.program).objective(point)
    }
}

impl std::fmt::Debug for SolveTask<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SolveTask").field("options", self.options).finish_non_exhaustive()
    }
}
