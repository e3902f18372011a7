//! What a solve is told: limits, gaps, a start, and who watches it.

use std::path::PathBuf;
use std::time::Duration;

use carom::model::{Model, Variable};
use carom::solver::{Interrupt, MipStart, Options};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::numbers::Floats;

/// The settings of a solve; `None` leaves the default.
#[derive(Debug, FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Settings {
    time_limit: Option<f64>,
    node_limit: Option<u64>,
    memory_limit: Option<u64>,
    gap: Option<f64>,
    absolute_gap: Option<f64>,
    feasibility: Option<f64>,
    threads: usize,
    deterministic: bool,
    proof: Option<PathBuf>,
    verbose: bool,
    /// Called with each new best point.
    pub(crate) callback: Option<Py<PyAny>>,
    start: Option<Floats>,
}

/// A solve as the thread that runs it needs it.
#[derive(Debug)]
pub(crate) struct Task {
    pub(crate) options: Options,
    pub(crate) interrupt: Interrupt,
    pub(crate) start: Option<MipStart>,
    /// Whether new best points are reported.
    pub(crate) is_watched: bool,
    /// Whether the lines of a log are.
    pub(crate) is_verbose: bool,
}

/// A time in seconds; none if it is infinite.
pub(crate) fn seconds(limit: Option<f64>) -> PyResult<Option<Duration>> {
    let Some(limit) = limit.filter(|limit| *limit != f64::INFINITY) else { return Ok(None) };
    match Duration::try_from_secs_f64(limit) {
        Ok(limit) => Ok(Some(limit)),
        Err(_) => Err(PyValueError::new_err(format!(
            "`time_limit` is {limit} and must be a number of seconds, at least 0; None is no limit"
        ))),
    }
}

impl Settings {
    /// The options of the solver.
    pub(crate) fn options(&self) -> PyResult<Options> {
        let mut options = Options::default();
        options.time_limit = seconds(self.time_limit)?;
        options.node_limit = self.node_limit;
        options.memory_limit = self.memory_limit;
        options.relative_gap = self.gap.unwrap_or(options.relative_gap);
        options.absolute_gap = self.absolute_gap.unwrap_or(options.absolute_gap);
        options.feasibility = self.feasibility.unwrap_or(options.feasibility);
        options.threads = self.threads;
        options.deterministic = self.deterministic;
        options.proof.clone_from(&self.proof);
        Ok(options)
    }

    /// The task of solving a model whose first variables are those of the arrays.
    pub(crate) fn task(&self, model: &Model) -> PyResult<Task> {
        Ok(Task {
            options: self.options()?,
            interrupt: Interrupt::new(),
            start: self.start.as_ref().map(|Floats(values)| start(model, values)),
            is_watched: self.callback.is_some(),
            is_verbose: self.verbose,
        })
    }
}

/// The integers of a point that may have gaps, which are not finite.
fn start(model: &Model, values: &[f64]) -> MipStart {
    let known = integers(model).zip(values);
    let known = known.filter(|(_, value)| value.is_finite());
    MipStart::new().with_values(known.filter_map(|(integer, &value)| Some((integer?, value))))
}

/// The variables in order, those that are not integral as `None`.
fn integers(model: &Model) -> impl Iterator<Item = Option<Variable>> {
    model.variables().map(|variable| variable.kind().is_integral().then(|| variable.id()))
}

/// The integers of a model.
pub(crate) fn integral(model: &Model) -> Vec<Variable> {
    integers(model).flatten().collect()
}
