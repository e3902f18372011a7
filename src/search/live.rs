//! Searching on one thread, or on several that exchange everything at once (opportunistically).
//!
//! A worker plunges: it goes on with one child and keeps the other in a deque of its own. Thieves take
//! the oldest, which has the best bound of them, when it is better than all that is queued. When a
//! plunge ends, what is left of the deque goes to the common queue, and the best bound is next.
//! Helpers start only when nodes wait for them.

use std::sync::PoisonError;
use std::sync::atomic::{AtomicUsize, Ordering};

use crossbeam_deque::{Steal, Stealer, Worker as Deque};
use web_time::Duration;

use super::Task;
use super::desk::Desk;
use super::node::Node;
use super::reporter::Watch;
use super::root::Root;
#[cfg(not(target_family = "wasm"))]
use super::trace::Around;
use super::tree::{State, Tree};
use super::worker::Worker;

/// The deques of all workers, and how many of them have a thread.
struct Crew {
    stealers: Vec<Stealer<Node>>,
    helpers: AtomicUsize,
}

/// Searches until nothing is left or a limit is reached.
pub(super) fn run(task: Task<'_>, tree: &Tree<'_>, root: &Root, watch: &mut Watch<'_, '_>) {
    let mut deques: Vec<Deque<Node>> =
        (0..task.options.threads).map(|_| Deque::new_lifo()).collect();
    let stealers = deques.iter().map(Deque::stealer).collect();
    let crew = &Crew { stealers, helpers: AtomicUsize::new(0) };
    deques.reverse();
    let own = deques.pop();
    let worker = Worker::new(task, Desk::new(tree, 0, own), root);
    with_helpers(task, tree, root, crew, deques, |spawn| {
        worker.run_live(crew, Some(watch), spawn);
    });
}

#[cfg(not(target_family = "wasm"))]
fn with_helpers(
    task: Task<'_>,
    tree: &Tree<'_>,
    root: &Root,
    crew: &Crew,
    mut deques: Vec<Deque<Node>>,
    work: impl FnOnce(&mut dyn FnMut()),
) {
    std::thread::scope(|scope| {
        work(&mut || {
            let Some(own) = deques.pop() else { return };
            let id = crew.helpers.fetch_add(1, Ordering::Relaxed) + 1;
            let around = Around::current();
            scope.spawn(move || {
                let _inside = around.enter();
                let worker = Worker::new(task, Desk::new(tree, id, Some(own)), root);
                worker.run_live(crew, None, &mut || ());
            });
        });
    });
}

#[cfg(target_family = "wasm")]
fn with_helpers(
    _: Task<'_>,
    _: &Tree<'_>,
    _: &Root,
    _: &Crew,
    _: Vec<Deque<Node>>,
    work: impl FnOnce(&mut dyn FnMut()),
) {
    work(&mut || ());
}

impl Worker<'_> {
    /// Processes nodes until the tree is done; the worker on the caller's thread reports, and starts
    /// helpers when there is work for them.
    fn run_live(
        mut self,
        crew: &Crew,
        mut watch: Option<&mut Watch<'_, '_>>,
        spawn: &mut dyn FnMut(),
    ) {
        let tree = self.tree.tree;
        tree.count_thread();
        let threads = crew.stealers.len();
        if threads > 1 {
            self.pseudocosts.record();
        }
        let mut plunge: Option<Node> = None;
        loop {
            let node = match plunge.take() {
                Some(child) => tree.go_on(&self.tree, child),
                None => tree.next(&self.tree, crew),
            };
            let Some(node) = node else { break };
            plunge = self.process(node);
            if threads > 1 {
                self.exchange();
                let helpers = crew.helpers.load(Ordering::Relaxed);
                if helpers + 1 < threads && tree.open.load(Ordering::Relaxed) > helpers + 1 {
                    spawn();
                }
            }
            if let Some(watch) = &mut watch {
                let mut state = tree.lock();
                tree.take_in(&mut state, self.tree.take_share());
                let bound = plunge.as_ref().map_or(f64::INFINITY, |child| child.bound);
                state.floors[self.tree.id] = Some(self.tree.floor(bound));
                drop(state);
                watch.report(tree);
            }
        }
        tree.take_in(&mut tree.lock(), self.tree.take_share());
    }

    /// Tells the other workers what this one learned about columns, and learns from them.
    fn exchange(&mut self) {
        let shared = &self.tree.tree.pseudocosts;
        let mut shared = shared.lock().unwrap_or_else(PoisonError::into_inner);
        self.pseudocosts.tell(&mut shared);
        self.pseudocosts.learn_all(&shared);
    }
}

