//! The state that all workers share: open nodes, best points, bounds, limits.

use std::sync::atomic::{AtomicU32, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, OnceLock, PoisonError};

use super::best_points::{Accepted, BestPoints};
use super::comparison::{Contradiction, contradiction};
use super::found::{ClosedNode, SearchResult};
use super::node::{Node, NodeQueue, Path, StepCount};
use super::pseudocosts::Pseudocosts;
use super::root::Root;
use super::saved_tree::{End, SavedDuals, SavedSplit, SavedTree};
use super::start::{Completion, Start, StartPoint};
use super::task::SolveTask;
use super::trace::event;
use crate::presolve::LeafColumns;
use crate::program::Program;
use crate::relaxation::WarmState;
use crate::solution::{Heuristic, Statistics, Termination};
use crate::solver::{Elsewhere, Progress};

/// Least number of nodes for which a search goes on once it has found rows that its program lacks.
const NODES_AFTER_ROWS: u64 = 8;

/// The search itself, for heuristics that solve smaller programs with it.
pub(super) type NestedSearch = fn(SolveTask<'_>) -> SearchResult;

/// The state that the workers of one search share.
pub(super) struct Tree<'a> {
    pub(super) task: SolveTask<'a>,
    pub(super) root: &'a Root,
    pub(super) start: Option<&'a Start>,
    pub(super) nested: NestedSearch,
    /// Smallest possible difference of two objective values; 0 when unknown.
    granularity: f64,
    pub(super) state: Mutex<TreeState>,
    pub(super) wake: Condvar,
    /// Workers that wait for a node.
    pub(super) idle: AtomicUsize,
    /// The cutoff, as bits: read far more often than it changes.
    cutoff: AtomicU64,
    pub(super) serial: AtomicU64,
    /// Nodes that wait in the queue.
    pub(super) open: AtomicUsize,
    pub(super) steps: StepCount,
    /// Dual solutions that were offered to be kept.
    pub(super) duals: AtomicUsize,
    /// The next name of a node.
    pub(super) ids: AtomicU32,
    /// The state left by the root's relaxation: a start for nodes that have kept none.
    pub(super) root_state: OnceLock<WarmState>,
    /// The pseudocosts from all workers.
    pub(super) pseudocosts: Mutex<Pseudocosts>,
    /// The columns that equations determine in leaves; computed at the first request.
    pub(super) determined: LeafColumns,
}

pub(super) struct TreeState {
    pub(super) queue: NodeQueue,
    /// Smallest bound of what a worker has at hand, by worker.
    pub(super) floors: Vec<Option<f64>>,
    /// The part of the whole tree that a worker has at hand, by worker.
    pub(super) shares: Vec<f64>,
    points: BestPoints,
    /// Incumbents that were not reported yet.
    news: Vec<Accepted>,
    /// Smallest bound of anything closed without proof of infeasibility: pruned by the gap, or
    /// solved as a leaf.
    pub(super) closed: f64,
    /// Smallest bound of a subtree that could be neither finished nor split.
    pub(super) stalled: f64,
    /// The part of the tree that other processes hold.
    pub(super) elsewhere: Elsewhere,
    pub(super) stop: Option<Termination>,
    /// Whether a visible part of the value of a point is due to limits that presolve has widened.
    pub(super) is_widened: bool,
    /// The error of the strengthened program, if an accepted point shows one.
    contradiction: Option<Contradiction>,
    /// Bytes of the tree when they were last counted: in rounds, before the present one.
    bytes: u64,
    /// Nodes that were handed to workers.
    pub(super) started: u64,
    /// Nodes when rows were first found that a point violates.
    rows_since: Option<u64>,
    statistics: Statistics,
    /// Ends of the tree, if they are asked for.
    leaves: Vec<(Path, f64)>,
    duals: Vec<SavedDuals>,
    splits: Vec<SavedSplit>,
    pub(super) completion: Option<Completion>,
}

impl TreeState {
    /// Nodes processed by this process.
    pub(super) fn nodes(&self) -> u64 {
        self.statistics.nodes
    }

    /// Whether points make presolve or cuts doubtful.
    pub(super) fn is_doubtful(&self) -> bool {
        self.is_widened || self.contradiction.is_some()
    }

    pub(super) fn statistics(&self) -> Statistics {
        self.statistics
    }

    pub(super) fn add_statistics(&mut self, counts: &Statistics) {
        self.statistics.add(counts);
    }
}

/// The finds of a worker since it last handed them over.
#[derive(Default)]
pub(super) struct WorkerReport {
    pub(super) statistics: Statistics,
    pub(super) closed: Option<f64>,
    pub(super) stalled: Option<f64>,
    pub(super) leaves: Vec<(Path, f64)>,
    pub(super) duals: Vec<SavedDuals>,
    pub(super) splits: Vec<SavedSplit>,
}

