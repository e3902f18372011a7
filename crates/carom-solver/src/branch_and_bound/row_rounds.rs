//! Solving a model whose rows are found on the way: lazy constraints and user cuts.
//!
//! Each round is a whole solve of the model with the rows found so far. Its points are judged by
//! the callback, and a point that a new row excludes is no incumbent; the node that it came from
//! stays open with its bound. So what a round proves holds for the model with all rows that it
//! begins with, and for every model with further rows: bounds only rise from round to round, and
//! what presolve and search conclude from the absence of a row is concluded within a round only. A
//! round that has found rows ends soon, and the next one begins with them and with the integers of
//! the best point.

use super::answer::answer;
use super::events::{PartOfSolve, Told};
use super::far::{DISTANCES, boxed};
use super::lower::lower;
use super::mip_start::GivenStart;
use super::refusals::Refusals;
use super::row_judge::RowJudge;
use super::rows::{CUT, LAZY, add_new, is_violated, with_rows};
use super::solve::{EarlierResults, Solve, SolveResult};
use crate::error::Error;
use crate::model::{Model, StoredRow};
use crate::relaxation::CascadePool;
use crate::search::{Completion, SearchResult, Start};
use crate::solution::{Point, ProofReport, Solution, Statistics, Termination};
use crate::solver::{Control, Options, PoolMode, Progress, StopToken};
use std::path::Path;

/// Nodes of the search without cuts before cuts are asked for, and of one for a point far out.
const FIRST_NODES: u64 = 50;

/// Nodes of the search without cuts after cuts have left no point: at least so many, and so many
/// times as many as before.
const DOUBT_NODES: u64 = 1000;
const DOUBT_FACTOR: u64 = 2;

/// Whether rows may be found while a model is solved.
pub(super) fn finds_rows(control: &Control<'_>) -> bool {
    control.lazy_constraints().is_some() || control.user_cuts().is_some()
}

/// Solves a model with the rows that the callbacks of a control return.
pub(super) fn solve_in_rounds(
    model: &Model,
    options: &Options,
    control: &mut Control<'_>,
) -> Result<Solution, Error> {
    let token = StopToken::new(options.time_limit, control.interrupt());
    let given = control.start().map(|given| GivenStart::new(model, given));
    let mut rounds = RowRounds {
        model,
        options,
        token: &token,
        cascades: CascadePool::new(options),
        refusals: Refusals::default(),
        given,
        completion: None,
        lazy: Vec::new(),
        cuts: Vec::new(),
        points: Vec::new(),
        best: None,
        bound: f64::NEG_INFINITY,
        statistics: Statistics::default(),
        told: Told::nothing(model.sense().sign()),
    };
    let mut solved = rounds.run(control)?;
    if let Some(path) = options.proof_path() {
        solved.proof = rounds.write_proof(path, &mut solved, control)?;
    }
    let RowRounds { cascades, refusals, given, completion, .. } = &mut rounds;
    solved.found.completion = completion.take();
    let (cascades, token) = (&*cascades, &token);
    let solve = Solve { model, options, token, cascades, refusals, rows: None };
    answer(&solve, solved, given.as_ref())
}

/// The state of the rounds of a solve.
pub(super) struct RowRounds<'a> {
    model: &'a Model,
    pub(super) options: &'a Options,
    pub(super) token: &'a StopToken,
    pub(super) cascades: CascadePool,
    refusals: Refusals,
    /// The user's MIP start.
    given: Option<GivenStart>,
    /// The outcome of that start, once it was tried.
    completion: Option<Completion>,
    lazy: Vec<StoredRow>,
    pub(super) cuts: Vec<StoredRow>,
    /// Points that were accepted.
    pub(super) points: Vec<Point>,
    /// The (minimised) objective and the values of the best point.
    best: Option<(f64, Vec<f64>)>,
    /// The bound on the minimised objective.
    bound: f64,
    pub(super) statistics: Statistics,
    told: Told,
}

/// The result of a round.
struct Round {
    solved: SolveResult,
    /// Number of lazy constraints that it has found.
    new: usize,
}

