//! Cascades that searches use one after the other, with what their methods keep: memory, orders of
//! elimination and symbolic factors.

use std::fmt;
use std::sync::{Mutex, PoisonError};

use super::method_cascade::MethodCascade;
use crate::solver::{Options, RelaxationMethod};

/// The cascades of a solve, or of all solves of a prepared model.
pub struct CascadePool {
    choice: RelaxationMethod,
    /// Whether cascades are used again. What one keeps decides about rounding, so the threads of a
    /// deterministic search take new ones.
    keeps: bool,
    make: Box<dyn Fn() -> MethodCascade + Send + Sync>,
    idle: Mutex<Vec<MethodCascade>>,
}

impl CascadePool {
    /// An empty pool for solves with these options.
    pub fn new(options: &Options) -> Self {
        let choice = options.relaxation;
        CascadePool::with_cascades(options, move || MethodCascade::new(choice))
    }

    /// A pool with cascades of one's own.
    pub fn with_cascades(
        options: &Options,
        make: impl Fn() -> MethodCascade + Send + Sync + 'static,
    ) -> Self {
        let (choice, keeps) = (options.relaxation, !options.deterministic);
        CascadePool { choice, keeps, make: Box::new(make), idle: Mutex::default() }
    }

    /// Whether it is a pool for these options.
    pub(crate) fn suits(&self, options: &Options) -> bool {
        self.choice == options.relaxation && self.keeps != options.deterministic
    }

    /// An idle cascade, or a new one.
    pub(crate) fn take(&self) -> MethodCascade {
        let idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner).pop();
        idle.unwrap_or_else(|| (self.make)())
    }

    /// Takes a cascade back that is no longer used. Its uncounted work is forgotten.
    pub(crate) fn give_back(&self, mut cascade: MethodCascade) {
        if self.keeps {
            cascade.take_spent();
            self.idle.lock().unwrap_or_else(PoisonError::into_inner).push(cascade);
        }
    }
}

impl fmt::Debug for CascadePool {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("CascadePool").field("choice", &self.choice).finish_non_exhaustive()
    }
}
