//! The opportunistic search: one thread, or several that exchange everything at once.
//!
//! A worker plunges: it continues with one child and keeps the other in a local queue. Other
//! workers steal the oldest, which has the best bound of them, if it is better than all in the
//! common queue. When a plunge ends, the rest of the local queue goes to the common one, and the
//! best bound is next. Threads start only if nodes wait for them.

use std::sync::PoisonError;
use std::sync::atomic::{AtomicUsize, Ordering};

use crossbeam_deque::{Steal, Stealer, Worker as Deque};
use web_time::Duration;

use crate::search::local_queue::LocalQueue;
use crate::search::node::Node;
use crate::search::reporter::Reporter;
#[cfg(not(target_family = "wasm"))]
use crate::search::trace::Around;
use crate::search::tree::{State, Tree};
use crate::search::tree_view::TreeView;
use crate::search::worker::Worker;

/// The data that the workers of a search share about each other.
struct Peers {
    /// The thieves' ends of all local queues.
    stealers: Vec<Stealer<Node>>,
    /// How many workers have a thread, besides the caller's.
    helpers: AtomicUsize,
}

/// Searches until nothing is left or a limit is reached.
pub(in crate::search) fn run(tree: &Tree<'_>, reporter: &mut Reporter<'_, '_>) {
    let threads = tree.task.options.threads.max(1);
    let own = Deque::new_lifo();
    let others: Vec<Deque<Node>> = (1..threads).map(|_| Deque::new_lifo()).collect();
    let stealers = std::iter::once(&own).chain(&others).map(Deque::stealer).collect();
    let peers = &Peers { stealers, helpers: AtomicUsize::new(0) };
    let worker = Worker::new(TreeView::immediate(tree, 0, LocalQueue::new(own)));
    with_helpers(tree, peers, others, |start_helper| {
        work(worker, peers, Some(reporter), start_helper);
    });
}

#[cfg(not(target_family = "wasm"))]
fn with_helpers(
    tree: &Tree<'_>,
    peers: &Peers,
    queues: Vec<Deque<Node>>,
    work_here: impl FnOnce(&mut dyn FnMut()),
) {
    let mut queues = queues.into_iter();
    std::thread::scope(|scope| {
        work_here(&mut || {
            let Some(own) = queues.next() else { return };
            let id = peers.helpers.fetch_add(1, Ordering::Relaxed) + 1;
            let around = Around::current();
            scope.spawn(move || {
                let _inside = around.enter();
                let view = TreeView::immediate(tree, id, LocalQueue::new(own));
                work(Worker::new(view), peers, None, &mut || ());
            });
        });
    });
}

#[cfg(target_family = "wasm")]
fn with_helpers(
    _: &Tree<'_>,
    _: &Peers,
    _: Vec<Deque<Node>>,
    work_here: impl FnOnce(&mut dyn FnMut()),
) {
    work_here(&mut || ());
}

/// Processes nodes until the tree is done. The worker on the caller's thread reports, and starts
/// helpers when there is work for them.
fn work(
    mut worker: Worker<'_>,
    peers: &Peers,
    mut reporter: Option<&mut Reporter<'_, '_>>,
    start_helper: &mut dyn FnMut(),
) {
    let tree = worker.tree().tree;
    tree.count_thread();
    let threads = peers.stealers.len();
    if threads > 1 {
        worker.pseudocosts().record();
    }
    let mut plunge: Option<Node> = None;
    loop {
        let node = match plunge.take() {
            Some(child) => go_on(tree, worker.tree(), child),
            None => next(tree, worker.tree(), peers),
        };
        let Some(node) = node else { break };
        plunge = worker.process(node);
        if threads > 1 {
            exchange(tree, &mut worker);
            let helpers = peers.helpers.load(Ordering::Relaxed);
            if helpers + 1 < threads && tree.open.load(Ordering::Relaxed) > helpers + 1 {
                start_helper();
            }
        }
        if let Some(reporter) = &mut reporter {
            let mut state = tree.lock();
            let view = worker.tree();
            tree.take_in(&mut state, view.take_share());
            let bound = plunge.as_ref().map_or(f64::INFINITY, |child| child.bound);
            state.floors[view.id] = Some(view.floor(bound));
            drop(state);
            reporter.report(tree);
        }
    }
    tree.take_in(&mut tree.lock(), worker.tree().take_share());
    worker.retire();
}

