//! The search: boxes are relaxed and split until the best point is proved.

use std::sync::Arc;

use super::bound_tightening::{tighten_by_reduced_costs, tighten_by_relaxations};
use super::branching::{BoxSplit, SplitHistory, choose};
use super::flaw::SearchFlaw;
use super::local::TangentSearch;
use super::program::{SpatialProgram, middle};
use super::propagation::propagate;
use super::relaxation::{BoxRelaxer, BoxVerdict, RelaxedBox};
use super::tree::{OpenNodes, SpatialNode};
use crate::presolve::{Domain, Propagator};
use crate::relaxation::MethodCascade;
use crate::solution::{Statistics, Termination};
use crate::solver::{Options, StopToken};
use crate::tolerance;

/// Nodes after which a local search follows, while no point is known; it doubles.
const LOCAL_INTERVAL: u64 = 4;

/// A bound of the objective below this comes from columns without bounds, which are proved up to a
/// radius only.
const NO_OBJECTIVE_BOUND: f64 = -0.01 * tolerance::FREE_RADIUS;

/// Nodes after which the objective has to have a bound.
const NODES_WITHOUT_BOUND: u64 = 200;

/// Random starts of local searches at the root, if no point is known.
const RANDOM_STARTS: usize = 6;

/// The longest way down before the node with the least bound is next.
const MAX_PLUNGE: u32 = 12;

/// The result of a search. Objective values are those of the minimised program.
#[derive(Debug)]
pub(crate) struct SpatialResult {
    pub(crate) termination: Termination,
    /// The best point that was accepted, by column, and its objective.
    pub(crate) best: Option<(Vec<f64>, f64)>,
    /// Proved; infinite if there is no point.
    pub(crate) bound: f64,
    pub(crate) statistics: Statistics,
    /// What makes the program one that cannot be searched.
    pub(crate) flaw: Option<SearchFlaw>,
}

/// A search over the boxes of a program.
pub(crate) struct SpatialSearch<'a> {
    pub(crate) program: &'a SpatialProgram,
    pub(crate) options: &'a Options,
    pub(crate) token: &'a StopToken,
    /// Whether a point, by column, satisfies the model.
    pub(crate) accepts: &'a dyn Fn(&[f64]) -> bool,
    /// Told of each better point.
    pub(crate) notify: &'a mut dyn FnMut(&FoundPoint<'_>),
}

/// A better point, while the search goes on.
pub(crate) struct FoundPoint<'a> {
    pub(crate) statistics: &'a Statistics,
    pub(crate) x: &'a [f64],
    /// Its objective, and the proved bound.
    pub(crate) value: f64,
    pub(crate) bound: f64,
}

/// The state of a search.
struct State<'a> {
    best: Option<(Vec<f64>, f64)>,
    /// The least bound of boxes that are closed because no point in them is better by enough, or
    /// that can be neither split nor closed.
    closed: f64,
    is_stalled: bool,
    statistics: Statistics,
    cascade: MethodCascade,
    propagator: Propagator,
    history: SplitHistory,
    open: OpenNodes,
    relaxer: BoxRelaxer<'a>,
}

