//! Solving a model whose rows are found on the way: lazy constraints and user cuts.
//!
//! Each round is a whole solve of the model with the rows found so far. Its points are judged by the
//! callback, and a point that a new row excludes is no incumbent; the node that it came from stays open
//! with its bound. So what a round proves holds for the model with all rows that it begins with, and for
//! every model with further rows: bounds only rise from round to round, and what presolve and search
//! conclude from the absence of a row is concluded within a round only. A round that has found rows ends
//! soon, and the next one begins with them and with the integers of the best point.

use std::cell::{Cell, RefCell};
use std::ops::ControlFlow;

use super::answer::answer;
use super::far::{FAR, boxed};
use super::multipliers::Derivatives;
use super::pipeline::Pipeline;
use super::refusals::Refusals;
use super::row_judge::RowJudge;
use super::rows::{CUT, LAZY, add_new, is_violated, with_rows};
use super::seeding::{report, seed_of};
use super::user_cuts::Relaxing;
use crate::error::Error;
use crate::model::{Model, StoredRow};
use crate::relaxation::LadderPool;
use crate::search::{ColumnGuidance, Found, Seed};
use crate::solution::{Point, SeedReport, Solution, Statistics, Termination};
use crate::solver::{Control, Event, Incumbent, Options, PoolMode, Progress, StopToken};

/// Nodes of the search without cuts before cuts are asked for, and of one for a point far out.
const PLAIN_NODES: u64 = 50;

/// Nodes of the search without cuts after cuts have left no point: at least so many, and so many times
/// as many as before.
const DOUBT_NODES: u64 = 1000;
const DOUBT_TIMES: u64 = 2;

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
    let given = control.seed().map(|seed| seed_of(model, seed));
    let mut rounds = Rounds {
        model,
        options,
        token: &token,
        ladders: LadderPool::new(options),
        refusals: Refusals::default(),
        given,
        seed_report: None,
        lazy: Vec::new(),
        cuts: Vec::new(),
        points: Vec::new(),
        best: None,
        bound: f64::NEG_INFINITY,
        statistics: Statistics::default(),
        told: [Cell::new(f64::INFINITY), Cell::new(f64::INFINITY)],
    };
    let (found, derivatives) = rounds.run(control)?;
    let Rounds { refusals, seed_report, .. } = rounds;
    answer(model, options, found, derivatives, seed_report, refusals.take())
}

/// The state of the rounds of a solve.
struct Rounds<'a> {
    model: &'a Model,
    options: &'a Options,
    token: &'a StopToken,
    ladders: LadderPool,
    refusals: Refusals,
    /// The user's seed, and how many of its entries are ignored.
    given: Option<(Seed, usize)>,
    seed_report: Option<SeedReport>,
    lazy: Vec<StoredRow>,
    cuts: Vec<StoredRow>,
    /// Points that were accepted.
    points: Vec<Point>,
    /// The (minimised) objective and the values of the best point.
    best: Option<(f64, Vec<f64>)>,
    /// The bound on the minimised objective.
    bound: f64,
    statistics: Statistics,
    /// The best (minimised) objective that the user was told of, as an event and as a point.
    told: [Cell<f64>; 2],
}

/// A round.
struct Round {
    found: Found,
    derivatives: Option<Derivatives>,
    /// How many lazy constraints it has found.
    new: usize,
}

