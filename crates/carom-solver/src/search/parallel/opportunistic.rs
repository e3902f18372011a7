//! The opportunistic search: one thread, or several that exchange everything at once.
//!
//! A worker plunges: it goes on with one child and leaves the others to the common queue. When a
//! plunge ends, the best node of the queue is next. Threads start only if nodes wait for them.

use std::sync::PoisonError;
use std::sync::atomic::{AtomicUsize, Ordering};

use web_time::Duration;

use crate::search::node::Node;
use crate::search::reporter::Reporter;
use crate::search::shared_tree;
#[cfg(not(target_family = "wasm"))]
use crate::search::trace::Around;
use crate::search::tree::{Tree, TreeState};
use crate::search::tree_view::TreeView;
use crate::search::worker::Worker;

/// Searches until nothing is left or a limit is reached.
pub(in crate::search) fn run(tree: &Tree<'_>, reporter: &mut Reporter<'_, '_>) {
    let helpers = &AtomicUsize::new(0);
    let worker = Worker::new(TreeView::immediate(tree, 0));
    with_helpers(tree, helpers, |start_helper| {
        work(worker, helpers, Some(reporter), start_helper);
    });
}

/// Calls `work_here` with a function that starts a helper.
///
/// # Arguments
///
/// * `helpers`: the number of workers that have a thread, besides the caller's.
#[cfg(not(target_family = "wasm"))]
fn with_helpers(tree: &Tree<'_>, helpers: &AtomicUsize, work_here: impl FnOnce(&mut dyn FnMut())) {
    std::thread::scope(|scope| {
        work_here(&mut || {
            let id = helpers.fetch_add(1, Ordering::Relaxed) + 1;
            let around = Around::current();
            scope.spawn(move || {
                let _inside = around.enter();
                work(Worker::new(TreeView::immediate(tree, id)), helpers, None, &mut || ());
            });
        });
    });
}

#[cfg(target_family = "wasm")]
fn with_helpers(_: &Tree<'_>, _: &AtomicUsize, work_here: impl FnOnce(&mut dyn FnMut())) {
    work_here(&mut || ());
}

/// Processes nodes until the tree is done. The worker on the caller's thread reports, and starts
/// helpers when there is work for them.
fn work(
    mut worker: Worker<'_>,
    helpers: &AtomicUsize,
    mut reporter: Option<&mut Reporter<'_, '_>>,
    start_helper: &mut dyn FnMut(),
) {
    let tree = worker.tree().tree;
    tree.count_thread();
    let threads = if cfg!(target_family = "wasm") { 1 } else { tree.task.options.threads };
    if threads > 1 {
        worker.pseudocosts().record();
    }
    let mut plunge: Option<Node> = None;
    loop {
        let node = match plunge.take() {
            Some(child) => go_on(tree, worker.tree(), child),
            None => next(tree, worker.tree()),
        };
        let node = match (node, &mut reporter) {
            (None, Some(reporter)) if reporter.exchange.is_some() => {
                shared_tree::wait(tree, reporter, worker.tree(), next)
            }
            (node, _) => node,
        };
        let Some(node) = node else { break };
        plunge = worker.process(node);
        if threads > 1 {
            exchange(tree, &mut worker);
            let busy = helpers.load(Ordering::Relaxed) + 1;
            if busy < threads && tree.open.load(Ordering::Relaxed) > busy {
                start_helper();
            }
        }
        if let Some(reporter) = &mut reporter {
            let mut state = tree.lock();
            let view = worker.tree();
            tree.take_in(&mut state, view.take_report());
            let bound = plunge.as_ref().map_or(f64::INFINITY, |child| child.bound);
            state.floors[view.id] = Some(bound);
            state.shares[view.id] = plunge.as_ref().map_or(0.0, |child| child.share);
            drop(state);
            reporter.report(tree);
            shared_tree::meet(tree, reporter, worker.tree(), &mut plunge);
        }
    }
    tree.take_in(&mut tree.lock(), worker.tree().take_report());
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
    tree.take_in(&mut state, view.take_report());
    if tree.may_go_on(&mut state) {
        state.started += 1;
        (state.floors[view.id], state.shares[view.id]) = (Some(node.bound), node.share);
        return Some(node);
    }
    tree.push(&mut state, node);
    leave(tree, &mut state, view);
    None
}

/// The next node for a worker: waits while others may still produce some; `None` at the end.
fn next(tree: &Tree<'_>, view: &TreeView<'_>) -> Option<Node> {
    let mut state = tree.lock();
    tree.take_in(&mut state, view.take_report());
    leave(tree, &mut state, view);
    loop {
        if !tree.may_go_on(&mut state) {
            return None;
        }
        match tree.pop(&mut state) {
            Some(node) if node.bound >= tree.cutoff() => tree.close_unseen(&mut state, node),
            Some(node) => {
                tree.open.fetch_sub(1, Ordering::Relaxed);
                state.started += 1;
                (state.floors[view.id], state.shares[view.id]) = (Some(node.bound), node.share);
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

/// Notes that a worker has nothing at hand.
fn leave(tree: &Tree<'_>, state: &mut TreeState, view: &TreeView<'_>) {
    state.shares[view.id] = 0.0;
    if state.floors[view.id].take().is_some() {
        tree.wake.notify_all();
    }
}
