//! Ladders that searches use one after the other, with what their methods keep: memory, orders of
//! elimination and symbolic factors.

use std::fmt;
use std::sync::{Mutex, PoisonError};

use super::ladder::Ladder;
use crate::solver::{Options, RelaxationMethod};

/// The ladders of a solve, or of all solves of a prepared model.
pub struct LadderPool {
    choice: RelaxationMethod,
    /// Whether ladders are used again. What one keeps decides about rounding, so the threads of a
    /// deterministic search take new ones.
    keeps: bool,
    make: Box<dyn Fn() -> Ladder + Send + Sync>,
    idle: Mutex<Vec<Ladder>>,
}

impl LadderPool {
    /// An empty pool for solves with these options.
    pub fn new(options: &Options) -> Self {
        let choice = options.relaxation;
        LadderPool::with_ladders(options, move || Ladder::new(choice))
    }

    /// A pool with ladders of one's own.
    pub fn with_ladders(
        options: &Options,
        make: impl Fn() -> Ladder + Send + Sync + 'static,
    ) -> Self {
        let (choice, keeps) = (options.relaxation, !options.deterministic);
        LadderPool { choice, keeps, make: Box::new(make), idle: Mutex::default() }
    }

    /// Whether it is a pool for these options.
    pub(crate) fn suits(&self, options: &Options) -> bool {
        self.choice == options.relaxation && self.keeps != options.deterministic
    }

    /// An idle ladder, or a new one.
    pub(crate) fn take(&self) -> Ladder {
        let idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner).pop();
        idle.unwrap_or_else(|| (self.make)())
    }

    /// Takes a ladder back that is no longer used. Its uncounted work is forgotten.
    pub(crate) fn give_back(&self, mut ladder: Ladder) {
        if self.keeps {
            ladder.take_spent();
            self.idle.lock().unwrap_or_else(PoisonError::into_inner).push(ladder);
        }
    }
}

impl fmt::Debug for LadderPool {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("LadderPool").field("choice", &self.choice).finish_non_exhaustive()
    }
}