impl Rounds<'_> {
    /// Rounds until one finds nothing more, or a limit is reached.
    fn run(&mut self, control: &mut Control<'_>) -> Result<(Found, Option<Derivatives>), Error> {
        if control.user_cuts().is_some() {
            // Points that are found without cuts tell of wrong ones.
            let limit = self.left().unwrap_or(u64::MAX).min(PLAIN_NODES);
            let model = with_rows(self.model, LAZY, &self.lazy)?;
            let round = self.search(&model, Some(limit), control)?;
            let stopped = round.found.termination == Termination::NodeLimit;
            let stalled = round.found.termination == Termination::Stalled;
            if !stalled && self.is_last(&round) && !(stopped && self.left() != Some(0)) {
                return Ok(self.conclude(round));
            }
        }
        loop {
            let plain = with_rows(self.model, LAZY, &self.lazy)?;
            self.separate(&plain, control)?;
            let round = self.search(&with_rows(&plain, CUT, &self.cuts)?, self.left(), control)?;
            if round.found.termination == Termination::Unbounded && round.new == 0 {
                if !self.finds_rows_far_out(&plain, control)? {
                    return Ok(self.conclude(round));
                }
            } else if self.is_last(&round) {
                if round.found.termination == Termination::Infeasible && !self.cuts.is_empty() {
                    return self.without_cuts(round, control);
                }
                return Ok(self.conclude(round));
            }
            if let Some(reason) = self.limit() {
                let found = Found::stopped(reason);
                return Ok(self.conclude(Round { found, derivatives: None, new: 0 }));
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

    /// Asks for cuts at the root.
    fn separate(&mut self, model: &Model, control: &Control<'_>) -> Result<(), Error> {
        let Some(source) = control.user_cuts().filter(|_| !self.token.is_over()) else {
            return Ok(());
        };
        let Rounds { options, token, ladders, cuts, points, statistics, .. } = self;
        let relaxing = Relaxing { options, token, ladders };
        relaxing.separate(model, source, cuts, points, statistics)
    }

    /// Searches a model, which is the user's with further rows, and takes in what is found.
    fn search(
        &mut self,
        model: &Model,
        node_limit: Option<u64>,
        control: &mut Control<'_>,
    ) -> Result<Round, Error> {
        let options = &Options { node_limit, blocks: false, ..self.options.clone() };
        let judged = with_rows(self.model, LAZY, &self.lazy)?;
        let token = &self.token.child(None);
        let lazy = (control.lazy_constraints(), self.lazy.len());
        let judge = RowJudge::new(&judged, lazy, &self.cuts, options.feasibility, token);
        let excludes = |point: &Point| judge.excludes(point);
        let guidance = &ColumnGuidance::new(model, control.guidance())?.with_judge(&excludes);
        let own = self.seed();
        let seed = own.as_ref().or(self.given.as_ref().map(|(seed, _)| seed));
        let (ladders, refusals) = (&self.ladders, &self.refusals);
        let (mut found, derivatives) = {
            let judge = Some(&judge);
            let pipeline =
                Pipeline { model, options, token, guidance, ladders, refusals, judge, seed };
            self.watched(control, &mut |control| pipeline.run(control))?
        };
        if let (None, None, Some((seed, ignored))) = (&own, &self.seed_report, &self.given) {
            self.seed_report = Some(report(self.model, &found, seed, *ignored));
        }
        let noted = judge.into_noted();
        noted.error.map_or(Ok(()), Err)?;
        let new = add_new(&mut self.lazy, noted.rows);
        found.statistics.lazy_constraints += new as u64;
        self.statistics.add(&found.statistics);
        self.statistics.threads = self.statistics.threads.max(found.statistics.threads);
        if found.bound.is_finite() {
            self.bound = self.bound.max(found.bound);
        }
        self.points.extend(noted.points);
        self.take_in(&mut found)?;
        Ok(Round { found, derivatives, new })
    }

    /// Keeps the points that satisfy all rows.
    fn take_in(&mut self, found: &mut Found) -> Result<(), Error> {
        let (model, feasibility) = (self.model, self.options.feasibility);
        let satisfies = |lazy: &[StoredRow], point: &Point| {
            !lazy.iter().any(|row| is_violated(model, row, point, feasibility))
        };
        let lazy = &self.lazy;
        self.points.retain(|point| satisfies(lazy, point));
        let holds = |values: &[f64]| {
            Point::new(model, values.to_vec()).is_ok_and(|point| satisfies(lazy, &point))
        };
        found.points.retain(|values| holds(values));
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

    /// The integers of the best point so far, with the boxes of the user's seed.
    fn seed(&self) -> Option<Seed> {
        let (_, values) = self.best.as_ref()?;
        let integral = self.model.variables().zip(values).enumerate();
        let integral = integral.filter(|(_, (variable, _))| variable.kind().is_integral());
        let guess: Vec<(usize, f64)> = integral.map(|(j, (_, value))| (j, *value)).collect();
        let leaves = self.given.as_ref().map_or(Vec::new(), |(seed, _)| seed.leaves.clone());
        let is_empty = guess.is_empty() && leaves.is_empty();
        (!is_empty).then(|| Seed { guess, leaves, ..Seed::default() })
    }

    /// Whether no further round is needed.
    fn is_last(&self, round: &Round) -> bool {
        let Round { found, new, .. } = round;
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

    /// Searches as much again without cuts, where these leave no point.
    fn without_cuts(
        &mut self,
        round: Round,
        control: &mut Control<'_>,
    ) -> Result<(Found, Option<Derivatives>), Error> {
        let most = DOUBT_NODES.max(DOUBT_TIMES * self.statistics.nodes);
        let limit = self.left().map_or(most, |left| left.min(most));
        let plain = with_rows(self.model, LAZY, &self.lazy)?;
        self.search(&plain, Some(limit), control)?;
        // A point that was found satisfies all cuts, or it would have been an error.
        Ok(self.conclude(round))
    }

    /// Whether a point far out, where the objective still falls, tells of rows that end the fall.
    fn finds_rows_far_out(
        &mut self,
        plain: &Model,
        control: &mut Control<'_>,
    ) -> Result<bool, Error> {
        if control.lazy_constraints().is_none() {
            return Ok(false);
        }
        for far in FAR {
            let boxed = boxed(plain, far)?;
            // What is proved of it says nothing of the model.
            let bound = self.bound;
            let limit = self.left().unwrap_or(u64::MAX).min(PLAIN_NODES);
            let round = self.search(&boxed, Some(limit), control)?;
            self.bound = bound;
            if round.new > 0 {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// The answer.
    fn conclude(&mut self, round: Round) -> (Found, Option<Derivatives>) {
        let Round { mut found, derivatives, .. } = round;
        if let Some((value, values)) = &self.best {
            if found.points.first() != Some(values) {
                found.points.retain(|point| point != values);
                found.points.insert(0, values.clone());
                found.points.truncate(self.options.pool);
            }
            if found.termination == Termination::Infeasible {
                found.termination = Termination::Stalled;
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
        found.statistics = Statistics { time: self.token.elapsed(), ..self.statistics };
        (found, derivatives)
    }

    /// Runs a search whose events and points the user sees as those of one solve.
    fn watched<T>(
        &self,
        control: &mut Control<'_>,
        run: &mut dyn FnMut(&mut Control<'_>) -> T,
    ) -> T {
        let sign = self.model.sense().sign();
        let better = |a: f64, b: f64| if sign * a < sign * b { a } else { b };
        let progress = |own: &Progress| {
            let best = self.best.as_ref().map(|(value, _)| sign * value);
            Progress {
                nodes: own.nodes + self.statistics.nodes,
                relaxations: own.relaxations + self.statistics.relaxations,
                incumbent: own.incumbent.map(|own| best.map_or(own, |b| better(own, b))).or(best),
                bound: sign * (sign * own.bound).max(self.bound),
                ..*own
            }
        };
        let is_news = |told: &Cell<f64>, objective: f64| {
            let better = sign * objective < told.get();
            told.set(told.get().min(sign * objective));
            better
        };
        let watches = control.watches_incumbents();
        let control = RefCell::new(control);
        let mut on_event = |event: &Event| {
            let progress = progress(event.progress());
            let event = match event {
                Event::Root(_) if self.statistics.nodes == 0 => Event::Root(progress),
                Event::Incumbent(_)
                    if progress.incumbent.is_some_and(|v| is_news(&self.told[0], v)) =>
                {
                    Event::Incumbent(progress)
                }
                _ => Event::Progress(progress),
            };
            control.borrow_mut().report(&event);
        };
        let mut on_incumbent = |found: &Incumbent<'_>| {
            if !is_news(&self.told[1], found.objective) {
                return ControlFlow::Continue(());
            }
            let figures = progress(&found.progress);
            let whole = Incumbent::new(found.point, found.objective, found.found_by, figures);
            let flow = control.borrow_mut().report_incumbent(&whole);
            if flow.is_break() {
                self.token.stop();
            }
            flow
        };
        let mut inner = Control::default().with_progress(&mut on_event);
        if watches {
            inner = inner.with_incumbent(&mut on_incumbent);
        }
        run(&mut inner)
    }
}
