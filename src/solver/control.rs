//! How a solve is watched and stopped.

use std::fmt;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::guidance::Guidance;
use super::progress::{Event, Incumbent};
use super::seed::TreeSeed;

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
    incumbent: Option<&'a mut OnIncumbent<'a>>,
    seed: Option<&'a TreeSeed>,
    guidance: Guidance<'a>,
    interrupt: Interrupt,
}

/// The callback for new best points.
type OnIncumbent<'a> = dyn FnMut(&Incumbent<'_>) -> ControlFlow<()> + 'a;

impl<'a> Control<'a> {
    /// Calls back on every [`Event`], on the thread that called the solver.
    pub fn with_progress(mut self, callback: &'a mut dyn FnMut(&Event)) -> Self {
        self.progress = Some(callback);
        self
    }

    /// Calls back with every new best point, on the thread that called the solver. Other threads of
    /// the search continue meanwhile. [`ControlFlow::Break`] ends the search, like an interrupt.
    ///
    /// ```
    /// use carom::prelude::*;
    /// use std::ops::ControlFlow;
    ///
    /// let mut model = Model::new("m");
    /// let x = model.integer("x", 0.0, 10.0)?;
    /// model.add("odd", (2.0 * x).within(3.0, 9.0))?;
    /// model.maximize(x)?;
    ///
    /// let mut seen = Vec::new();
    /// let mut note = |best: &Incumbent<'_>| {
    ///     seen.extend(best.point.value(x));
    ///     ControlFlow::Continue(())
    /// };
    /// let mut control = Control::default().with_incumbent(&mut note);
    /// let solution = BranchAndBound::default().solve_with(&model, &mut control)?;
    /// assert_eq!(seen.last().copied(), Some(solution.value(x)?));
    /// # Ok::<(), carom::Error>(())
    /// ```
    pub fn with_incumbent(mut self, callback: &'a mut OnIncumbent<'a>) -> Self {
        self.incumbent = Some(callback);
        self
    }

    /// Warm-starts the search from an earlier solve: see [`TreeSeed`].
    pub fn with_seed(mut self, seed: &'a TreeSeed) -> Self {
        self.seed = Some(seed);
        self
    }

    /// Steers the search: see [`Guidance`].
    pub fn with_guidance(mut self, guidance: Guidance<'a>) -> Self {
        self.guidance = guidance;
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

    /// The seed, for backends.
    pub fn seed(&self) -> Option<&'a TreeSeed> {
        self.seed
    }

    /// The guidance, for backends.
    pub fn guidance(&self) -> &Guidance<'a> {
        &self.guidance
    }

    /// Whether anything is reported.
    pub(crate) fn is_watched(&self) -> bool {
        self.progress.is_some() || self.incumbent.is_some()
    }

    /// Whether new best points are to be reported, for backends.
    pub fn watches_incumbents(&self) -> bool {
        self.incumbent.is_some()
    }

    /// Reports a new best point, for backends; [`ControlFlow::Break`] asks them to stop.
    pub fn report_incumbent(&mut self, incumbent: &Incumbent<'_>) -> ControlFlow<()> {
        match &mut self.incumbent {
            Some(callback) => callback(incumbent),
            None => ControlFlow::Continue(()),
        }
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
            .field("incumbent", &self.incumbent.is_some())
            .field("seed", &self.seed)
            .field("guidance", &self.guidance)
            .field("interrupt", &self.interrupt)
            .finish()
    }
}
