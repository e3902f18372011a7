//! The deterministic search: the same nodes, counts and answer for any number of threads.
//!
//! The search works in rounds. The number of workers is fixed, and larger than the number of
//! threads of most machines. In a round, each worker gets a node by a fixed rule and plunges from
//! there for a few nodes. It uses the cutoff that was known when the round began. Threads take
//! workers in any order. The results are merged in the order of the workers once all are done, so
//! nothing depends on which worker was faster.

#[cfg(not(target_family = "wasm"))]
use std::sync::atomic::AtomicUsize;
use std::sync::atomic::Ordering;
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::search::node::Node;
use crate::search::reporter::Reporter;
#[cfg(not(target_family = "wasm"))]
use crate::search::trace::Around;
use crate::search::tree::{Tree, TreeState};
use crate::search::tree_view::TreeView;
use crate::search::worker::Worker;

/// Workers of a round, whatever the number of threads.
pub(in crate::search) const WORKERS: usize = 8;

/// Most nodes of a worker in a round. More waste less time waiting for the slowest, fewer spread
/// news sooner.
const NODES_PER_ROUND: u64 = 4;

/// A worker between and in the rounds.
#[derive(Default)]
struct Slot<'a> {
    worker: Option<Worker<'a>>,
    /// The node to process in the present round, and the largest number of nodes to process from
    /// there.
    assignment: Option<(Node, u64)>,
    /// The node with which its plunge goes on.
    plunge: Option<Node>,
}

type Slots<'a> = Vec<Mutex<Slot<'a>>>;

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Searches until nothing is left or a limit is reached.
pub(in crate::search) fn run(tree: &Tree<'_>, reporter: &mut Reporter<'_, '_>) {
    let slots: Slots<'_> = (0..WORKERS).map(|_| Mutex::default()).collect();
    let run = |id: usize| process(&mut lock(&slots[id]), id, tree);
    let mut threads = 0;
    loop {
        let assigned = assign(tree, &slots);
        if assigned.is_empty() {
            break;
        }
        let wanted = tree.task.options.threads.min(assigned.len());
        (threads..wanted).for_each(|_| tree.count_thread());
        threads = threads.max(wanted);
        run_all(wanted, &assigned, &run);
        put_together(tree, &slots, &assigned);
        reporter.report(tree);
    }
}

/// Runs the workers with these numbers on so many threads, of which the caller's is one.
#[cfg(not(target_family = "wasm"))]
fn run_all(threads: usize, workers: &[usize], run: &(impl Fn(usize) + Sync)) {
    let next = &AtomicUsize::new(0);
    let work = move || {
        while let Some(&worker) = workers.get(next.fetch_add(1, Ordering::Relaxed)) {
            run(worker);
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..threads {
            let around = Around::current();
            scope.spawn(move || {
                let _inside = around.enter();
                work();
            });
        }
        work();
    });
}

/// Runs the workers with these numbers one after the other.
#[cfg(target_family = "wasm")]
fn run_all(_: usize, workers: &[usize], run: &(impl Fn(usize) + Sync)) {
    workers.iter().for_each(|&worker| run(worker));
}

/// Processes what a slot was assigned in a round.
fn process<'a>(slot: &mut Slot<'a>, id: usize, tree: &'a Tree<'a>) {
    let Some((node, nodes)) = slot.assignment.take() else { return };
    let worker = slot.worker.get_or_insert_with(|| {
        let mut worker = Worker::new(TreeView::in_rounds(tree, id));
        worker.pseudocosts().clone_from(&lock(&tree.pseudocosts));
        worker.pseudocosts().record();
        worker
    });
    worker.tree().start_round();
    worker.restart_clock();
    let mut next = Some(node);
    for _ in 0..nodes {
        let Some(node) = next.take() else { break };
        if let Some(reason) = tree.task.token.ended() {
            worker.tree().give_back(node, reason);
            break;
        }
        next = worker.process(node);
        if worker.tree().is_stopped() {
            break;
        }
    }
    slot.plunge = next;
}

/// Assigns the nodes of a round. Returns the slots that got one.
fn assign(tree: &Tree<'_>, slots: &Slots<'_>) -> Vec<usize> {
    let mut state = tree.lock();
    let go_on = tree.may_go_on(&mut state);
    let limit = tree.task.options.node_limit.unwrap_or(u64::MAX);
    let mut left = limit.saturating_sub(state.started);
    let mut assigned = Vec::new();
    for (id, slot) in slots.iter().enumerate() {
        let mut slot = lock(slot);
        let plunge = slot.plunge.take();
        if !go_on || left == 0 {
            plunge.into_iter().for_each(|node| state.queue.push(node));
            (state.floors[id], state.shares[id]) = (None, 0.0);
            continue;
        }
        let node = next_node(tree, &mut state, plunge);
        state.floors[id] = node.as_ref().map(|node| node.bound);
        state.shares[id] = node.as_ref().map_or(0.0, |node| node.share);
        if let Some(node) = node {
            tree.open.fetch_sub(1, Ordering::Relaxed);
            let nodes = NODES_PER_ROUND.min(left);
            left -= nodes;
            slot.assignment = Some((node, nodes));
            assigned.push(id);
        }
    }
    assigned
}

/// The node that a plunge goes on with, or else the best open one, if it is below the cutoff.
fn next_node(tree: &Tree<'_>, state: &mut TreeState, plunge: Option<Node>) -> Option<Node> {
    let mut node = plunge;
    loop {
        match node.take().or_else(|| state.queue.pop()) {
            Some(next) if next.bound >= tree.cutoff() => tree.close_unseen(state, next),
            next => return next,
        }
    }
}

/// Merges the finds of the workers, in their order.
fn put_together(tree: &Tree<'_>, slots: &Slots<'_>, assigned: &[usize]) {
    let mut state = tree.lock();
    let mut shared = lock(&tree.pseudocosts);
    for &id in assigned {
        let mut slot = lock(&slots[id]);
        let Slot { worker: Some(worker), plunge, .. } = &mut *slot else { continue };
        let report = worker.tree().take_report();
        state.started += report.statistics.nodes;
        tree.take_in(&mut state, report);
        let round = worker.tree().end_round();
        for accepted in round.points {
            tree.accept(&mut state, accepted);
        }
        for node in round.nodes {
            tree.push(&mut state, node);
        }
        if let Some(reason) = round.stop {
            state.stop.get_or_insert(reason);
        }
        worker.pseudocosts().tell(&mut shared);
        state.floors[id] = plunge.as_ref().map(|node| node.bound);
        state.shares[id] = plunge.as_ref().map_or(0.0, |node| node.share);
        if plunge.is_some() {
            tree.open.fetch_add(1, Ordering::Relaxed);
        }
    }
    for slot in slots {
        if let Some(worker) = &mut lock(slot).worker {
            worker.pseudocosts().learn_all(&shared);
        }
    }
}