/// Tells the other workers what one learned about columns, and lets it learn from them.
fn exchange(tree: &Tree<'_>, worker: &mut Worker<'_>) {
    let mut shared = tree.pseudocosts.lock().unwrap_or_else(PoisonError::into_inner);
    worker.pseudocosts().tell(&mut shared);
    worker.pseudocosts().learn_all(&shared);
}

/// Lets a worker go on with a child of its node, unless the search has ended. Then the child is
/// queued, so that the bound still counts it.
fn go_on(tree: &Tree<'_>, view: &TreeView<'_>, node: Node) -> Option<Node> {
    let mut state = tree.lock();
    tree.take_in(&mut state, view.take_share());
    if tree.may_go_on(&mut state) {
        state.started += 1;
        state.floors[view.id] = Some(view.floor(node.bound));
        return Some(node);
    }
    view.push(node);
    leave(tree, &mut state, view);
    None
}

/// The next node for a worker: waits while others may still produce some; `None` at the end.
fn next(tree: &Tree<'_>, view: &TreeView<'_>, peers: &Peers) -> Option<Node> {
    let mut state = tree.lock();
    tree.take_in(&mut state, view.take_share());
    loop {
        let mut next = None;
        if tree.is_short_of_memory(&state) {
            next = view.pop_own();
        }
        if next.is_none() {
            leave(tree, &mut state, view);
        }
        if !tree.may_go_on(&mut state) {
            next.into_iter().for_each(|node| state.queue.push(node));
            leave(tree, &mut state, view);
            return None;
        }
        match next.or_else(|| best_of(&mut state, view, peers)) {
            Some(node) if node.bound >= tree.cutoff() => tree.close_unseen(&mut state, node),
            Some(node) => {
                tree.open.fetch_sub(1, Ordering::Relaxed);
                state.started += 1;
                state.floors[view.id] = Some(view.floor(node.bound));
                return Some(node);
            }
            None if state.floors.iter().all(Option::is_none) => {
                tree.wake.notify_all();
                return None;
            }
            None => {
                tree.idle.fetch_add(1, Ordering::Relaxed);
                let wait = Duration::from_millis(5);
                let waited = tree.wake.wait_timeout(state, wait);
                state = waited.unwrap_or_else(PoisonError::into_inner).0;
                tree.idle.fetch_sub(1, Ordering::Relaxed);
            }
        }
    }
}

/// Moves what a worker has left of its plunge to the common queue.
fn leave(tree: &Tree<'_>, state: &mut State, view: &TreeView<'_>) {
    std::iter::from_fn(|| view.pop_own()).for_each(|node| state.queue.push(node));
    if state.floors[view.id].take().is_some() {
        tree.wake.notify_all();
    }
}

/// The best node there is: from the queue, or the oldest one of a worker whose bound is better.
fn best_of(state: &mut State, view: &TreeView<'_>, peers: &Peers) -> Option<Node> {
    let queued = state.queue.best_bound();
    let mut victims: Vec<(f64, usize)> = (0..peers.stealers.len())
        .filter(|&id| id != view.id && !peers.stealers[id].is_empty())
        .filter_map(|id| Some((state.floors[id]?, id)))
        .filter(|&(floor, _)| floor < queued)
        .collect();
    victims.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    for (_, id) in victims {
        loop {
            match peers.stealers[id].steal() {
                Steal::Success(node) => return Some(node),
                Steal::Retry => {}
                Steal::Empty => break,
            }
        }
    }
    state.queue.pop()
}
