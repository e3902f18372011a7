//! What all workers share: open nodes, incumbent, bounds, limits.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use web_time::Duration;

use super::node::{Node, NodeQueue};
use super::{Found, Task};
use crate::program::Program;
use crate::solution::{Statistics, Termination};
use crate::solver::{Interrupt, Progress};

/// The shared state of one search.
pub(super) struct Tree<'a> {
    task: Task<'a>,
    interrupt: Interrupt,
    /// Smallest possible difference of two objective values; 0 when unknown.
    granularity: f64,
    state: Mutex<State>,
    wake: Condvar,
}

struct State {
    queue: NodeQueue,
    serial: u64,
    /// Bounds of the nodes that workers are busy with, by worker.
    busy: Vec<Option<f64>>,
    incumbent: Option<(f64, Vec<f64>)>,
    /// Smallest bound of anything closed without proof of infeasibility: pruned by the gap, or
    /// solved as a leaf.
    closed: f64,
    /// Smallest bound of a subtree that could be neither finished nor split.
    stalled: f64,
    stop: Option<Termination>,
    statistics: Statistics,
}

impl<'a> Tree<'a> {
    pub(super) fn new(task: Task<'a>, interrupt: Interrupt) -> Self {
        let mut queue = NodeQueue::default();
        queue.push(Node { path: Vec::new(), bound: f64::NEG_INFINITY, fraction: 0.0, serial: 0 });
        let state = State {
            queue,
            serial: 1,
            busy: vec![None; task.options.threads],
            incumbent: None,
            closed: f64::INFINITY,
            stalled: f64::INFINITY,
            stop: None,
            statistics: Statistics::default(),
        };
        let granularity = granularity(task.program);
        Tree { task, interrupt, granularity, state: Mutex::new(state), wake: Condvar::new() }
    }

    /// A panic in another worker leaves consistent state behind: every change below is complete
    /// before the lock is released.
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn interrupt(&self) -> &Interrupt {
        &self.interrupt
    }

    /// Time left until the limit.
    pub(super) fn time_left(&self) -> Option<Duration> {
        let limit = self.task.options.time_limit?;
        Some(limit.saturating_sub(self.task.start.elapsed()))
    }

    /// The limit that is reached, if any.
    pub(super) fn limit_reached(&self) -> Option<Termination> {
        if self.interrupt.is_triggered() {
            return Some(Termination::Interrupted);
        }
        self.time_left().is_some_and(|left| left.is_zero()).then_some(Termination::TimeLimit)
    }

    /// Ends the search.
    pub(super) fn stop(&self, reason: Termination) {
        let mut state = self.lock();
        state.stop.get_or_insert(reason);
        self.wake.notify_all();
    }

    /// Rounds a bound up to the next value that the objective can take.
    pub(super) fn strengthen(&self, bound: f64) -> f64 {
        if self.granularity == 0.0 || !bound.is_finite() {
            return bound;
        }
        let offset = self.task.program.offset;
        let steps = ((bound - offset) / self.granularity - 1e-6).ceil();
        bound.max(offset + steps * self.granularity)
    }

    /// Nodes with at least this bound cannot improve the incumbent by more than the gap, or by
    /// less than the objective can. A little inside either, so that a bound at the cutoff still
    /// proves the gap.
    pub(super) fn cutoff(&self) -> f64 {
        self.cutoff_of(&self.lock())
    }

    fn cutoff_of(&self, state: &State) -> f64 {
        match &state.incumbent {
            None => f64::INFINITY,
            Some((value, _)) => {
                let options = self.task.options;
                let gap = options.absolute_gap.max(options.relative_gap * value.abs());
                value - (0.9 * gap).max(0.99 * self.granularity)
            }
        }
    }

    /// Next node for a worker: waits while others may still produce some; `None` at the end.
    pub(super) fn next(&self, worker: usize) -> Option<Node> {
        let mut state = self.lock();
        state.busy[worker] = None;
        loop {
            if !self.may_go_on(&mut state) {
                self.wake.notify_all();
                return None;
            }
            let cutoff = self.cutoff_of(&state);
            match state.queue.pop() {
                Some(node) if node.bound >= cutoff => state.closed = state.closed.min(node.bound),
                Some(node) => {
                    state.busy[worker] = Some(node.bound);
                    return Some(node);
                }
                None if state.busy.iter().all(Option::is_none) => {
                    self.wake.notify_all();
                    return None;
                }
                None => {
                    let wait = Duration::from_millis(5);
                    let waited = self.wake.wait_timeout(state, wait);
                    state = waited.unwrap_or_else(PoisonError::into_inner).0;
                }
            }
        }
    }

