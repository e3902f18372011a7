//! When to stop: one token a solve, made from its options and its control and handed down.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, AtomicUsize, Ordering};

use web_time::{Duration, Instant};

use super::{Control, Event, Interrupt, MipStart, Solver};
use crate::error::Error;
use crate::model::Model;
use crate::solution::{Solution, Termination};

/// Work between two looks at the clock, in entries visited: some tens of microseconds.
const BETWEEN: usize = 10_000;

/// A deadline and an interrupt, cheap to ask in every turn of a loop.
///
/// Clones share one state, and once a token is over it stays over, so that nothing that was left
/// half done is taken for finished later. The default never stops.
#[doc(hidden)]
#[derive(Debug, Default)]
pub struct StopToken {
    shared: Arc<TokenState>,
    /// Work of this clone since its last look at the clock.
    work: AtomicUsize,
}

#[derive(Debug)]
struct TokenState {
    began: Instant,
    at: Option<Instant>,
    interrupt: Interrupt,
    /// Why it is over: one of the constants below.
    ended: AtomicU8,
    /// The token that this one ends with.
    parent: Option<Arc<TokenState>>,
}

const NOT_YET: u8 = 0;
const INTERRUPTED: u8 = 1;
const LATE: u8 = 2;

impl TokenState {
    fn ended(&self) -> Option<Termination> {
        match self.ended.load(Ordering::Relaxed) {
            INTERRUPTED => Some(Termination::Interrupted),
            LATE => Some(Termination::TimeLimit),
            _ => None,
        }
    }

    fn end(&self, reason: u8) {
        // The first reason stands.
        let _ = self.ended.compare_exchange(NOT_YET, reason, Ordering::Relaxed, Ordering::Relaxed);
    }
}

impl Default for TokenState {
    fn default() -> Self {
        TokenState {
            began: Instant::now(),
            at: None,
            interrupt: Interrupt::new(),
            ended: AtomicU8::new(NOT_YET),
            parent: None,
        }
    }
}

impl Clone for StopToken {
    fn clone(&self) -> Self {
        StopToken { shared: Arc::clone(&self.shared), work: AtomicUsize::new(0) }
    }
}

/// Computes something under a token that nobody ends.
pub fn uninterrupted<T>(
    compute: impl FnOnce(&StopToken) -> Result<Option<T>, Error>,
) -> Result<T, Error> {
    let unfinished = || Error::other("a computation ended without a result");
    compute(&StopToken::default())?.ok_or_else(unfinished)
}

impl StopToken {
    /// A token whose clock starts now. Without a time limit only the interrupt counts.
    pub fn new(time_limit: Option<Duration>, interrupt: &Interrupt) -> Self {
        let began = Instant::now();
        // A limit beyond the end of time is none.
        let at = time_limit.and_then(|limit| began.checked_add(limit));
        let interrupt = interrupt.clone();
        let shared = TokenState { began, at, interrupt, ..TokenState::default() };
        StopToken { shared: Arc::new(shared), work: AtomicUsize::new(0) }
    }

    /// A token for a search inside this one: over when this one is, after `time_limit` from now,
    /// or when it is [stopped](Self::stop) itself.
    pub fn child(&self, time_limit: Option<Duration>) -> Self {
        let own = time_limit.and_then(|limit| Instant::now().checked_add(limit));
        let shared = TokenState {
            began: self.shared.began,
            at: own.into_iter().chain(self.shared.at).min(),
            interrupt: self.shared.interrupt.clone(),
            ended: AtomicU8::new(NOT_YET),
            parent: Some(Arc::clone(&self.shared)),
        };
        StopToken { shared: Arc::new(shared), work: AtomicUsize::new(0) }
    }

    /// Ends this token and its children, as an interrupt would; the user's handle is not touched.
    #[inline]
    pub fn stop(&self) {
        self.shared.end(INTERRUPTED);
    }

    /// The user's handle.
    #[inline]
    pub fn interrupt(&self) -> &Interrupt {
        &self.shared.interrupt
    }

