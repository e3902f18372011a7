//! Threads that take the tasks of a round as they come.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

#[cfg(not(target_family = "wasm"))]
use crate::search::trace::Around;

/// Threads that wait for the tasks of a round. A task is a number.
#[derive(Default)]
pub(super) struct WorkerPool {
    state: Mutex<Tasks>,
    changed: Condvar,
}

#[derive(Default)]
struct Tasks {
    /// Tasks that no thread has taken yet, the first one last.
    waiting: Vec<usize>,
    running: usize,
    over: bool,
}

impl WorkerPool {
    fn lock(&self) -> MutexGuard<'_, Tasks> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Runs tasks on this thread and the helpers, and waits for all of them.
    pub(super) fn run(&self, mut tasks: Vec<usize>, run: &impl Fn(usize)) {
        tasks.reverse();
        self.lock().waiting = tasks;
        self.changed.notify_all();
        while let Some(task) = self.take(false) {
            self.run_one(task, run);
        }
        let mut tasks = self.lock();
        while tasks.running > 0 {
            tasks = self.changed.wait(tasks).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Runs tasks until the pool ends.
    #[cfg(not(target_family = "wasm"))]
    fn help(&self, run: &impl Fn(usize)) {
        while let Some(task) = self.take(true) {
            self.run_one(task, run);
        }
    }

    fn run_one(&self, task: usize, run: &impl Fn(usize)) {
        let _running = Running(self);
        run(task);
    }

    /// A task to run; `None` if there is none, for a helper only at the end.
    fn take(&self, is_helper: bool) -> Option<usize> {
        let mut tasks = self.lock();
        loop {
            if let Some(task) = tasks.waiting.pop() {
                tasks.running += 1;
                return Some(task);
            }
            if tasks.over || !is_helper {
                return None;
            }
            tasks = self.changed.wait(tasks).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

/// Ends a task, also if it panics, because others wait for it.
struct Running<'a>(&'a WorkerPool);

impl Drop for Running<'_> {
    fn drop(&mut self) {
        self.0.lock().running -= 1;
        self.0.changed.notify_all();
    }
}

/// Ends the helpers, also if the caller's thread panics.
struct Shutdown<'a>(&'a WorkerPool);

impl Drop for Shutdown<'_> {
    fn drop(&mut self) {
        self.0.lock().over = true;
        self.0.changed.notify_all();
    }
}

/// Calls `work` with a pool, and with a function that makes sure of so many helpers, as far as
/// threads are allowed.
///
/// # Arguments
///
/// * `begin`: is called on each helper when it starts.
/// * `run`: runs a task.
#[cfg(not(target_family = "wasm"))]
pub(super) fn with_pool(
    threads: usize,
    begin: &(impl Fn() + Sync),
    run: &(impl Fn(usize) + Sync),
    work: impl FnOnce(&WorkerPool, &mut dyn FnMut(usize)),
) {
    let pool = &WorkerPool::default();
    std::thread::scope(|scope| {
        let _shutdown = Shutdown(pool);
        let mut helpers = 0;
        work(pool, &mut |wanted| {
            while helpers < wanted.min(threads - 1) {
                helpers += 1;
                let around = Around::current();
                scope.spawn(move || {
                    let _inside = around.enter();
                    begin();
                    pool.help(run);
                });
            }
        });
    });
}

/// Calls `work` with a pool of the caller's thread alone.
#[cfg(target_family = "wasm")]
pub(super) fn with_pool(
    _: usize,
    _: &(impl Fn() + Sync),
    _: &(impl Fn(usize) + Sync),
    work: impl FnOnce(&WorkerPool, &mut dyn FnMut(usize)),
) {
    let pool = WorkerPool::default();
    let _shutdown = Shutdown(&pool);
    work(&pool, &mut |_| ());
}
