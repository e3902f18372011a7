//! The trait [`Solver`] and what is common to all backends: options, progress, interrupt, and the
//! [certificate](certify) of points from elsewhere.
//!
//! ```
//! use carom::prelude::*;
//! use std::time::Duration;
//!
//! let mut model = Model::new("m");
//! let x = model.integer("x", 0.0, 10.0)?;
//! model.add("odd", (2.0 * x).within(3.0, 9.0))?;
//! model.maximize(x)?;
//!
//! let options = Options::default().with_time_limit(Duration::from_secs(5));
//! let mut solver = BranchAndBound::new(options);
//! let solution = solver.solve(&model)?;
//! assert!(solution.is_optimal());
//! assert_eq!(solution.value(x)?, 4.0);
//! # Ok::<(), carom::Error>(())
//! ```

mod budget;
mod certificate;

pub use certificate::{Certificate, certify};

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use web_time::Duration;

use crate::error::Error;
use crate::model::Model;
use crate::solution::Solution;
use crate::tolerance;

pub(crate) use budget::Budget;

/// A backend that solves models to proved optimality.
///
/// # Contract
///
/// * [`Termination::Optimal`](crate::solution::Termination::Optimal) is claimed only when bound
///   and point meet the gap of the options; infeasibility and bounds are proved, not guessed.
/// * A limit or an interrupt returns the best verified point so far with a valid bound.
/// * Infeasible, unbounded and limits are statuses of the solution; an [`Error`] means misuse or
///   breakdown.
/// * The model is only borrowed, and a solver can be used again after any outcome.
pub trait Solver {
    /// A short name, for reports.
    fn name(&self) -> &str;

    /// The options in force.
    fn options(&self) -> &Options;

    /// The options, for changing.
    fn options_mut(&mut self) -> &mut Options;

    /// Solves a model under the given control.
    ///
    /// # Errors
    ///
    /// Errors of lowering ([`Error::UnboundedIndicator`], [`Error::UnboundedFunction`],
    /// [`Error::UnsafeBigM`]), of options ([`Error::OutOfRange`]) and of the backend
    /// ([`Error::Backend`]).
    fn solve_with(&mut self, model: &Model, control: &mut Control<'_>) -> Result<Solution, Error>;

    /// Solves a model without progress events and without an interrupt.
    ///
    /// # Errors
    ///
    /// As for [`solve_with`](Solver::solve_with).
    fn solve(&mut self, model: &Model) -> Result<Solution, Error> {
        self.solve_with(model, &mut Control::default())
    }
}

/// Options that every backend understands.
///
/// Made by `Options::default()` and changed by the `with_...` methods or the public fields.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Options {
    /// Relative gap at which to stop (no unit, `>= 0`); default
    /// [`tolerance::RELATIVE_GAP`]. The search stops when this or the absolute gap is met.
    pub relative_gap: f64,
    /// Absolute gap at which to stop (objective's unit, `>= 0`); default
    /// [`tolerance::ABSOLUTE_GAP`].
    pub absolute_gap: f64,
    /// Feasibility tolerance of rows and bounds (`1e-9..=1e-3`); default
    /// [`tolerance::FEASIBILITY`].
    pub feasibility: f64,
    /// Integrality tolerance of relaxations (`1e-9..=1e-2`); default
    /// [`tolerance::INTEGRALITY`].
    pub integrality: f64,
    /// Wall-clock limit; default none.
    pub time_limit: Option<Duration>,
    /// Limit on nodes; default none.
    pub node_limit: Option<u64>,
    /// Threads of the tree search (`1..=256`); default 1. With one thread a solve is
    /// deterministic, unless a time limit or an interrupt ends it. Backends that have no threads,
    /// and targets without them, use one.
    pub threads: usize,
    /// Whether the program is presolved before the search; default `true`.
    pub presolve: bool,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            relative_gap: tolerance::RELATIVE_GAP,
            absolute_gap: tolerance::ABSOLUTE_GAP,
            feasibility: tolerance::FEASIBILITY,
            integrality: tolerance::INTEGRALITY,
            time_limit: None,
            node_limit: None,
            threads: 1,
            presolve: true,
        }
    }
}

impl Options {
    /// Sets the relative gap.
    #[must_use]
    pub fn with_relative_gap(mut self, gap: f64) -> Self {
        self.relative_gap = gap;
        self
    }

    /// Sets the absolute gap.
    #[must_use]
    pub fn with_absolute_gap(mut self, gap: f64) -> Self {
        self.absolute_gap = gap;
        self
    }

    /// Sets the time limit.
    #[must_use]
    pub fn with_time_limit(mut self, limit: Duration) -> Self {
        self.time_limit = Some(limit);
        self
    }

    /// Sets the node limit.
    #[must_use]
    pub fn with_node_limit(mut self, limit: u64) -> Self {
        self.node_limit = Some(limit);
        self
    }

    /// Sets the number of threads.
    #[must_use]
    pub fn with_threads(mut self, threads: usize) -> Self {
        self.threads = threads;
        self
    }

    /// Sets whether the program is presolved before the search.
    #[must_use]
    pub fn with_presolve(mut self, presolve: bool) -> Self {
        self.presolve = presolve;
        self
    }

    /// Refuses values outside their ranges; every backend calls it first.
    ///
    /// # Errors
    ///
    /// [`Error::OutOfRange`], naming the option.
    pub fn check(&self) -> Result<(), Error> {
        let check = |what: &str, value: f64, holds: bool, range: String| {
            let error = || Error::OutOfRange { what: format!("option `{what}`"), value, range };
            if holds { Ok(()) } else { Err(error()) }
        };
        let gap = |what: &str, value: f64| {
            check(what, value, value.is_finite() && value >= 0.0, "finite and not negative".into())
        };
        let range = |what: &str, value: f64, low: f64, high: f64| {
            check(what, value, (low..=high).contains(&value), format!("within [{low}, {high}]"))
        };
        gap("relative_gap", self.relative_gap)?;
        gap("absolute_gap", self.absolute_gap)?;
        range("feasibility", self.feasibility, 1e-9, 1e-3)?;
        range("integrality", self.integrality, 1e-9, 1e-2)?;
        range("threads", self.threads as f64, 1.0, 256.0)
    }
}

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

/// A progress event of a solve. Objective values are in the model's own sense.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Event {
    /// The root node is done.
    Root(Progress),
    /// A better point was found and verified.
    Incumbent(Progress),
    /// A regular sign of life, a few times a second.
    Progress(Progress),
}

impl Event {
    /// The figures of any event.
    pub fn progress(&self) -> &Progress {
        match self {
            Event::Root(p) | Event::Incumbent(p) | Event::Progress(p) => p,
        }
    }
}

/// The figures of a search at one moment.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Progress {
    /// Nodes processed.
    pub nodes: u64,
    /// Nodes waiting.
    pub open: usize,
    /// Relaxations solved.
    pub relaxations: u64,
    /// Objective of the best point so far.
    pub incumbent: Option<f64>,
    /// Proved bound.
    pub bound: f64,
    /// Time since the solve began.
    pub elapsed: Duration,
}

impl Progress {
    /// A snapshot, for backends that report their own progress.
    pub fn new(
        nodes: u64,
        open: usize,
        relaxations: u64,
        incumbent: Option<f64>,
        bound: f64,
        elapsed: Duration,
    ) -> Self {
        Progress { nodes, open, relaxations, incumbent, bound, elapsed }
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
