//! The search: boxes are relaxed and split until the best point is proved.

use std::sync::Arc;

use web_time::{Duration, Instant};

use super::bound_tightening::{tighten_by_reduced_costs, tighten_by_relaxations};
use super::branching::{BoxSplit, choose};
use super::program::{SpatialProgram, middle};
use super::propagation::propagate;
use super::relaxation::{BoxVerdict, RelaxedBox};
use super::state::{SearchState, SpatialResult};
use super::tree::SpatialNode;
use crate::presolve::Domain;
use crate::solution::{Statistics, Termination};
use crate::solver::{Options, StopToken};
use crate::tolerance;

/// The share of all work for local searches from relaxed points with whole integers, before a
/// point is known and after.
const LOCAL_SHARES: [f64; 2] = [0.5, 0.2];

/// A bound of the objective below this comes from columns without bounds, which are proved up to a
/// radius only.
const NO_OBJECTIVE_BOUND: f64 = -0.01 * tolerance::FREE_RADIUS;

/// Nodes after which the objective has to have a bound.
const NODES_WITHOUT_BOUND: u64 = 200;

/// The time between two reports.
const BETWEEN_NEWS: Duration = Duration::from_millis(250);

/// The longest way down before the node with the least bound is next.
const MAX_PLUNGE: u32 = 12;

/// A search over the boxes of a program.
pub(crate) struct SpatialSearch<'a> {
    pub(crate) program: &'a SpatialProgram,
    pub(crate) options: &'a Options,
    pub(crate) token: &'a StopToken,
    /// Whether a point, by column, satisfies the model.
    pub(crate) accepts: &'a dyn Fn(&[f64]) -> bool,
    /// Told of each better point, and a few times a second.
    pub(crate) notify: &'a mut dyn FnMut(&SearchNews<'_>),
}

/// How a search stands while it goes on.
pub(crate) struct SearchNews<'a> {
    pub(crate) occasion: Occasion<'a>,
    pub(crate) statistics: &'a Statistics,
    /// The number of open nodes.
    pub(crate) open: usize,
    /// The objective of the best point, and the proved bound.
    pub(crate) best: Option<f64>,
    pub(crate) bound: f64,
}

/// The occasion of news.
pub(crate) enum Occasion<'a> {
    /// The root is done.
    Root,
    /// A better point, by column.
    Better(&'a [f64]),
    /// Some time has passed.
    Time,
}

