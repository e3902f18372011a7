//! Deterministic search: the same nodes, counts and answer for any number of threads.
//!
//! The search goes in rounds. A fixed number of workers, more than most machines have threads, each
//! get a node by a fixed rule and a few nodes of plunging from there, against the cutoff at the
//! start of the round. Threads take workers as they come; what the workers found is put together in
//! the order of the workers once all are done. So nothing depends on who was faster.

use std::sync::atomic::Ordering;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use super::Task;
use super::desk::Desk;
use super::node::Node;
use super::reporter::Watch;
use super::root::Root;
#[cfg(not(target_family = "wasm"))]
use super::trace::Around;
use super::tree::Tree;
use super::worker::Worker;

/// Workers of a round, whatever the number of threads.
pub(super) const WORKERS: usize = 8;

/// Most nodes of a worker in a round. More waste less time waiting for the slowest, fewer spread
/// news sooner.
const NODES: u64 = 4;

/// A worker between and in the rounds.
#[derive(Default)]
struct Seat<'a> {
    worker: Option<Worker<'a>>,
    /// What it is to process in the present round, and at most how many nodes from there.
    task: Option<(Node, u64)>,
    /// Where its plunge goes on.
    plunge: Option<Node>,
}

/// Threads that wait for work of a round.
#[derive(Default)]
struct Gang {
    state: Mutex<Work>,
    changed: Condvar,
}

#[derive(Default)]
struct Work {
    /// Seats that nobody has taken yet, the first one last.
    waiting: Vec<usize>,
    running: usize,
    over: bool,
}

impl Gang {
    fn lock(&self) -> MutexGuard<'_, Work> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn start(&self, mut seats: Vec<usize>) {
        seats.reverse();
        self.lock().waiting = seats;
        self.changed.notify_all();
    }

    /// A seat to work at; `None` when there is none, for a helper only at the end.
    fn take(&self, is_helper: bool) -> Option<usize> {
        let mut work = self.lock();
        loop {
            if let Some(seat) = work.waiting.pop() {
                work.running += 1;
                return Some(seat);
            }
            if work.over || !is_helper {
                return None;
            }
            work = self.changed.wait(work).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn wait_for_all(&self) {
        let mut work = self.lock();
        while work.running > 0 {
            work = self.changed.wait(work).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

/// Ends the work at a seat, also when it panics: nobody must wait for ever.
struct AtWork<'a>(&'a Gang);

impl Drop for AtWork<'_> {
    fn drop(&mut self) {
        self.0.lock().running -= 1;
        self.0.changed.notify_all();
    }
}

/// Ends the helpers, also when the caller's thread panics.
struct Over<'a>(&'a Gang);

impl Drop for Over<'_> {
    fn drop(&mut self) {
        self.0.lock().over = true;
        self.0.changed.notify_all();
    }
}

type Seats<'a> = Vec<Mutex<Seat<'a>>>;

fn at<'s, 'a>(seats: &'s Seats<'a>, index: usize) -> MutexGuard<'s, Seat<'a>> {
    seats[index].lock().unwrap_or_else(PoisonError::into_inner)
}

/// Searches until nothing is left or a limit is reached.
pub(super) fn run(task: Task<'_>, tree: &Tree<'_>, root: &Root, watch: &mut Watch<'_, '_>) {
    let seats: Seats<'_> = (0..WORKERS).map(|_| Mutex::default()).collect();
    let gang = Gang::default();
    let work = |seat: usize| {
        let _at_work = AtWork(&gang);
        process(&mut at(&seats, seat), seat, task, tree, root);
    };
    let helper = || {
        tree.count_thread();
        while let Some(seat) = gang.take(true) {
            work(seat);
        }
    };
    tree.count_thread();
    with_helpers(task.options.threads, &helper, |help| {
        let _over = Over(&gang);
        loop {
            let tasks = tree.plan(&seats);
            if tasks.is_empty() {
                break;
            }
            help(tasks.len() - 1);
            gang.start(tasks.clone());
            while let Some(seat) = gang.take(false) {
                work(seat);
            }
            gang.wait_for_all();
            tree.put_together(&seats, &tasks);
            watch.report(tree);
        }
    });
}

