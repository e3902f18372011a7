//! How a solve is watched and stopped.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::progress::Event;

/// A handle that stops a running solve from another thread or from a progress callback.
///
/// Clones share one flag. A triggered interrupt stays triggered until [`reset`](Self::reset).
#[derive(Debug, Clone, Default)]
pub struct Interrupt {
    flag: Arc<AtomicBool>,
}

impl Interrupt {
    /// A new, untriggered handle.
    pub fn new() -> Self {
        Interrupt::default()
    }

    /// Asks every solve that holds a clone of this handle to stop.
    pub fn trigger(&self) {
        self.flag.store(true, Ordering::Relaxed);
    }

    /// Whether it was triggered.
    pub fn is_triggered(&self) -> bool {
        self.flag.load(Ordering::Relaxed)
    }

    /// Makes the handle usable for the next solve.
    pub fn reset(&self) {
        self.flag.store(false, Ordering::Relaxed);
    }
}

/// How a solve is watched and stopped.
///
/// ```
/// use carom::prelude::*;
///
/// let mut model = Model::new("m");
/// let x = model.binary("x")?;
/// model.maximize(x)?;
///
/// let mut seen = 0;
/// let mut count = |_: &Event| seen += 1;
/// let interrupt = Interrupt::new(); // clones may be triggered from other threads
/// let mut control = Control::default().with_progress(&mut count).with_interrupt(&interrupt);
/// let solution = BranchAndBound::default().solve_with(&model, &mut control)?;
/// assert!(solution.is_optimal());
/// assert!(seen > 0);
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Default)]
#[must_use]
pub struct Control<'a> {
    progress: Option<&'a mut dyn FnMut(&Event)>,
    interrupt: Interrupt,
}

impl<'a> Control<'a> {
    /// Calls back on every [`Event`], on the thread that called the solver.
    pub fn with_progress(mut self, callback: &'a mut dyn FnMut(&Event)) -> Self {
        self.progress = Some(callback);
        self
    }

    /// Stops the solve when the handle is triggered.
    pub fn with_interrupt(mut self, interrupt: &Interrupt) -> Self {
        self.interrupt = interrupt.clone();
        self
    }

    /// The interrupt in force, for backends.
    pub fn interrupt(&self) -> &Interrupt {
        &self.interrupt
    }

    /// Reports an event, for backends.
    pub fn report(&mut self, event: &Event) {
        if let Some(callback) = &mut self.progress {
            callback(event);
        }
    }
}

impl fmt::Debug for Control<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Control")
            .field("progress", &self.progress.is_some())
            .field("interrupt", &self.interrupt)
            .finish()
    }
}
