//! The state of a search, and its result.

use super::branching::SplitHistory;
use super::flaw::SearchFlaw;
use super::program::SpatialProgram;
use super::relaxation::BoxRelaxer;
use super::tree::OpenNodes;
use crate::presolve::Propagator;
use crate::relaxation::MethodCascade;
use crate::solution::{Statistics, Termination};
use crate::solver::{Options, StopToken};

/// The result of a search. Objective values are those of the minimised program.
#[derive(Debug)]
pub(crate) struct SpatialResult {
    pub(crate) termination: Termination,
    /// The best point that was accepted, by column, and its objective.
    pub(crate) best: Option<(Vec<f64>, f64)>,
    /// Proved; infinite if there is no point.
    pub(crate) bound: f64,
    pub(crate) statistics: Statistics,
    /// The reason why the program cannot be searched.
    pub(crate) flaw: Option<SearchFlaw>,
}

/// The exchanges of the simplex method that take as long as a solve does beside its exchanges.
const SIMPLEX_SOLVE: u64 = 50;

/// The same for a solve by an interior-point method.
const INTERIOR_SOLVE: u64 = 800;

/// The state of a search.
pub(super) struct SearchState<'a> {
    pub(super) best: Option<(Vec<f64>, f64)>,
    /// The least bound of boxes that are closed because no point in them is better by enough, or
    /// that can be neither split nor closed.
    pub(super) closed: f64,
    pub(super) is_stalled: bool,
    /// Whether the objective falls without limit, if there is a point.
    pub(super) falls: bool,
    /// The bound of the node in hand.
    pub(super) in_hand: f64,
    pub(super) statistics: Statistics,
    /// The work of local searches.
    pub(super) local_work: u64,
    pub(super) cascade: MethodCascade,
    pub(super) propagator: Propagator,
    pub(super) history: SplitHistory,
    pub(super) open: OpenNodes,
    pub(super) relaxer: BoxRelaxer<'a>,
}

impl<'a> SearchState<'a> {
    pub(super) fn new(
        program: &'a SpatialProgram,
        options: &'a Options,
        token: &'a StopToken,
    ) -> Self {
        let mut state = SearchState {
            best: None,
            closed: f64::INFINITY,
            is_stalled: false,
            falls: false,
            in_hand: f64::NEG_INFINITY,
            statistics: Statistics::default(),
            local_work: 0,
            cascade: MethodCascade::new(options.relaxation),
            propagator: Propagator::new(&program.program),
            history: SplitHistory::new(program.program.column_count()),
            open: OpenNodes::default(),
            relaxer: BoxRelaxer::new(program, options, token),
        };
        state.statistics.threads = 1;
        state
    }

    /// Notes that no point of a box is below a bound.
    pub(super) fn close(&mut self, bound: f64) {
        self.closed = self.closed.min(bound);
    }

    /// The work so far, in exchanges of the simplex method.
    pub(super) fn work(&self) -> u64 {
        let counts = &self.statistics.relaxation_counts;
        let others = counts.interior_point + counts.clarabel;
        self.statistics.iterations + SIMPLEX_SOLVE * counts.dual_simplex + INTERIOR_SOLVE * others
    }

    /// Counts what the relaxations have taken.
    pub(super) fn count(&mut self) {
        let spent = self.cascade.take_spent();
        self.statistics.relaxations += spent.counts.total();
        self.statistics.relaxation_counts.add(&spent.counts);
        self.statistics.iterations += spent.iterations;
    }

    pub(super) fn result(self, termination: Termination, open: f64) -> SpatialResult {
        let value = self.best.as_ref().map_or(f64::INFINITY, |(_, value)| *value);
        let bound = open.min(self.closed).min(value);
        let bound = if termination == Termination::Infeasible { f64::INFINITY } else { bound };
        SpatialResult {
            termination,
            best: self.best,
            bound,
            statistics: self.statistics,
            flaw: None,
        }
    }
}
