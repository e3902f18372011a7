//! Programs without an objective: two ways of searching in turns.
//!
//! Without an objective, a relaxation says of a node only whether it is empty, and a tree over windows
//! of events decides many programs of horizons in a few nodes. Where it does not, an objective of one's
//! own helps, though any point will do: the relaxed values tell how far a split moves what is left, so
//! splits are chosen by gains, and cuts are looked for. It is not known beforehand which of the two is
//! faster, so they take turns with growing limits. All turns together take a small multiple of the
//! nodes of the faster way alone.

use std::cell::RefCell;

use super::stage::{Search, Stage};
use crate::program::Program;
use crate::search::{Found, Seed};
use crate::solution::{Statistics, Termination};
use crate::solver::{BranchingRule, Control, Event, Incumbent, Options, Progress};

/// Nodes of the first turn.
const FIRST: u64 = 100;

/// By how much the limit grows from turn to turn (no unit).
const GROWTH: u64 = 4;

impl Stage<'_> {
    /// Whether a program is searched in turns.
    pub(super) fn alternates(&self, search: &Search<'_>) -> bool {
        let Search { program, options, .. } = search;
        program.is_feasibility_problem()
            && options.branching == BranchingRule::Automatic
            && options.pool == 1
            && !self.as_is
            && self.judge.is_none()
            && self.guidance.is_idle()
            && program.integers.iter().any(|&j| costs_one(program, j))
    }

    /// Searches a program without an objective in turns, with and without one of our own.
    pub(super) fn search_in_turns(
        &self,
        search: Search<'_>,
        control: &mut Control<'_>,
        seed: Option<&Seed>,
    ) -> Found {
        let own = &with_objective(search.program);
        let mut before = Statistics::default();
        let mut guess = None;
        let mut limit = FIRST;
        for turn in 0_u64.. {
            let left = search.options.node_limit.map(|all| all.saturating_sub(before.nodes));
            let is_last = left.is_some_and(|left| left <= limit);
            let node_limit = left.map_or(limit, |left| left.min(limit));
            let options = Options { node_limit: Some(node_limit), ..search.options.clone() };
            let mut found = if turn % 2 == 0 {
                let search = Search { options: &options, ..search };
                self.reporting(&before, search.program, control, |control| {
                    self.search_once(search, control, seed.filter(|_| turn == 0))
                })
            } else {
                // The first point ends it.
                let options = Options { absolute_gap: f64::INFINITY, ..options };
                let search = Search { program: own, options: &options, ..search };
                let found = self.reporting(&before, search.program, control, |control| {
                    Stage { tightened: None, ..*self }.search_once(search, control, None)
                });
                without_objective(found, search.program.offset)
            };
            guess = guess.or(found.guess.take());
            found.statistics.add(&before);
            let is_over = match found.termination {
                Termination::NodeLimit => is_last,
                Termination::Stalled => turn % 2 == 0,
                _ => true,
            };
            if is_over || !found.points.is_empty() {
                return Found { guess, ..found };
            }
            before = found.statistics;
            limit = limit.saturating_mul(GROWTH);
        }
        Found::stopped(Termination::NodeLimit)
    }

    /// Runs a turn whose events count what was done before, and know of no objective.
    fn reporting(
        &self,
        before: &Statistics,
        program: &Program,
        control: &mut Control<'_>,
        run: impl FnOnce(&mut Control<'_>) -> Found,
    ) -> Found {
        let value = program.sign * program.offset;
        let figures = |own: &Progress| Progress {
            nodes: own.nodes + before.nodes,
            relaxations: own.relaxations + before.relaxations,
            incumbent: own.incumbent.map(|_| value),
            bound: if own.bound.is_finite() { value } else { own.bound },
            ..*own
        };
        let watches = control.watches_incumbents();
        let control = RefCell::new(control);
        let mut on_event = |event: &Event| {
            let event = match event {
                Event::Root(own) if before.nodes == 0 => Event::Root(figures(own)),
                Event::Incumbent(own) => Event::Incumbent(figures(own)),
                Event::Root(own) | Event::Progress(own) => Event::Progress(figures(own)),
            };
            control.borrow_mut().report(&event);
        };
        let mut on_incumbent = |found: &Incumbent<'_>| {
            let figures = figures(&found.progress);
            let found = Incumbent::new(found.point, value, found.found_by, figures);
            control.borrow_mut().report_incumbent(&found)
        };
        let mut inner = Control::default().with_progress(&mut on_event);
        if watches {
            inner = inner.with_incumbent(&mut on_incumbent);
        }
        run(&mut inner)
    }
}

/// The result of a search with an objective of our own, as an answer without an objective: no point is
/// better than another.
fn without_objective(found: Found, offset: f64) -> Found {
    let bound = if found.bound == f64::INFINITY { found.bound } else { offset };
    Found { bound, proofs: Vec::new(), forks: Vec::new(), strengthened: None, ..found }
}

/// The program with the number of binaries that are 1 as its objective: conditions that do not hold and
/// events that do not happen leave the rest alone.
fn with_objective(program: &Program) -> Program {
    let mut own = program.clone();
    for &j in program.integers.iter().filter(|&&j| costs_one(program, j)) {
        own.linear[j] = 1.0;
    }
    own
}

fn costs_one(program: &Program, j: usize) -> bool {
    program.lower[j] == 0.0 && program.upper[j] == 1.0
}
