//! One worker's view of the tree.
//!
//! In the opportunistic search (and on one thread) a worker sees the current cutoff, and others can
//! take its new nodes at once. In the deterministic search it sees the cutoff at the start of the
//! round, and keeps what it finds until the round ends.

use std::cell::{Cell, RefCell};
use std::sync::Arc;
use std::sync::atomic::Ordering;

use web_time::Instant;

use super::best_points::Accepted;
use super::comparison::{Contradiction, is_excluded};
use super::node::{Decision, Node, Path};
use super::saved_tree::{SavedDuals, SavedSplit, SavedTree};
use super::start::{Completion, Start};
use super::tree::{Tree, WorkerReport};
use crate::relaxation::WarmState;
use crate::solution::{Heuristic, Statistics, Termination};

/// Number of open nodes from which on new nodes keep no relaxed point and no state, and the numbers
/// that all of them may keep if that allows for more nodes.
const MOST_NODES_WITH_POINTS: usize = 1000;
const MOST_KEPT_NUMBERS: usize = 1 << 24;

/// One worker's view of the tree.
pub(super) struct TreeView<'a> {
    pub(super) tree: &'a Tree<'a>,
    pub(super) id: usize,
    exchange: Exchange,
    report: RefCell<WorkerReport>,
    found_by: Cell<Heuristic>,
    /// The last point that the integers of the start led to.
    last_found: RefCell<Option<Vec<f64>>>,
}

/// The way in which cutoffs, nodes and points pass between a worker and the tree.
enum Exchange {
    /// At once: the opportunistic search.
    Immediate,
    /// Between rounds: the deterministic search.
    InRounds(RefCell<RoundBuffer>),
}

/// The cutoff that a worker of the deterministic search sees in a round, and what it keeps back
/// until the end of the round.
#[derive(Default)]
pub(super) struct RoundBuffer {
    /// The cutoff at the start, lowered by the worker's own points.
    cutoff: f64,
    /// New open nodes.
    pub(super) nodes: Vec<Node>,
    /// Verified points.
    pub(super) points: Vec<Accepted>,
    /// The reason for which the worker ends the search.
    pub(super) stop: Option<Termination>,
}

/// A running heuristic, to which points are attributed.
pub(super) struct HeuristicRun {
    before: Heuristic,
    /// Relaxations before.
    relaxations: u64,
    since: Instant,
}

impl<'a> TreeView<'a> {
    /// For a worker that exchanges everything at once.
    pub(super) fn immediate(tree: &'a Tree<'a>, id: usize) -> Self {
        TreeView::new(tree, id, Exchange::Immediate)
    }

    /// For a worker that exchanges everything between rounds.
    pub(super) fn in_rounds(tree: &'a Tree<'a>, id: usize) -> Self {
        TreeView::new(tree, id, Exchange::InRounds(RefCell::default()))
    }

    fn new(tree: &'a Tree<'a>, id: usize, exchange: Exchange) -> Self {
        TreeView {
            tree,
            id,
            exchange,
            report: RefCell::default(),
            found_by: Cell::new(Heuristic::Leaf),
            last_found: RefCell::default(),
        }
    }

    /// The number of workers.
    pub(super) fn workers(&self) -> usize {
        self.tree.lock().floors.len()
    }

    /// Rounds a bound up to the next value that the objective can take.
    pub(super) fn strengthen(&self, bound: f64) -> f64 {
        self.tree.strengthen(bound)
    }

    pub(super) fn path_with(&self, path: &Path, decisions: &[Decision]) -> Path {
        let step = |path: Path, decision| path.then(decision, &self.tree.steps);
        decisions.iter().fold(path.clone(), step)
    }