impl RowRounds<'_> {
    /// Rounds until one finds nothing more, or a limit is reached.
    fn run(&mut self, control: &mut Control<'_>) -> Result<SolveResult, Error> {
        if control.user_cuts().is_some() {
            // Points that are found without cuts tell of wrong ones.
            let limit = self.left().unwrap_or(u64::MAX).min(FIRST_NODES);
            let model = with_rows(self.model, LAZY, &self.lazy)?;
            let round = self.search(&model, Some(limit), control)?;
            let stopped = round.solved.found.termination == Termination::NodeLimit;
            let stalled = round.solved.found.termination == Termination::Stalled;
            if !stalled && self.is_last(&round) && !(stopped && self.left() != Some(0)) {
                return Ok(self.conclude(round));
            }
        }
        loop {
            let plain = with_rows(self.model, LAZY, &self.lazy)?;
            if let Some(source) = control.user_cuts().filter(|_| !self.token.is_over()) {
                self.separate(&plain, source)?;
            }
            let round = self.search(&with_rows(&plain, CUT, &self.cuts)?, self.left(), control)?;
            if round.solved.found.termination == Termination::Unbounded && round.new == 0 {
                if !self.finds_rows_far_out(&plain, control)? {
                    return Ok(self.conclude(round));
                }
            } else if self.is_last(&round) {
                if round.solved.found.termination == Termination::Infeasible
                    && !self.cuts.is_empty()
                {
                    return self.without_cuts(round, control);
                }
                return Ok(self.conclude(round));
            }
            if let Some(reason) = self.limit() {
                let solved = SolveResult::without_point(SearchResult::stopped(reason));
                return Ok(self.conclude(Round { solved, new: 0 }));
            }
        }
    }

    /// Nodes that are left.
    fn left(&self) -> Option<u64> {
        self.options.node_limit.map(|limit| limit.saturating_sub(self.statistics.nodes))
    }

    fn limit(&self) -> Option<Termination> {
        let nodes = (self.left() == Some(0)).then_some(Termination::NodeLimit);
        self.token.ended().or(nodes)
    }

    /// Searches a model, which is the user's with further rows, and takes in what is found.
    fn search(
        &mut self,
        model: &Model,
        node_limit: Option<u64>,
        control: &mut Control<'_>,
    ) -> Result<Round, Error> {
        let mut options = self.options.clone().with_blocks(false);
        options.node_limit = node_limit;
        let options = &options;
        let judged = with_rows(self.model, LAZY, &self.lazy)?;
        let token = &self.token.child(None);
        let source = control.lazy_constraints();
        let rows = RowJudge::new(&judged, source, self.lazy.len(), &self.cuts, options, token);
        let own = self.start();
        let given = self.given.as_ref().map(|given| &given.start);
        let known = &EarlierResults { start: own.as_ref().or(given), ..EarlierResults::default() };
        let (cascades, refusals) = (&self.cascades, &self.refusals);
        let solve = Solve { model, options, token, cascades, refusals, rows: Some(&rows) };
        let mut solved = self.watched(control, |control| solve.run(known, control))?;
        let found = &mut solved.found;
        if own.is_none() && self.completion.is_none() {
            self.completion.clone_from(&found.completion);
        }
        let noted = rows.into_noted();
        noted.error.map_or(Ok(()), Err)?;
        let new = add_new(&mut self.lazy, noted.rows);
        found.statistics.lazy_constraints += new as u64;
        self.statistics.add(&found.statistics);
        self.statistics.threads = self.statistics.threads.max(found.statistics.threads);
        if found.bound.is_finite() {
            self.bound = self.bound.max(found.bound);
        }
        self.points.extend(noted.points);
        self.take_in(found)?;
        Ok(Round { solved, new })
    }

    /// Keeps the points that satisfy all rows.
    fn take_in(&mut self, found: &mut SearchResult) -> Result<(), Error> {
        let (model, feasibility) = (self.model, self.options.feasibility);
        let satisfies = |lazy: &[StoredRow], point: &Point| {
            !lazy.iter().any(|row| is_violated(model, row, point, feasibility))
        };
        let lazy = &self.lazy;
        self.points.retain(|point| satisfies(lazy, point));
        let holds = |values: &[f64]| {
            Point::new(model, values.to_vec()).is_ok_and(|point| satisfies(lazy, &point))
        };
        let before = found.points.len();
        found.points.retain(|values| holds(values));
        // A pool that has lost a point has room for one that the search did not look for.
        found.pool_complete &= found.points.len() == before;
        self.best = self.best.take().filter(|(_, values)| holds(values));
        if let Some(values) = found.points.first() {
            let point = Point::new(model, values.clone())?;
            let value = model.sense().sign() * point.value(model.objective())?;
            if self.best.as_ref().is_none_or(|(best, _)| value < *best) {
                self.best = Some((value, values.clone()));
            }
        }
        Ok(())
    }

    /// The integers of the best point so far.
    fn start(&self) -> Option<Start> {
        let (_, values) = self.best.as_ref()?;
        let integers = self.integers(values);
        (!integers.is_empty()).then(|| Start { integers, ..Start::default() })
    }

    /// The whole values of the integers of a point, by which the points of a pool are told apart.
    /// Two rounds may find one of them with continuous values that differ in their last digits.
    fn integers(&self, values: &[f64]) -> Vec<(usize, f64)> {
        let integral = self.model.variables().zip(values).enumerate();
        let integral = integral.filter(|(_, (variable, _))| variable.kind().is_integral());
        integral.map(|(j, (_, value))| (j, value.round())).collect()
    }

    /// Whether no further round is needed.
    fn is_last(&self, round: &Round) -> bool {
        let Round { solved: SolveResult { found, .. }, new } = round;
        let wants_pool = self.options.pool > 1 && self.options.pool_mode == PoolMode::Best;
        match found.termination {
            Termination::Optimal if *new > 0 => {
                let is_whole = !wants_pool || found.pool_complete;
                is_whole && self.is_within_gap()
            }
            Termination::Infeasible => true,
            reason => *new == 0 || reason.is_limit(),
        }
    }

    fn is_within_gap(&self) -> bool {
        let constant = self.model.sense().sign() * self.model.objective_constant();
        let allowed = |value| self.options.allowed_gap(value, constant);
        self.best.as_ref().is_some_and(|&(value, _)| value - self.bound <= allowed(value))
    }

    /// Searches as many nodes again without cuts, after cuts have left no point.
    fn without_cuts(
        &mut self,
        round: Round,
        control: &mut Control<'_>,
    ) -> Result<SolveResult, Error> {
        let most = DOUBT_NODES.max(DOUBT_FACTOR * self.statistics.nodes);
        let limit = self.left().map_or(most, |left| left.min(most));
        let plain = with_rows(self.model, LAZY, &self.lazy)?;
        self.search(&plain, Some(limit), control)?;
        // A point that was found satisfies all cuts, or it would have been an error.
        Ok(self.conclude(round))
    }

    /// Whether points far out, in boxes around a model with an unbounded objective, show rows that
    /// it lacks.
    fn finds_rows_far_out(
        &mut self,
        plain: &Model,
        control: &mut Control<'_>,
    ) -> Result<bool, Error> {
        if control.lazy_constraints().is_none() {
            return Ok(false);
        }
        for far in DISTANCES {
            let boxed = boxed(plain, far)?;
            // Proofs about the box say nothing about the model.
            let bound = self.bound;
            let limit = self.left().unwrap_or(u64::MAX).min(FIRST_NODES);
            let round = self.search(&boxed, Some(limit), control)?;
            self.bound = bound;
            if round.new > 0 {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// The answer.
    fn conclude(&mut self, round: Round) -> SolveResult {
        let SolveResult { mut found, derivatives, origins, mut lowered_point, .. } = round.solved;
        let is_own = self.best.as_ref().map(|(_, values)| values) == found.points.first();
        if round.new > 0 || !is_own {
            lowered_point = None;
        }
        if let Some((value, values)) = &self.best {
            if found.points.first() != Some(values) {
                let own = self.integers(values);
                found.points.retain(|point| self.integers(point) != own);
                found.points.insert(0, values.clone());
                found.points.truncate(self.options.pool);
            }
            if found.termination == Termination::Infeasible {
                found.termination = Termination::Stalled;
                found.pool_complete = false;
            }
            if found.termination != Termination::Unbounded {
                found.bound = self.bound.min(*value);
                if self.is_within_gap() {
                    found.termination = Termination::Optimal;
                }
            }
        } else if found.termination != Termination::Infeasible {
            found.bound = self.bound;
        }
        found.statistics = self.statistics;
        SolveResult { derivatives, origins, lowered_point, ..SolveResult::without_point(found) }
    }

    /// Writes the proof of the answer, with the rows that were found as rows of its program.
    fn write_proof(
        &self,
        path: &Path,
        solved: &mut SolveResult,
        control: &mut Control<'_>,
    ) -> Result<Option<ProofReport>, Error> {
        let model = &with_rows(&with_rows(self.model, LAZY, &self.lazy)?, CUT, &self.cuts)?;
        let token = &StopToken::new(None, control.interrupt());
        let RowRounds { options, cascades, refusals, .. } = self;
        let solve = Solve { model, options, token, cascades, refusals, rows: None };
        let lowered = lower(model, token, true)?;
        Ok(lowered.and_then(|lowered| solve.write_proof(path, &lowered, solved, control)))
    }

    /// Runs a search whose events and points the user sees as those of one solve.
    fn watched<T>(&self, control: &mut Control<'_>, run: impl FnOnce(&mut Control<'_>) -> T) -> T {
        let sign = self.model.sense().sign();
        let better = |a: f64, b: f64| if sign * a < sign * b { a } else { b };
        let figures = |own: &Progress| {
            let best = self.best.as_ref().map(|(value, _)| sign * value);
            {
                let mut progress = *own;
                progress.nodes = own.nodes + self.statistics.nodes;
                progress.relaxations = own.relaxations + self.statistics.relaxations;
                progress.iterations = own.iterations + self.statistics.iterations;
                // Each round has a tree of its own.
                progress.explored = None;
                progress.incumbent =
                    own.incumbent.map(|own| best.map_or(own, |b| better(own, b))).or(best);
                progress.bound = sign * (sign * own.bound).max(self.bound);
                progress
            }
        };
        let round = PartOfSolve {
            is_first: self.statistics.nodes == 0,
            figures: &figures,
            objective: &Some,
            told: Some(&self.told),
            token: self.token,
        };
        round.run(control, run)
    }
}
