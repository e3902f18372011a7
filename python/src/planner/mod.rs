//! The planner's door: hybrid systems, scenes and missions in the words of the crate.
//!
//! * `expression` - handles, expressions and rows, with Python's operators
//! * `system` - systems and their transitions
//! * `program` - programs of systems, and missions
//! * `plan` - plans, and what a search for the shortest one has found
//! * `controller` - a controller on a thread of its own
//! * `scene` - bodies among obstacles

mod controller;
mod expression;
mod plan;
mod program;
mod scene;
mod system;

pub(crate) use controller::Controller;
pub(crate) use expression::{Expression, Norm, Row, norm};
pub(crate) use plan::{Plan, Shortest};
pub(crate) use program::{HybridProgram, Mission};
pub(crate) use scene::{Scene, ShortestInScene};
pub(crate) use system::{HybridSystem, Transition};

use carom::solver::Interrupt;
use carom::{BranchAndBound, Error};
use pyo3::prelude::*;

use crate::errors::exception;
use crate::session::{self, Watch};
use crate::settings::Settings;

/// Does work with a solver on a thread of its own.
fn solve<T: Send + 'static>(
    py: Python<'_>,
    settings: &Settings,
    work: impl FnOnce(&Interrupt, &mut BranchAndBound) -> Result<T, Error> + Send + 'static,
) -> PyResult<T> {
    let (options, interrupt) = (settings.options()?, Interrupt::new());
    let watch = Watch { interrupt: interrupt.clone(), callback: None, columns: 0 };
    let done =
        session::run(py, &watch, move |_| work(&interrupt, &mut BranchAndBound::new(options)))?;
    done.map_err(|error| exception(&error))
}