impl<'a> Tree<'a> {
    /// A tree of its root alone, for so many workers.
    pub(super) fn new(
        task: SolveTask<'a>,
        root: &'a Root,
        start: Option<&'a Start>,
        nested: NestedSearch,
        workers: usize,
    ) -> Self {
        let state = TreeState {
            queue: NodeQueue::default(),
            floors: vec![None; workers],
            shares: vec![0.0; workers],
            points: BestPoints::new(task.options),
            news: Vec::new(),
            closed: f64::INFINITY,
            stalled: f64::INFINITY,
            elsewhere: Elsewhere::default(),
            stop: None,
            is_widened: false,
            contradiction: None,
            bytes: 0,
            started: 0,
            rows_since: None,
            statistics: Statistics::default(),
            leaves: Vec::new(),
            duals: Vec::new(),
            splits: Vec::new(),
            completion: None,
        };
        let tree = Tree {
            task,
            root,
            start,
            nested,
            granularity: granularity(task.program),
            state: Mutex::new(state),
            wake: Condvar::new(),
            idle: AtomicUsize::new(0),
            cutoff: AtomicU64::new(task.cutoff.to_bits()),
            serial: AtomicU64::new(1),
            open: AtomicUsize::new(1),
            steps: StepCount::default(),
            duals: AtomicUsize::new(0),
            ids: AtomicU32::new(1),
            root_state: OnceLock::new(),
            pseudocosts: Mutex::new(Pseudocosts::new(task.program.column_count())),
            determined: LeafColumns::default(),
        };
        let mut node = Node::relaxed_root(root.point.as_ref());
        node.bound = tree.strengthen(node.bound);
        tree.lock().queue.push(node);
        if let Some(StartPoint { values, found_by, is_reported }) =
            start.and_then(|start| start.point.clone())
        {
            let value = task.value(&values);
            let accepted = tree.accepted(value, values, found_by);
            let state = &mut tree.lock();
            tree.accept(state, accepted);
            if is_reported {
                state.news.clear();
            }
        }
        tree
    }