    /// A worker goes on with a child of its node, unless the search has ended; then the child is
    /// queued, so that the bound still counts it.
    pub(super) fn continue_with(&self, worker: usize, node: Node) -> Option<Node> {
        let mut state = self.lock();
        if self.may_go_on(&mut state) {
            state.busy[worker] = Some(node.bound);
            return Some(node);
        }
        state.busy[worker] = None;
        state.queue.push(node);
        self.wake.notify_all();
        None
    }

    /// A worker gives its node back unfinished and ends the search.
    pub(super) fn give_back(&self, worker: usize, node: Node, reason: Termination) {
        let mut state = self.lock();
        state.busy[worker] = None;
        state.queue.push(node);
        state.stop.get_or_insert(reason);
        self.wake.notify_all();
    }

    /// Whether neither a stop nor the node limit has been reached.
    fn may_go_on(&self, state: &mut State) -> bool {
        if self.task.options.node_limit.is_some_and(|limit| state.statistics.nodes >= limit) {
            let work_left = state.queue.len() > 0 || state.busy.iter().any(Option::is_some);
            if work_left {
                state.stop.get_or_insert(Termination::NodeLimit);
            }
        }
        state.stop.is_none()
    }

    pub(super) fn push(&self, mut node: Node) {
        let mut state = self.lock();
        node.serial = state.serial;
        state.serial += 1;
        state.queue.push(node);
        self.wake.notify_one();
    }

    /// Offers a verified point; `true` when it is the new incumbent.
    pub(super) fn offer(&self, objective: f64, point: Vec<f64>) -> bool {
        let mut state = self.lock();
        let better = state.incumbent.as_ref().is_none_or(|(best, _)| objective < *best);
        if better {
            state.incumbent = Some((objective, point));
            state.statistics.incumbents += 1;
        }
        better
    }

    /// Notes the bound of a subtree that is closed without being infeasible.
    pub(super) fn close(&self, bound: f64) {
        let mut state = self.lock();
        state.closed = state.closed.min(bound);
    }

    /// Notes the bound of a subtree that could be neither finished nor split.
    pub(super) fn stall(&self, bound: f64) {
        let mut state = self.lock();
        state.stalled = state.stalled.min(bound);
    }

    pub(super) fn count(&self, update: impl FnOnce(&mut Statistics)) {
        update(&mut self.lock().statistics);
    }

    /// The figures for a progress event, in the model's own sense.
    pub(super) fn progress(&self) -> Progress {
        let state = self.lock();
        let sign = self.task.program.sign;
        Progress::new(
            state.statistics.nodes,
            state.queue.len(),
            state.statistics.relaxations,
            state.incumbent.as_ref().map(|(value, _)| sign * value),
            sign * bound(&state),
            self.task.start.elapsed(),
        )
    }

    /// The answer, once all workers are done.
    pub(super) fn into_found(self) -> Found {
        let state = self.state.into_inner().unwrap_or_else(PoisonError::into_inner);
        let bound = bound(&state);
        let complete = state.queue.len() == 0 && state.stalled == f64::INFINITY;
        let options = self.task.options;
        let within_gap = state.incumbent.as_ref().is_some_and(|(value, _)| {
            value - bound <= options.absolute_gap.max(options.relative_gap * value.abs())
        });
        let termination = match state.stop {
            Some(Termination::Unbounded) => Termination::Unbounded,
            _ if within_gap => Termination::Optimal,
            Some(reason) => reason,
            None if complete && state.incumbent.is_none() && bound == f64::INFINITY => {
                Termination::Infeasible
            }
            None => Termination::Stalled,
        };
        Found {
            termination,
            incumbent: state.incumbent.map(|(_, point)| point),
            bound: if termination == Termination::Unbounded { f64::NEG_INFINITY } else { bound },
            statistics: state.statistics,
        }
    }
}

/// The proved bound on the whole program.
fn bound(state: &State) -> f64 {
    let busy = state.busy.iter().flatten().copied().fold(f64::INFINITY, f64::min);
    let open = state.queue.best_bound().min(busy).min(state.stalled).min(state.closed);
    // Nothing better than the incumbent is left when every open bound is above it.
    state.incumbent.as_ref().map_or(open, |(value, _)| open.min(*value))
}

/// The smallest possible difference of two objective values: the common divisor of integer
/// coefficients when only integral columns have a cost.
fn granularity(program: &Program) -> f64 {
    if program.quadratic.compute_nnz() > 0 {
        return 0.0;
    }
    let mut divisor = 0u64;
    for (j, &cost) in program.linear.iter().enumerate().filter(|(_, c)| **c != 0.0) {
        let whole = cost.abs();
        if !program.integral[j] || whole != whole.round() || whole > 1e9 {
            return 0.0;
        }
        let (mut a, mut b) = (divisor, whole as u64);
        while b > 0 {
            (a, b) = (b, a % b);
        }
        divisor = a;
    }
    divisor as f64
}