impl Tree<'_> {
    /// A worker goes on with a child of its node, unless the search has ended; then the child is
    /// queued, so that the bound still counts it.
    fn go_on(&self, desk: &Desk<'_>, node: Node) -> Option<Node> {
        let mut state = self.lock();
        self.take_in(&mut state, desk.take_share());
        if self.may_go_on(&mut state) {
            state.started += 1;
            state.floors[desk.id] = Some(desk.floor(node.bound));
            return Some(node);
        }
        desk.push(node);
        self.leave(&mut state, desk);
        None
    }

    /// Next node for a worker: waits while others may still produce some; `None` at the end.
    fn next(&self, desk: &Desk<'_>, crew: &Crew) -> Option<Node> {
        let mut state = self.lock();
        self.take_in(&mut state, desk.take_share());
        loop {
            let mut next = None;
            if self.is_short_of_memory(&state) {
                next = desk.own.as_ref().and_then(Deque::pop);
            }
            if next.is_none() {
                self.leave(&mut state, desk);
            }
            if !self.may_go_on(&mut state) {
                next.into_iter().for_each(|node| state.queue.push(node));
                self.leave(&mut state, desk);
                return None;
            }
            match next.or_else(|| self.best_of(&mut state, desk, crew)) {
                Some(node) if node.bound >= self.cutoff() => self.close_unseen(&mut state, node),
                Some(node) => {
                    self.open.fetch_sub(1, Ordering::Relaxed);
                    state.started += 1;
                    state.floors[desk.id] = Some(desk.floor(node.bound));
                    return Some(node);
                }
                None if state.floors.iter().all(Option::is_none) => {
                    self.wake.notify_all();
                    return None;
                }
                None => {
                    self.idle.fetch_add(1, Ordering::Relaxed);
                    let wait = Duration::from_millis(5);
                    let waited = self.wake.wait_timeout(state, wait);
                    state = waited.unwrap_or_else(PoisonError::into_inner).0;
                    self.idle.fetch_sub(1, Ordering::Relaxed);
                }
            }
        }
    }

    /// What a worker has left of its plunge goes to the common queue.
    fn leave(&self, state: &mut State, desk: &Desk<'_>) {
        let own = desk.own.iter().flat_map(|own| std::iter::from_fn(|| own.pop()));
        own.for_each(|node| state.queue.push(node));
        if state.floors[desk.id].take().is_some() {
            self.wake.notify_all();
        }
    }

    /// The best node there is: from the queue, or the oldest one of a worker whose bound is better.
    fn best_of(&self, state: &mut State, desk: &Desk<'_>, crew: &Crew) -> Option<Node> {
        let queued = state.queue.best_bound();
        let mut victims: Vec<(f64, usize)> = (0..crew.stealers.len())
            .filter(|&id| id != desk.id && !crew.stealers[id].is_empty())
            .filter_map(|id| Some((state.floors[id]?, id)))
            .filter(|&(floor, _)| floor < queued)
            .collect();
        victims.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (_, id) in victims {
            loop {
                match crew.stealers[id].steal() {
                    Steal::Success(node) => return Some(node),
                    Steal::Retry => {}
                    Steal::Empty => break,
                }
            }
        }
        state.queue.pop()
    }
}