impl SpatialSearch<'_> {
    /// Runs the search from points that may be good ones.
    pub(crate) fn run(mut self, starts: &[Vec<f64>]) -> SpatialResult {
        let SpatialSearch { program, options, token, .. } = self;
        let mut state = SearchState::new(program, options, token);
        let mut root = Domain::new(&program.program);
        if propagate(program, &mut state.propagator, &mut root, None).is_err() {
            return state.result(Termination::Infeasible, f64::INFINITY);
        }
        if let Some(flaw) = program.pole(&root) {
            let result = state.result(Termination::Stalled, f64::NEG_INFINITY);
            return SpatialResult { flaw: Some(flaw), ..result };
        }
        for start in starts {
            self.improve(&mut state, &root, start);
        }
        if starts.is_empty() && options.node_limit == Some(0) {
            self.improve(&mut state, &root, &middle(&root));
        }
        let first = SpatialNode {
            bound: f64::NEG_INFINITY,
            depth: 0,
            bounds: Vec::new(),
            x: None,
            warm: None,
            split: None,
        };
        let mut next = Some(first);
        let mut plunge = 0;
        let mut told = Instant::now();
        loop {
            let Some(node) = next.take().or_else(|| state.open.pop()) else { break };
            let least = state.open.bound().unwrap_or(f64::INFINITY).min(node.bound);
            if let Some(reason) = self.limit(&state) {
                return state.result(reason, least);
            }
            let nodes = state.statistics.nodes;
            if nodes > 0
                && nodes.is_multiple_of(NODES_WITHOUT_BOUND)
                && least < NO_OBJECTIVE_BOUND
                && let Some(flaw) = program.openness(&root)
            {
                let result = state.result(Termination::Stalled, f64::NEG_INFINITY);
                return SpatialResult { flaw: Some(flaw), ..result };
            }
            if node.bound >= self.cutoff(&state) {
                state.close(node.bound);
                state.statistics.nodes += 1;
                state.statistics.cut_off += 1;
                continue;
            }
            state.in_hand = node.bound;
            let is_root = node.depth == 0;
            next = self.process(&mut state, &mut root, node);
            if state.falls {
                return state.result(Termination::Unbounded, f64::NEG_INFINITY);
            }
            state.in_hand = next.as_ref().map_or(f64::INFINITY, |node| node.bound);
            if is_root {
                self.tell(&state, Occasion::Root);
            } else if told.elapsed() >= BETWEEN_NEWS {
                told = Instant::now();
                self.tell(&state, Occasion::Time);
            }
            plunge = if next.is_some() { plunge + 1 } else { 0 };
            if plunge > MAX_PLUNGE {
                plunge = 0;
                next.take().into_iter().for_each(|node| state.open.push(node));
            }
        }
        let reason = self.ended(&state);
        state.result(reason, f64::INFINITY)
    }

    /// Why a search ends that has no open nodes.
    fn ended(&self, state: &SearchState<'_>) -> Termination {
        match (&state.best, state.is_stalled) {
            (None, false) => Termination::Infeasible,
            (None, true) => Termination::Stalled,
            (Some((_, value)), _) => {
                let gap = self.options.allowed_gap(*value, self.program.program.constant);
                match value - state.closed.min(*value) <= gap * (1.0 + 1e-9) {
                    true => Termination::Optimal,
                    false => Termination::Stalled,
                }
            }
        }
    }

    /// Tells how the search stands.
    pub(super) fn tell(&mut self, state: &SearchState<'_>, occasion: Occasion<'_>) {
        let open = state.open.bound().unwrap_or(f64::INFINITY).min(state.in_hand);
        let best = state.best.as_ref().map(|(_, value)| *value);
        let bound = open.min(state.closed).min(best.unwrap_or(f64::INFINITY));
        let (statistics, open) = (&state.statistics, state.open.len());
        (self.notify)(&SearchNews { occasion, statistics, open, best, bound });
    }

    fn limit(&self, state: &SearchState<'_>) -> Option<Termination> {
        if self.token.is_over() {
            return Some(self.token.ended().unwrap_or(Termination::Interrupted));
        }
        if self.options.node_limit.is_some_and(|most| state.statistics.nodes >= most) {
            return Some(Termination::NodeLimit);
        }
        let memory = self.options.memory_limit;
        memory
            .is_some_and(|most| state.open.bytes() as u64 > most)
            .then_some(Termination::MemoryLimit)
    }

    /// The bound from which a box holds no point that is better by enough.
    pub(super) fn cutoff(&self, state: &SearchState<'_>) -> f64 {
        state.best.as_ref().map_or(f64::INFINITY, |(_, value)| {
            value - self.options.allowed_gap(*value, self.program.program.constant)
        })
    }

    /// Closes or splits a box; one of its children, if it was split.
    fn process(
        &mut self,
        state: &mut SearchState<'_>,
        root: &mut Domain,
        node: SpatialNode,
    ) -> Option<SpatialNode> {
        let program = self.program;
        let is_root = node.depth == 0;
        state.statistics.nodes += 1;
        state.statistics.depth = state.statistics.depth.max(node.depth);
        let mut domain = root.clone();
        let mark = domain.mark();
        for &(j, [lower, upper]) in &node.bounds {
            domain.set_lower(j as usize, lower);
            domain.set_upper(j as usize, upper);
        }
        let mut cutoff = self.cutoff(state);
        // What is removed from now on is no better than the cutoff.
        state.close(cutoff);
        state.propagator.set_cutoff(&program.program, cutoff);
        let from = if is_root { None } else { Some(mark) };
        if propagate(program, &mut state.propagator, &mut domain, from).is_err() {
            state.statistics.refuted_by_propagation += 1;
            return None;
        }
        let mut relaxed = None;
        for pass in 0..2 {
            let at = node.x.as_ref().map(|x| x.as_slice());
            let start = (at, node.warm.as_ref());
            let verdict = state.relaxer.relax(&mut state.cascade, &domain, start, cutoff, is_root);
            state.count();
            match verdict {
                BoxVerdict::Refuted => {
                    state.statistics.refuted_by_relaxation += 1;
                    state.close(cutoff);
                    return None;
                }
                BoxVerdict::Falls => {
                    state.falls = true;
                    return None;
                }
                BoxVerdict::Stopped => break,
                BoxVerdict::Relaxed(found) => {
                    let again =
                        pass == 0 && self.tighten(state, root, &mut domain, &found, is_root)?;
                    relaxed = Some(found);
                    cutoff = self.cutoff(state);
                    if !again {
                        break;
                    }
                }
            }
        }
        let bound = relaxed.as_ref().map_or(node.bound, |relaxed| relaxed.bound.max(node.bound));
        if bound >= cutoff {
            state.statistics.cut_off += 1;
            state.close(bound);
            return None;
        }
        if let (Some((column, distance)), true) = (node.split, node.bound.is_finite()) {
            state.history.note(column, bound - node.bound, distance);
        }
        self.split(state, root, &domain, (bound, node.depth), relaxed)
    }

    /// Looks for better points, and tightens a box by what is known of its relaxation. Whether it
    /// is worth relaxing again; `None` if nothing is left.
    fn tighten(
        &mut self,
        state: &mut SearchState<'_>,
        root: &mut Domain,
        domain: &mut Domain,
        relaxed: &RelaxedBox,
        is_root: bool,
    ) -> Option<bool> {
        let program = self.program;
        if let Some(x) = &relaxed.x {
            self.offer(state, x);
        }
        if let Some(x) = relaxed.x.as_ref().filter(|_| relaxed.bound < self.cutoff(state)) {
            let nodes = state.statistics.nodes;
            let share = LOCAL_SHARES[usize::from(state.best.is_some())];
            let is_due = state.local_work as f64 <= share * state.work() as f64;
            let is_whole = |j: &usize| (x[*j] - x[*j].round()).abs() <= self.options.integrality;
            let all_whole = program.program.integers.iter().all(is_whole);
            if is_root || is_due && (all_whole || nodes.is_power_of_two()) {
                self.improve(state, domain, x);
            }
            if is_root {
                self.try_random_starts(state, domain);
            }
        }
        let cutoff = self.cutoff(state);
        if relaxed.bound >= cutoff {
            state.statistics.cut_off += 1;
            state.close(relaxed.bound);
            return None;
        }
        state.close(cutoff);
        let mark = domain.mark();
        let mut moves =
            tighten_by_reduced_costs(program, &mut state.cascade, relaxed, domain, cutoff);
        let propagator = &mut state.propagator;
        propagator.set_cutoff(&program.program, cutoff);
        let mut is_empty = moves && propagate(program, propagator, domain, Some(mark)).is_err();
        if is_root && !is_empty {
            let (relaxer, cascade) = (&state.relaxer, &mut state.cascade);
            let x = relaxed.x.as_deref();
            let result = tighten_by_relaxations(relaxer, cascade, propagator, domain, (cutoff, x));
            is_empty = result.is_err();
            state.count();
            if !is_empty {
                // All other boxes are parts of the root.
                *root = domain.clone();
                moves = true;
            }
        }
        if is_empty {
            state.statistics.refuted_by_propagation += 1;
            return None;
        }
        Some(moves)
    }

    /// Splits a box, and returns the child with the relaxed point.
    fn split(
        &mut self,
        state: &mut SearchState<'_>,
        root: &Domain,
        domain: &Domain,
        (bound, depth): (f64, u64),
        relaxed: Option<Box<RelaxedBox>>,
    ) -> Option<SpatialNode> {
        let program = self.program;
        let (x, warm) = match relaxed {
            Some(relaxed) => (relaxed.x, relaxed.warm),
            None => (None, None),
        };
        let guess = x.clone().unwrap_or_else(|| middle(domain));
        let split = choose(program, &state.history, domain, &guess, self.options.integrality);
        let Some(BoxSplit { column, at }) = split else {
            // The functions hold no more than what rounding leaves.
            state.statistics.unfinished += 1;
            state.is_stalled = true;
            state.close(bound);
            return None;
        };
        state.statistics.split += 1;
        let x = x.map(Arc::new);
        let is_whole = program.program.integral[column];
        let bounds = SpatialNode::bounds_of(root, domain);
        let child = |is_upper: bool| {
            let [mut lower, mut upper] = domain.bounds(column);
            let distance = match (is_upper, is_whole) {
                (false, true) => {
                    upper = at.floor().max(lower).min(upper);
                    guess[column] - upper
                }
                (true, true) => {
                    lower = (at.floor() + 1.0).min(upper).max(lower);
                    lower - guess[column]
                }
                (false, false) => {
                    upper = at;
                    domain.upper(column).min(1e6) - at
                }
                (true, false) => {
                    lower = at;
                    at - domain.lower(column).max(-1e6)
                }
            };
            let mut bounds = bounds.clone();
            match bounds.iter_mut().find(|(j, _)| *j as usize == column) {
                Some((_, own)) => *own = [lower, upper],
                None => bounds.push((column as u32, [lower, upper])),
            }
            SpatialNode {
                bound,
                depth: depth + 1,
                bounds,
                x: x.clone(),
                warm: warm.clone(),
                split: Some((column, distance.max(1e-9))),
            }
        };
        let is_right = match is_whole {
            true => guess[column] - at.floor() > 0.5,
            false => guess[column] > at,
        };
        state.open.push(child(!is_right));
        state.statistics.max_open = state.statistics.max_open.max(state.open.len() as u64);
        Some(child(is_right))
    }
}
