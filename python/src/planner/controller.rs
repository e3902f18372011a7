//! A controller on a thread of its own, because a prepared program stays where it was made.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Mutex, TryLockError};
use std::time::Duration;

use carom::hybrid::{self, ControlMove, RecedingHorizon};
use carom::solver::{Interrupt, Options};
use carom::{BranchAndBound, Error};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyDict};

use super::program::HybridProgram;
use crate::errors::{broken, exception};
use crate::numbers::{Floats, bytes};
use crate::session::{self, Calling, Solving, Watch};
use crate::settings::{Settings, seconds};

/// What came of a step; nothing if the program was only prepared.
type Reply = Result<Option<Box<ControlMove>>, Error>;

/// A controller that plans anew in each step.
#[pyclass(frozen, module = "carom._carom")]
pub(crate) struct Controller {
    desk: Mutex<Desk>,
}

struct Desk {
    states: Sender<Vec<f64>>,
    calling: Calling<Reply>,
}

fn serve(
    program: &hybrid::HybridProgram,
    options: Options,
    budget: Option<Duration>,
    states: &Receiver<Vec<f64>>,
    solving: &Solving<Reply>,
) {
    let mut solver = BranchAndBound::new(options);
    let mut controller = match RecedingHorizon::new(program.clone(), &mut solver) {
        Ok(controller) => controller,
        Err(error) => return solving.done(Err(error)),
    };
    if let Some(budget) = budget {
        controller = controller.with_budget(budget);
    }
    solving.done(Ok(None));
    while let Ok(state) = states.recv() {
        solving.done(controller.step(&state).map(|next| Some(Box::new(next))));
    }
}

fn watch() -> Watch<'static> {
    Watch { interrupt: Interrupt::new(), callback: None, columns: 0 }
}

#[pymethods]
impl Controller {
    #[new]
    fn new(
        py: Python<'_>,
        program: PyRef<'_, HybridProgram>,
        budget: Option<f64>,
        integer_horizon: Option<usize>,
        settings: Settings,
    ) -> PyResult<Self> {
        let (mut program, options) = (program.program.clone(), settings.options()?);
        if let Some(steps) = integer_horizon {
            program.set_integer_horizon(steps).map_err(|error| exception(&error))?;
        }
        let budget = seconds(budget)?;
        let (states, queue) = channel();
        let (mut calling, solving) = session::link();
        session::spawn(move || serve(&program, options, budget, &queue, &solving))?;
        calling.wait(py, &watch())?.map_err(|error| exception(&error))?;
        Ok(Controller { desk: Mutex::new(Desk { states, calling }) })
    }

    /// The move for a measured state.
    fn step<'py>(&self, py: Python<'py>, state: Floats) -> PyResult<Bound<'py, PyDict>> {
        let mut desk = match self.desk.try_lock() {
            Ok(desk) => desk,
            Err(TryLockError::Poisoned(desk)) => desk.into_inner(),
            Err(TryLockError::WouldBlock) => {
                return Err(PyRuntimeError::new_err("this controller is planning another step"));
            }
        };
        // If nobody takes it, nobody answers either.
        let _ = desk.states.send(state.0);
        let reply = desk.calling.wait(py, &watch())?;
        let next = reply.map_err(|error| exception(&error))?.ok_or_else(broken)?;
        told(py, &next)
    }
}

/// A move in words and numbers.
fn told<'py>(py: Python<'py>, next: &ControlMove) -> PyResult<Bound<'py, PyDict>> {
    let table = |rows: &[Vec<f64>]| -> Vec<Bound<'py, PyByteArray>> {
        rows.iter().map(|row| bytes(py, row)).collect()
    };
    let told = PyDict::new(py);
    told.set_item("step", next.step)?;
    told.set_item("input", bytes(py, &next.input))?;
    told.set_item("source", next.source.to_string())?;
    told.set_item("objective", next.objective)?;
    told.set_item("bound", next.bound)?;
    told.set_item("states", table(&next.states))?;
    told.set_item("inputs", table(&next.inputs))?;
    told.set_item("transitions", next.transitions.clone())?;
    told.set_item("modes", next.modes.clone())?;
    told.set_item("nodes", next.nodes)?;
    told.set_item("seconds", next.time.as_secs_f64())?;
    Ok(told)
}