    /// A panic in another worker leaves consistent state behind: every change below is complete
    /// before the lock is released.
    pub(super) fn lock(&self) -> MutexGuard<'_, TreeState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Ends the search.
    pub(super) fn stop(&self, reason: Termination) {
        self.lock().stop.get_or_insert(reason);
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

    /// A node with at least this bound improves the best points by less than the gap, or by less
    /// than two values of the objective differ.
    pub(super) fn cutoff(&self) -> f64 {
        f64::from_bits(self.cutoff.load(Ordering::Acquire))
    }

    /// The cutoff that follows from a value to improve on. It lies a little inside the gap, so that
    /// a bound at the cutoff still proves the gap.
    pub(super) fn cutoff_at(&self, value: f64) -> f64 {
        let options = self.task.options;
        let gap = options.allowed_gap(value, self.task.program.constant);
        value - (0.9 * gap).max(0.99 * self.granularity)
    }

    /// Whether the search may go on. Notes the limit that ends it.
    pub(super) fn may_go_on(&self, state: &mut TreeState) -> bool {
        let options = self.task.options;
        let open = self.open.load(Ordering::Relaxed);
        state.bytes = self.bytes(state);
        let counts = &mut state.statistics;
        counts.max_open = counts.max_open.max(open as u64);
        counts.tree_bytes = counts.tree_bytes.max(state.bytes);
        if state.stop.is_none() && (open > 0 || state.floors.iter().any(Option::is_some)) {
            let nodes = state.started.max(state.statistics.nodes);
            state.stop = if let Some(reason) = self.task.token.ended() {
                Some(reason)
            } else if options.node_limit.is_some_and(|limit| nodes >= limit) {
                Some(Termination::NodeLimit)
            } else if options.memory_limit.is_some_and(|limit| state.bytes >= limit) {
                Some(Termination::MemoryLimit)
            } else if has_enough_rows(state) {
                Some(Termination::Stalled)
            } else {
                None
            };
        }
        state.stop.is_none()
    }

    /// Bytes of all that grows with the search: open nodes, their shared decisions, kept leaves,
    /// best points.
    fn bytes(&self, state: &TreeState) -> u64 {
        let nodes = self.open.load(Ordering::Relaxed) * size_of::<Node>();
        let steps = self.steps.load(Ordering::Relaxed) * Path::STEP_BYTES;
        let leaves = state.leaves.len() * size_of::<(Path, f64)>();
        (nodes + steps + leaves + state.points.bytes()) as u64
    }

    /// A worker's share of the memory that is left, if there is a limit.
    pub(super) fn memory_left(&self) -> Option<u64> {
        let limit = self.task.options.memory_limit?;
        let state = self.lock();
        Some(limit.saturating_sub(state.bytes) / state.floors.len().max(1) as u64)
    }

    /// The best point and its value. In rounds it is that of the last one's end.
    pub(super) fn incumbent(&self) -> Option<(f64, Vec<f64>)> {
        self.lock().points.incumbent().map(|best| (best.value, best.point.clone()))
    }

    /// The value of the best point of the pool with a key; in rounds that of the last one's end.
    pub(super) fn value_of(&self, key: &[i64]) -> Option<f64> {
        self.lock().points.value_of(key)
    }

    /// Whether memory is so short that depth goes before the best bound.
    fn is_short_of_memory(&self, state: &TreeState) -> bool {
        self.task.options.memory_limit.is_some_and(|limit| self.bytes(state) >= limit / 2)
    }

    /// Ends the search, because no bound holds.
    pub(super) fn contradict(&self, state: &mut TreeState, what: Contradiction) {
        event!(WARN, what = ?what, "contradiction");
        state.contradiction = Some(what);
        state.statistics.contradictions += 1;
        state.stop.get_or_insert(Termination::Stalled);
        self.wake.notify_all();
    }

    /// Takes in a verified point; `true` when it is the new incumbent. Ends the search if the point
    /// contradicts the strengthened program, because then no bound holds.
    pub(super) fn accept(&self, state: &mut TreeState, accepted: Accepted) -> bool {
        let wrong = contradiction(&self.task, &self.root.domain, &accepted.point);
        wrong.into_iter().for_each(|what| self.contradict(state, what));
        let found_by = accepted.found_by;
        let news = accepted.clone();
        let better = state.points.offer(accepted);
        if better {
            event!(INFO, value = news.value, found_by = %found_by, "incumbent");
            state.statistics.incumbents += 1;
            state.statistics.heuristics.of_mut(found_by).incumbents += 1;
            state.news.push(news);
        }
        let beaten = state.points.to_beat().map_or(f64::INFINITY, |value| self.cutoff_at(value));
        // Points that the gap of the pool excludes stay out even while the pool has room.
        let cutoff = if state.points.wants_all() {
            beaten.min(state.points.limit().next_up())
        } else {
            beaten
        };
        let cutoff = cutoff.min(self.task.cutoff);
        self.cutoff.store(cutoff.to_bits(), Ordering::Release);
        better
    }

    /// Takes in the finds of a worker.
    pub(super) fn take_in(&self, state: &mut TreeState, report: WorkerReport) {
        state.statistics.add(&report.statistics);
        state.closed = state.closed.min(report.closed.unwrap_or(f64::INFINITY));
        state.stalled = state.stalled.min(report.stalled.unwrap_or(f64::INFINITY));
        state.leaves.extend(report.leaves);
        state.duals.extend(report.duals);
        state.splits.extend(report.splits);
    }

    /// Adds an open node.
    pub(super) fn push(&self, state: &mut TreeState, mut node: Node) {
        node.serial = self.serial.fetch_add(1, Ordering::Relaxed);
        self.open.fetch_add(1, Ordering::Relaxed);
        state.queue.push(node);
    }

    /// The next node of a search: the best one, or the deepest one where memory is short.
    pub(super) fn pop(&self, state: &mut TreeState) -> Option<Node> {
        let is_short = self.is_short_of_memory(state);
        if is_short { state.queue.pop_deepest() } else { state.queue.pop() }
    }

    /// Closes a node that is beyond the cutoff before any worker has processed it.
    pub(super) fn close_unseen(&self, state: &mut TreeState, node: Node) {
        self.open.fetch_sub(1, Ordering::Relaxed);
        state.closed = state.closed.min(node.bound);
        if let Some(multipliers) = node.multipliers.filter(|_| self.has_room_for_duals()) {
            state.duals.push(SavedDuals::new(End::Node(node.id), multipliers));
        }
        if self.task.options.parts().keep_leaves {
            state.leaves.push((node.path, node.bound));
        }
    }

    /// Whether one more dual solution may be kept.
    pub(super) fn has_room_for_duals(&self) -> bool {
        let program = self.task.exact.unwrap_or(self.task.program);
        let most = match self.task.options.memory_limit {
            None => SavedTree::max_duals(program.column_count(), program.row_count()),
            Some(_) => 0,
        };
        self.duals.fetch_add(1, Ordering::Relaxed) < most
    }

    pub(super) fn count_thread(&self) {
        self.lock().statistics.threads += 1;
    }

    /// Incumbents that were not reported yet.
    pub(super) fn take_news(&self) -> Vec<Accepted> {
        std::mem::take(&mut self.lock().news)
    }

    /// The figures for a progress event, in the model's own sense.
    pub(super) fn progress(&self) -> Progress {
        let state = self.lock();
        let sign = self.task.program.sign;
        let counts = &state.statistics;
        let incumbent = state.points.incumbent();
        let mut progress = Progress::new(
            counts.nodes + state.elsewhere.nodes,
            self.open.load(Ordering::Relaxed) + state.elsewhere.open,
            counts.relaxations,
            incumbent.map(|best| sign * best.value),
            sign * bound(&state),
            self.task.token.elapsed(),
        );
        progress.constant = sign * self.task.program.constant;
        progress.depth = counts.depth;
        progress.iterations = counts.iterations;
        let rows = self.task.exact.map_or(usize::MAX, Program::row_count);
        progress.cuts = self.task.program.row_count().saturating_sub(rows);
        progress.explored = explored(&state);
        progress.found_by = incumbent.map(|best| best.found_by);
        progress
    }

    /// The answer, once all workers are done.
    pub(super) fn into_found(self) -> SearchResult {
        let state = self.state.into_inner().unwrap_or_else(PoisonError::into_inner);
        let is_contradicted = state.contradiction.is_some();
        let bound = if is_contradicted { f64::NEG_INFINITY } else { bound(&state) };
        let complete = state.queue.len() == 0
            && state.stalled == f64::INFINITY
            && state.elsewhere.floor == f64::INFINITY;
        let options = self.task.options;
        let best = state.points.incumbent().map(|best| best.value);
        let within_gap = best.is_some_and(|value| {
            value - bound <= options.allowed_gap(value, self.task.program.constant)
        });
        let termination = match state.stop {
            _ if is_contradicted => Termination::Stalled,
            Some(Termination::Unbounded) => Termination::Unbounded,
            _ if within_gap => Termination::Optimal,
            Some(reason) => reason,
            None if complete && best.is_none() && bound == f64::INFINITY => Termination::Infeasible,
            None => Termination::Stalled,
        };
        let unbounded = termination == Termination::Unbounded;
        let mut leaves = state.leaves;
        if options.parts().keep_leaves {
            leaves.extend(state.queue.iter().map(|node| (node.path.clone(), node.bound)));
        }
        SearchResult {
            termination,
            bound: if unbounded { f64::NEG_INFINITY } else { bound },
            contradiction: state.contradiction,
            is_widened: state.is_widened,
            pool_complete: complete && state.stop.is_none() && state.points.wants_all(),
            found_by: state.points.incumbent().map(|best| best.found_by),
            points: state.points.into_points().into_iter().map(|best| best.point).collect(),
            statistics: state.statistics,
            leaves: leaves.iter().map(|(path, bound)| ClosedNode::new(path, *bound)).collect(),
            duals: state.duals,
            splits: state.splits,
            strengthened: None,
            root_cuts: None,
            cone_cuts: Vec::new(),
            facets: None,
            completion: state.completion,
        }
    }
}

/// Whether a search should begin again because it has found rows that its program lacks. It goes on
/// for some nodes, whose points may show further rows.
fn has_enough_rows(state: &mut TreeState) -> bool {
    if state.statistics.excluded_by_rows == 0 {
        return false;
    }
    let nodes = state.statistics.nodes;
    let since = *state.rows_since.get_or_insert(nodes);
    nodes - since >= NODES_AFTER_ROWS.max(since / 2)
}

/// An estimate of the part of the tree that is done: after Knuth, "Estimating the efficiency of
/// backtrack programs", 1975, a node stands for the part that a walk to a random child at each
/// split finds it with. `None` if other processes hold nodes.
fn explored(state: &TreeState) -> Option<f64> {
    let Elsewhere { open, nodes, .. } = state.elsewhere;
    let is_whole = open == 0 && nodes == 0;
    let left = state.queue.share() + state.shares.iter().sum::<f64>();
    is_whole.then(|| (1.0 - left).clamp(0.0, 1.0))
}

/// The proved bound on the whole program.
fn bound(state: &TreeState) -> f64 {
    let busy = state.floors.iter().flatten().copied().fold(f64::INFINITY, f64::min);
    let open = state.queue.best_bound().min(busy).min(state.elsewhere.floor);
    let open = open.min(state.stalled).min(state.closed);
    // Nothing better than the incumbent is left when every open bound is above it.
    state.points.incumbent().map_or(open, |best| open.min(best.value))
}

/// The smallest possible difference of two objective values: the common divisor of integer
/// coefficients when only integral columns have a cost.
pub(crate) fn granularity(program: &Program) -> f64 {
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

impl Tree<'_> {
    /// An accepted point with the key that tells points apart: the integers of the user's model.
    /// The key is empty if one point is enough.
    pub(super) fn accepted(&self, value: f64, point: Vec<f64>, found_by: Heuristic) -> Accepted {
        let key = if self.task.options.pool > 1 { self.task.judge.key(&point) } else { Vec::new() };
        Accepted { value, key, point, found_by }
    }
}
