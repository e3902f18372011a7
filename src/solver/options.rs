//! Options that every backend understands.

use web_time::Duration;

use crate::error::Error;
use crate::tolerance;

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