/// Runs `work` with a function that makes sure of so many helpers, as far as threads are allowed.
#[cfg(not(target_family = "wasm"))]
fn with_helpers(
    threads: usize,
    helper: &(dyn Fn() + Sync),
    work: impl FnOnce(&mut dyn FnMut(usize)),
) {
    std::thread::scope(|scope| {
        let mut helpers = 0;
        work(&mut |wanted| {
            while helpers < wanted.min(threads - 1) {
                helpers += 1;
                let around = Around::current();
                scope.spawn(move || {
                    let _inside = around.enter();
                    helper();
                });
            }
        });
    });
}

#[cfg(target_family = "wasm")]
fn with_helpers(_: usize, _: &(dyn Fn() + Sync), work: impl FnOnce(&mut dyn FnMut(usize))) {
    work(&mut |_| ());
}

/// Works at a seat for a round.
fn process<'a>(seat: &mut Seat<'a>, id: usize, task: Task<'a>, tree: &'a Tree<'a>, root: &'a Root) {
    let Some((node, nodes)) = seat.task.take() else { return };
    let worker = seat.worker.get_or_insert_with(|| {
        let mut worker = Worker::new(task, Desk::new(tree, id, None), root);
        worker.pseudocosts =
            tree.pseudocosts.lock().unwrap_or_else(PoisonError::into_inner).clone();
        worker.pseudocosts.record();
        worker
    });
    worker.tree.start_round();
    worker.restart_clock();
    let mut next = Some(node);
    for _ in 0..nodes {
        let Some(node) = next.take() else { break };
        if let Some(reason) = task.token.ended() {
            worker.tree.give_back(node, reason);
            break;
        }
        next = worker.process(node);
        if worker.tree.is_stopped() {
            break;
        }
    }
    seat.plunge = next;
}

impl Tree<'_> {
    /// Hands out the nodes of a round; the seats that got one.
    fn plan(&self, seats: &Seats<'_>) -> Vec<usize> {
        let mut state = self.lock();
        let go_on = self.may_go_on(&mut state);
        let limit = self.task.options.node_limit.unwrap_or(u64::MAX);
        let mut left = limit.saturating_sub(state.started);
        let (mut planned, cutoff) = (Vec::new(), self.cutoff());
        for (id, seat) in seats.iter().enumerate() {
            let mut seat = seat.lock().unwrap_or_else(PoisonError::into_inner);
            let mut node = seat.plunge.take();
            if !go_on || left == 0 {
                node.into_iter().for_each(|node| state.queue.push(node));
                state.floors[id] = None;
                continue;
            }
            loop {
                match node.or_else(|| state.queue.pop()) {
                    Some(next) if next.bound >= cutoff => {
                        self.close_unseen(&mut state, next);
                        node = None;
                    }
                    next => {
                        node = next;
                        break;
                    }
                }
            }
            state.floors[id] = node.as_ref().map(|node| node.bound);
            if let Some(node) = node {
                self.open.fetch_sub(1, Ordering::Relaxed);
                let nodes = NODES.min(left);
                left -= nodes;
                seat.task = Some((node, nodes));
                planned.push(id);
            }
        }
        planned
    }

    /// Puts together what the seats found, in their order.
    fn put_together(&self, seats: &Seats<'_>, worked: &[usize]) {
        let mut state = self.lock();
        let mut shared = self.pseudocosts.lock().unwrap_or_else(PoisonError::into_inner);
        for &id in worked {
            let mut seat = at(seats, id);
            let Some(worker) = &mut seat.worker else { continue };
            let share = worker.tree.take_share();
            state.started += share.statistics.nodes;
            self.take_in(&mut state, share);
            let round = worker.tree.end_round();
            for accepted in round.offered {
                self.accept(&mut state, accepted);
            }
            for mut node in round.pushed {
                node.serial = self.serial.fetch_add(1, Ordering::Relaxed);
                self.open.fetch_add(1, Ordering::Relaxed);
                state.queue.push(node);
            }
            if let Some(reason) = round.stop {
                state.stop.get_or_insert(reason);
            }
            worker.pseudocosts.tell(&mut shared);
            state.floors[id] = seat.plunge.as_ref().map(|node| node.bound);
            if seat.plunge.is_some() {
                self.open.fetch_add(1, Ordering::Relaxed);
            }
        }
        for seat in seats {
            let mut seat = seat.lock().unwrap_or_else(PoisonError::into_inner);
            if let Some(worker) = &mut seat.worker {
                worker.pseudocosts.learn_all(&shared);
            }
        }
    }
}