    /// Time since the solve began; a child counts from where its parent does.
    #[inline]
    pub fn elapsed(&self) -> Duration {
        self.shared.began.elapsed()
    }

    /// The time left; `None` if it is not limited.
    #[inline]
    pub fn left(&self) -> Option<Duration> {
        self.shared.at.map(|at| at.saturating_duration_since(Instant::now()))
    }

    /// Why it is over, if it is: [`Interrupted`](Termination::Interrupted) or
    /// [`TimeLimit`](Termination::TimeLimit).
    pub fn ended(&self) -> Option<Termination> {
        if let Some(reason) = self.shared.ended() {
            return Some(reason);
        }
        let mut above = self.shared.parent.as_deref();
        while let Some(parent) = above {
            match parent.ended() {
                Some(Termination::Interrupted) => self.shared.end(INTERRUPTED),
                Some(_) => self.shared.end(LATE),
                None => {}
            }
            above = parent.parent.as_deref();
        }
        if self.shared.interrupt.is_triggered() {
            self.shared.end(INTERRUPTED);
        } else if self.shared.at.is_some_and(|at| Instant::now() >= at) {
            self.shared.end(LATE);
        }
        self.shared.ended()
    }

    /// Whether it is over now.
    #[inline]
    pub fn is_over(&self) -> bool {
        self.ended().is_some()
    }

    /// Whether it is over, or would be after a step of such a length that cannot be stopped. Then
    /// it is over now.
    #[doc(hidden)]
    pub fn cannot_wait(&self, step: Duration) -> bool {
        if self.left().is_some_and(|left| left < step) {
            self.shared.end(LATE);
        }
        self.is_over()
    }

    /// Adds work and returns whether it is over. The clock is read once in a while.
    ///
    /// # Arguments
    ///
    /// * `work`: about the number of matrix entries visited since it was last asked.
    pub fn spend(&self, work: usize) -> bool {
        // A clone counts for one thread, so nothing is lost between the two.
        let work = self.work.load(Ordering::Relaxed).saturating_add(work);
        if work < BETWEEN {
            self.work.store(work, Ordering::Relaxed);
            return self.shared.ended.load(Ordering::Relaxed) != NOT_YET;
        }
        self.work.store(0, Ordering::Relaxed);
        self.is_over()
    }

    /// Solves a model within what is left. The solver's own time limit still holds, and is the
    /// same afterwards as before.
    #[doc(hidden)]
    pub fn solve(
        &self,
        solver: &mut dyn Solver,
        model: &Model,
        progress: &mut dyn FnMut(&Event),
    ) -> Result<Solution, Error> {
        self.solve_within(None, solver, model, progress)
    }

    /// As [`solve`](Self::solve), within a number of nodes as well.
    #[doc(hidden)]
    pub fn solve_within(
        &self,
        nodes: Option<u64>,
        solver: &mut dyn Solver,
        model: &Model,
        progress: &mut dyn FnMut(&Event),
    ) -> Result<Solution, Error> {
        let control = Control::default().with_progress(progress);
        self.solve_controlled(nodes, solver, model, control)
    }

    /// As [`solve`](Self::solve), from a start and unwatched.
    #[doc(hidden)]
    pub fn solve_from(
        &self,
        start: &MipStart,
        solver: &mut dyn Solver,
        model: &Model,
    ) -> Result<Solution, Error> {
        self.solve_controlled(None, solver, model, Control::default().with_start(start))
    }

    fn solve_controlled(
        &self,
        nodes: Option<u64>,
        solver: &mut dyn Solver,
        model: &Model,
        control: Control<'_>,
    ) -> Result<Solution, Error> {
        let (own_time, own_nodes) = (solver.options().time_limit, solver.options().node_limit);
        let options = solver.options_mut();
        options.time_limit = own_time.into_iter().chain(self.left()).min();
        options.node_limit = own_nodes.into_iter().chain(nodes).min();
        let solution = solver.solve_with(model, &mut control.with_interrupt(self.interrupt()));
        let options = solver.options_mut();
        (options.time_limit, options.node_limit) = (own_time, own_nodes);
        solution
    }
}