    pub(super) fn start(&self) -> Option<&'a Start> {
        self.tree.start
    }

    /// Nodes with at least this bound cannot improve the best points.
    pub(super) fn cutoff(&self) -> f64 {
        match &self.exchange {
            Exchange::Immediate => self.tree.cutoff(),
            Exchange::InRounds(round) => round.borrow().cutoff,
        }
    }

    /// Whether open nodes may hold more than their path: not where memory is counted, or nodes are
    /// many.
    pub(super) fn has_room(&self) -> bool {
        let program = self.tree.task.program;
        let size = program.column_count() + 2 * program.row_count();
        let most = MOST_NODES_WITH_POINTS.max(MOST_KEPT_NUMBERS / size.max(1));
        let few = self.tree.open.load(Ordering::Relaxed) < most;
        few && self.tree.task.options.memory_limit.is_none()
    }

    /// The state left by the root's relaxation, if it was kept.
    pub(super) fn root_state(&self) -> Option<WarmState> {
        self.tree.root_state.get().cloned()
    }

    /// Keeps the state left by the root's relaxation.
    pub(super) fn keep_root_state(&self, state: &WarmState) {
        // A root that is relaxed again leaves no better one.
        let _ = self.tree.root_state.set(state.clone());
    }

    /// The best point and its value, in rounds that of the round's start.
    pub(super) fn incumbent(&self) -> Option<(f64, Vec<f64>)> {
        self.tree.incumbent()
    }

    /// The value of the best point with a key, in rounds of those before and this worker's own.
    pub(super) fn value_of(&self, key: &[i64]) -> Option<f64> {
        let own = match &self.exchange {
            Exchange::Immediate => None,
            Exchange::InRounds(round) => {
                let round = round.borrow();
                let same = round.points.iter().filter(|point| point.key == key);
                same.map(|point| point.value).reduce(f64::min)
            }
        };
        self.tree.value_of(key).into_iter().chain(own).reduce(f64::min)
    }

    /// Memory that a search inside this one may take, if there is a limit.
    pub(super) fn memory_left(&self) -> Option<u64> {
        self.tree.memory_left()
    }

    /// Adds an open node.
    pub(super) fn push(&self, node: Node) {
        match &self.exchange {
            Exchange::InRounds(round) => round.borrow_mut().nodes.push(node),
            Exchange::Immediate => {
                self.tree.push(&mut self.tree.lock(), node);
                if self.tree.idle.load(Ordering::Relaxed) > 0 {
                    self.tree.wake.notify_one();
                }
            }
        }
    }

    /// Attributes points to this source until [`end`](Self::end) is called with the returned state.
    pub(super) fn begin(&self, source: Heuristic) -> HeuristicRun {
        self.count(|s| s.heuristics.of_mut(source).calls += 1);
        let relaxations = self.report.borrow().statistics.relaxations;
        HeuristicRun { before: self.found_by.replace(source), relaxations, since: Instant::now() }
    }

    /// Goes back to the source before.
    pub(super) fn end(&self, begun: HeuristicRun) {
        let source = self.found_by.replace(begun.before);
        self.count(|s| {
            let taken = s.relaxations - begun.relaxations;
            let count = s.heuristics.of_mut(source);
            count.relaxations += taken;
            count.time += begun.since.elapsed();
        });
    }

    /// Offers a verified point; `true` when it is the best this worker knows.
    pub(super) fn offer(&self, objective: f64, point: Vec<f64>) -> bool {
        let found_by = self.found_by.get();
        self.count(|s| s.heuristics.of_mut(found_by).points += 1);
        if found_by == Heuristic::Start {
            self.last_found.replace(Some(point.clone()));
        }
        let accepted = self.tree.accepted(objective, point, found_by);
        let mut round = match &self.exchange {
            Exchange::Immediate => return self.tree.accept(&mut self.tree.lock(), accepted),
            Exchange::InRounds(round) => round.borrow_mut(),
        };
        let cutoff = self.tree.cutoff_at(objective);
        let better = cutoff < round.cutoff;
        // If a pool is searched for, how many points are better is known at the end of the round.
        if self.tree.task.options.pool <= 1 && better {
            round.cutoff = cutoff;
        }
        round.points.push(accepted);
        better
    }

    /// The last point that the integers of the start led to.
    pub(super) fn take_last_found(&self) -> Option<Vec<f64>> {
        self.last_found.take()
    }

    pub(super) fn has_last_found(&self) -> bool {
        self.last_found.borrow().is_some()
    }

    /// Notes the outcome of completing the integers of the start.
    pub(super) fn report_completion(&self, completion: Completion) {
        self.tree.lock().completion = Some(completion);
    }

    /// Ends the search, because an accepted point is beyond a cut of a node, unless the exact
    /// program excludes that point, too.
    pub(super) fn note_wrong_cut(&self, point: &[f64]) {
        let exact = self.tree.task.exact.unwrap_or(self.tree.task.program);
        if !is_excluded(exact, point) {
            self.tree.contradict(&mut self.tree.lock(), Contradiction::NodeCut);
        }
    }

    /// Notes that a visible part of the value of a point is due to limits that presolve has
    /// widened.
    pub(super) fn note_widened(&self) {
        self.tree.lock().is_widened = true;
    }

    /// Notes the bound of a subtree that is closed without being infeasible.
    pub(super) fn close(&self, bound: f64) {
        let mut report = self.report.borrow_mut();
        report.closed = Some(report.closed.map_or(bound, |old| old.min(bound)));
    }

    /// Notes the bound of a subtree that could be neither finished nor split.
    pub(super) fn stall(&self, bound: f64) {
        let mut report = self.report.borrow_mut();
        report.stalled = Some(report.stalled.map_or(bound, |old| old.min(bound)));
    }

    /// Keeps an end of the tree, if they are asked for.
    pub(super) fn keep_leaf(&self, path: &Path, bound: f64) {
        if self.tree.task.options.parts().keep_leaves {
            self.report.borrow_mut().leaves.push((path.clone(), bound));
        }
    }

    /// The tree of an earlier solve; `None` if the tree of this search need not be kept either.
    pub(super) fn saved_tree(&self) -> Option<Arc<SavedTree>> {
        self.tree.start.and_then(|start| start.saved_tree.clone())
    }

    /// Whether the multipliers that close nodes are kept.
    pub(super) fn keeps_duals(&self) -> bool {
        self.tree.start.is_some_and(|start| start.saved_tree.is_some())
    }

    /// Keeps the multipliers that closed a node, if there is room.
    pub(super) fn keep_duals(&self, duals: impl FnOnce() -> SavedDuals) {
        if self.tree.has_room_for_duals() {
            self.report.borrow_mut().duals.push(duals());
        }
    }

    /// Keeps the split of a node, if there is room.
    pub(super) fn keep_split(&self, split: impl FnOnce() -> SavedSplit) {
        let options = self.tree.task.options;
        let is_small = || self.tree.ids.load(Ordering::Relaxed) < SavedSplit::MOST_NODES;
        let is_kept = self.keeps_duals() && options.memory_limit.is_none() && is_small();
        if is_kept || options.proof_path().is_some() {
            self.report.borrow_mut().splits.push(split());
        }
    }

    /// A name for a node.
    pub(super) fn new_id(&self) -> u32 {
        self.tree.ids.fetch_add(1, Ordering::Relaxed)
    }

    pub(super) fn count(&self, update: impl FnOnce(&mut Statistics)) {
        update(&mut self.report.borrow_mut().statistics);
    }

    /// Takes the finds since the last call.
    pub(super) fn take_report(&self) -> WorkerReport {
        self.report.take()
    }

    /// Starts a round at the tree's present cutoff.
    pub(super) fn start_round(&self) {
        if let Exchange::InRounds(round) = &self.exchange {
            round.borrow_mut().cutoff = self.tree.cutoff();
        }
    }

    /// Takes what a round kept back; empty if the search does not run in rounds.
    pub(super) fn end_round(&self) -> RoundBuffer {
        match &self.exchange {
            Exchange::Immediate => RoundBuffer::default(),
            Exchange::InRounds(round) => round.take(),
        }
    }

    /// Ends the search.
    pub(super) fn stop(&self, reason: Termination) {
        match &self.exchange {
            Exchange::Immediate => self.tree.stop(reason),
            Exchange::InRounds(round) => _ = round.borrow_mut().stop.get_or_insert(reason),
        }
    }

    /// Gives a node back unfinished and ends the search.
    pub(super) fn give_back(&self, node: Node, reason: Termination) {
        self.push(node);
        self.stop(reason);
    }

    /// Whether this worker has ended the search in the present round.
    pub(super) fn is_stopped(&self) -> bool {
        match &self.exchange {
            Exchange::Immediate => false,
            Exchange::InRounds(round) => round.borrow().stop.is_some(),
        }
    }
}