impl SpatialSearch<'_> {
    /// Runs the search from points that may be good ones.
    pub(crate) fn run(mut self, starts: &[Vec<f64>]) -> SpatialResult {
        let SpatialSearch { program, options, token, .. } = self;
        let mut state = State {
            best: None,
            closed: f64::INFINITY,
            is_stalled: false,
            statistics: Statistics::default(),
            cascade: MethodCascade::new(options.relaxation),
            propagator: Propagator::new(&program.program),
            history: SplitHistory::new(program.program.column_count()),
            open: OpenNodes::default(),
            relaxer: BoxRelaxer::new(program, options, token),
        };
        let mut root = Domain::new(&program.program);
        state.statistics.threads = 1;
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
        loop {
            let Some(node) = next.take().or_else(|| state.open.pop()) else { break };
            let reason = self.limit(&state);
            if let Some(reason) = reason {
                let bound = state.open.bound().unwrap_or(f64::INFINITY).min(node.bound);
                return state.result(reason, bound);
            }
            let nodes = state.statistics.nodes;
            let least = state.open.bound().unwrap_or(f64::INFINITY).min(node.bound);
            if nodes > 0
                && nodes.is_multiple_of(NODES_WITHOUT_BOUND)
                && least < NO_OBJECTIVE_BOUND
                && let Some(column) = program.open_column(&root)
            {
                let result = state.result(Termination::Stalled, f64::NEG_INFINITY);
                return SpatialResult { flaw: Some(SearchFlaw::OpenColumn(column)), ..result };
            }
            if node.bound >= self.cutoff(&state) {
                state.closed = state.closed.min(node.bound);
                state.statistics.nodes += 1;
                state.statistics.cut_off += 1;
                continue;
            }
            next = self.process(&mut state, &mut root, node);
            plunge = if next.is_some() { plunge + 1 } else { 0 };
            if plunge > MAX_PLUNGE {
                plunge = 0;
                next.take().into_iter().for_each(|node| state.open.push(node));
            }
        }
        let reason = match (&state.best, state.is_stalled) {
            (None, false) => Termination::Infeasible,
            (None, true) => Termination::Stalled,
            (Some((_, value)), _) => {
                let gap = options.allowed_gap(*value, program.program.constant);
                match value - state.closed.min(*value) <= gap * (1.0 + 1e-9) {
                    true => Termination::Optimal,
                    false => Termination::Stalled,
                }
            }
        };
        state.result(reason, f64::INFINITY)
    }

    fn limit(&self, state: &State<'_>) -> Option<Termination> {
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
    fn cutoff(&self, state: &State<'_>) -> f64 {
        state.best.as_ref().map_or(f64::INFINITY, |(_, value)| {
            value - self.options.allowed_gap(*value, self.program.program.constant)
        })
    }

    /// Closes or splits a box; one of its children, if it was split.
    fn process(
        &mut self,
        state: &mut State<'_>,
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
            state.close(cutoff);
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
        state: &mut State<'_>,
        root: &mut Domain,
        domain: &mut Domain,
        relaxed: &RelaxedBox,
        is_root: bool,
    ) -> Option<bool> {
        let program = self.program;
        if let Some(x) = &relaxed.x {
            self.offer(state, x);
            let nodes = state.statistics.nodes;
            let interval = if state.best.is_some() { 64 } else { LOCAL_INTERVAL };
            let is_whole = |j: &usize| (x[*j] - x[*j].round()).abs() <= self.options.integrality;
            let all_whole = program.program.integers.iter().all(is_whole);
            if is_root || nodes.is_power_of_two() || (all_whole && nodes.is_multiple_of(interval)) {
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
            state.close(cutoff);
            return None;
        }
        Some(moves)
    }

    /// Splits a box, and returns the child with the relaxed point.
    fn split(
        &mut self,
        state: &mut State<'_>,
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

    /// Offers a relaxed point, settled on the functions.
    fn offer(&mut self, state: &mut State<'_>, x: &[f64]) {
        let mut settled = x.to_vec();
        for &j in &self.program.program.integers {
            settled[j] = settled[j].round();
        }
        self.program.settle(&mut settled);
        self.accept(state, &settled);
    }

    /// Makes a point the best one if it is, and if it satisfies the model.
    fn accept(&mut self, state: &mut State<'_>, x: &[f64]) {
        let value = self.program.program.objective(x);
        let is_better = state.best.as_ref().is_none_or(|(_, best)| value < *best);
        if value.is_finite() && is_better && (self.accepts)(x) {
            state.statistics.incumbents += 1;
            state.best = Some((x.to_vec(), value));
            let bound = state.open.bound().unwrap_or(f64::NEG_INFINITY).min(value);
            (self.notify)(&FoundPoint { statistics: &state.statistics, x, value, bound });
        }
    }

    /// Looks for points from random ones, as long as none is known.
    fn try_random_starts(&mut self, state: &mut State<'_>, domain: &Domain) {
        let mut random = 0x9e37_79b9_7f4a_7c15_u64;
        for _ in 0..RANDOM_STARTS {
            if state.best.is_some() || self.token.is_over() {
                return;
            }
            let place = |j: usize| {
                random ^= random << 13;
                random ^= random >> 7;
                random ^= random << 17;
                let part = (random >> 11) as f64 / (1_u64 << 53) as f64;
                let [lower, upper] = domain.bounds(j);
                let (lower, upper) =
                    (lower.max(upper.min(0.0) - 10.0), upper.min(lower.max(0.0) + 10.0));
                lower + part * (upper - lower)
            };
            let start: Vec<f64> = (0..domain.column_count()).map(place).collect();
            self.improve(state, domain, &start);
        }
    }

    /// Looks for a point near another one, with the integers rounded.
    fn improve(&mut self, state: &mut State<'_>, domain: &Domain, x: &[f64]) {
        let program = self.program;
        let mut fixed = domain.clone();
        let mark = fixed.mark();
        for &j in &program.program.integers {
            let [lower, upper] = fixed.bounds(j);
            let value = x[j].round().max(lower).min(upper);
            fixed.set_lower(j, value);
            fixed.set_upper(j, value);
        }
        let has_integers = !program.program.integers.is_empty();
        // The cutoff must not exclude what a local search could still improve.
        state.propagator.set_cutoff(&program.program, f64::INFINITY);
        if has_integers
            && propagate(program, &mut state.propagator, &mut fixed, Some(mark)).is_err()
        {
            return;
        }
        let mut cascade =
            std::mem::replace(&mut state.cascade, MethodCascade::new(self.options.relaxation));
        let mut found = Vec::new();
        {
            let search = TangentSearch { relaxer: &state.relaxer, domain: &fixed };
            search.run(&mut cascade, x, &mut |x| found.push(x.to_vec()));
        }
        state.cascade = cascade;
        state.count();
        for x in found.iter().rev() {
            self.accept(state, x);
        }
    }
}

impl State<'_> {
    /// Notes that no point of a box is below a bound.
    fn close(&mut self, bound: f64) {
        self.closed = self.closed.min(bound);
    }

    /// Counts what the relaxations have taken.
    fn count(&mut self) {
        let spent = self.cascade.take_spent();
        self.statistics.relaxations += spent.counts.total();
        self.statistics.relaxation_counts.add(&spent.counts);
        self.statistics.iterations += spent.iterations;
    }

    fn result(self, termination: Termination, open: f64) -> SpatialResult {
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
