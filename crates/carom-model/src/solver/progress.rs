//! Progress events of a solve.

use std::fmt;

use web_time::Duration;

use crate::number::counted;
use crate::solution::{FacetCounts, Heuristic, Point};
use crate::tolerance::relative_gap;

/// A progress event of a solve. Objective values are in the model's own sense.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Event {
    /// Presolve is done, and has left a program of such a size. At most once a solve, before all
    /// others.
    Presolved(ProgramSize, Progress),
    /// The relaxation of the root is solved; cuts follow. At most once a solve, and not for
    /// programs that are not cut.
    Relaxed(Progress),
    /// The root node is done.
    Root(Progress),
    /// The search begins again with facets of unions, which lift its relaxed root. Where a program
    /// falls into blocks, the search of each may do so.
    BegunAgain(FacetCounts, Progress),
    /// A better point was found and verified.
    Incumbent(Progress),
    /// Regular progress, a few times a second.
    Progress(Progress),
    /// The search is over, and the [proof](crate::solver::Options::with_proof) that was asked for
    /// is written, which may take as long again. At most once a solve, after all others.
    Proving(Progress),
}

impl Event {
    /// The progress of any event.
    pub fn progress(&self) -> &Progress {
        match self {
            Event::Presolved(_, p)
            | Event::Relaxed(p)
            | Event::Root(p)
            | Event::BegunAgain(_, p)
            | Event::Incumbent(p)
            | Event::Progress(p)
            | Event::Proving(p) => p,
        }
    }
}

/// The size of a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct ProgramSize {
    /// Linear rows.
    pub rows: usize,
    /// Columns, integral or not.
    pub columns: usize,
    /// Integral columns.
    pub integers: usize,
    /// Entries of the rows.
    pub nonzeros: usize,
    /// Second-order cones.
    pub cones: usize,
}

impl fmt::Display for ProgramSize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ProgramSize { rows, columns, integers, nonzeros, cones } = self;
        let count = |count: &usize, what| counted(*count, what);
        let (rows, columns) = (count(rows, "row"), count(columns, "column"));
        write!(f, "{rows}, {columns} ({integers} integral), {}", count(nonzeros, "nonzero"))?;
        match cones {
            0 => Ok(()),
            cones => write!(f, ", {}", count(cones, "cone")),
        }
    }
}

/// The state of a search at one moment.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Progress {
    /// Nodes processed.
    pub nodes: u64,
    /// Nodes waiting.
    pub open: usize,
    /// Relaxations solved.
    pub relaxations: u64,
    /// Objective of the best point so far.
    pub incumbent: Option<f64>,
    /// Proved bound.
    pub bound: f64,
    /// Time since the solve began.
    pub elapsed: Duration,
    /// Largest depth of a node so far, in decisions.
    pub depth: u64,
    /// The source of the best point so far; `None` if it is not known.
    pub found_by: Option<Heuristic>,
    /// The part of the objective that all points have in common; 0 if it is not known.
    pub constant: f64,
    /// Iterations of all relaxations so far.
    pub iterations: u64,
    /// Rows that cuts have added to the program of the search.
    pub cuts: usize,
    /// An estimate of the part of the tree that is done (no unit, from 0 to 1); `None` if nothing
    /// is known of it. Each split gives every child the same part of its node. Most trees are far
    /// from even, so this tells little about the time that is left.
    pub explored: Option<f64>,
}

impl Progress {
    /// A snapshot, for backends that report their own progress.
    pub fn new(
        nodes: u64,
        open: usize,
        relaxations: u64,
        incumbent: Option<f64>,
        bound: f64,
        elapsed: Duration,
    ) -> Self {
        Progress {
            nodes,
            open,
            relaxations,
            incumbent,
            bound,
            elapsed,
            depth: 0,
            found_by: None,
            constant: 0.0,
            iterations: 0,
            cuts: 0,
            explored: None,
        }
    }

    /// Gap between incumbent and bound, relative as in
    /// [`Solution::relative_gap`](crate::solution::Solution::relative_gap) (no unit); infinite
    /// without an incumbent.
    pub fn relative_gap(&self) -> f64 {
        let gap = |value: f64| relative_gap((value - self.bound).abs(), value, self.constant);
        self.incumbent.map_or(f64::INFINITY, gap)
    }
}

/// A new best point, while the search goes on; see
/// [`Control::with_incumbent`](crate::solver::Control::with_incumbent).
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct Incumbent<'a> {
    /// The point: values by handle. It has passed the verification against the model.
    pub point: &'a Point,
    /// Its objective, in the model's own sense.
    pub objective: f64,
    /// The source of the point.
    pub found_by: Heuristic,
    /// The state of the search when the point was reported, which may be later than when it was
    /// found.
    pub progress: Progress,
}

impl<'a> Incumbent<'a> {
    /// For backends that report their own points.
    pub fn new(point: &'a Point, objective: f64, found_by: Heuristic, progress: Progress) -> Self {
        Incumbent { point, objective, found_by, progress }
    }
}
