//! A program that is solved, from arrays or from a file.

use std::sync::Arc;

use carom::model::{Model, Read, cbf, lp, mps, nl, qplib};
use carom::prelude::Solver;
use carom::reformulate::relaxed;
use carom::solver::Interrupt;
use carom::{BranchAndBound, Error};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::answer::Answer;
use crate::arrays::{Arrays, Ranges};
use crate::build::{Built, Layout, build};
use crate::errors::exception;
use crate::explain::{Conflict, explain};
use crate::numbers::Floats;
use crate::session::{self, Watch};
use crate::settings::Settings;

/// A program.
#[pyclass(frozen, module = "carom._carom")]
pub(crate) struct Program {
    model: Arc<Model>,
    layout: Arc<Layout>,
}

impl Program {
    fn new(model: Model, layout: Layout) -> Self {
        Program { model: Arc::new(model), layout: Arc::new(layout) }
    }

    fn watch<'a>(&self, interrupt: &Interrupt, callback: Option<&'a Py<PyAny>>) -> Watch<'a> {
        let columns = self.layout.variables.len();
        Watch { interrupt: interrupt.clone(), callback, columns }
    }
}

#[pymethods]
impl Program {
    /// The program of arrays.
    #[staticmethod]
    fn of(py: Python<'_>, arrays: Arrays) -> PyResult<Self> {
        let built = py.detach(|| build(&arrays, &Ranges::default()));
        let Built { model, layout, .. } = built.map_err(|error| exception(&error))?;
        Ok(Program::new(model, layout))
    }

    /// The program of a file, and what its reader warns of.
    #[staticmethod]
    fn read(py: Python<'_>, data: &[u8], format: &str) -> PyResult<(Self, Vec<String>)> {
        let text = |read: fn(&str) -> Result<Read, Error>| {
            let text = String::from_utf8(data.to_vec())?;
            Ok::<_, PyErr>(py.detach(|| read(&text)))
        };
        let read = match format {
            "mps" => text(mps::read)?,
            "lp" => text(lp::read)?,
            "cbf" => text(cbf::read)?,
            "qplib" => text(qplib::read)?,
            // One of its forms is no text.
            "nl" => py.detach(|| nl::read(data)),
            _ => return Err(unknown(format)),
        };
        let read = read.map_err(|error| exception(&error))?;
        let warnings = read.warnings.iter().map(ToString::to_string).collect();
        let layout = Layout::of(&read.model);
        Ok((Program::new(read.model, layout), warnings))
    }

    /// The program as the text of a file.
    fn write(&self, py: Python<'_>, format: &str) -> PyResult<String> {
        let write: fn(&Model) -> Result<String, Error> = match format {
            "mps" => mps::write,
            "lp" => lp::write,
            "cbf" => cbf::write,
            "nl" => nl::write,
            _ => return Err(unknown(format)),
        };
        py.detach(|| write(&self.model)).map_err(|error| exception(&error))
    }

    /// The names of the variables.
    fn names(&self) -> Vec<String> {
        let variables = self.model.variables().take(self.layout.variables.len());
        variables.map(|variable| variable.name().to_string()).collect()
    }

    /// The names of the linear rows of a program from a file.
    fn row_names(&self) -> Vec<String> {
        self.model.constraints().map(|row| row.name().to_string()).collect()
    }

    /// How many variables, integers among them, linear rows and cones it has.
    fn sizes(&self) -> (usize, usize, usize, usize) {
        let variables = self.model.variables().take(self.layout.variables.len());
        let integers = variables.filter(|variable| variable.kind().is_integral()).count();
        let cones = self.model.conic_constraint_count();
        (self.layout.variables.len(), integers, self.layout.rows.len(), cones)
    }

    fn __str__(&self) -> String {
        self.model.to_string()
    }

    fn solve(&self, py: Python<'_>, settings: Settings) -> PyResult<Answer> {
        let task = settings.task(&self.model)?;
        let watch = self.watch(&task.interrupt, settings.callback.as_ref());
        let model = Arc::clone(&self.model);
        let solved = session::run(py, &watch, move |solving| {
            let mut solver = BranchAndBound::new(task.options.clone());
            solving.solve(&task, |control| solver.solve_with(&model, control))
        })?;
        Ok(Answer::new(solved.map_err(|error| exception(&error))?, &self.layout))
    }

    /// Why there is no point.
    fn explain(&self, py: Python<'_>, settings: Settings) -> PyResult<Conflict> {
        let (interrupt, options) = (Interrupt::new(), settings.options()?);
        let watch = self.watch(&interrupt, None);
        let (model, layout) = (Arc::clone(&self.model), Arc::clone(&self.layout));
        let found =
            session::run(py, &watch, move |_| explain(&model, &layout, options, &interrupt))?;
        found.map_err(|error| exception(&error))
    }

    /// The program with continuous variables only, and its integers fixed at these values if there
    /// are any.
    #[pyo3(signature = (at=None))]
    fn relaxed(&self, py: Python<'_>, at: Option<Floats>) -> PyResult<Self> {
        let relax = || {
            let mut model = Model::clone(&self.model);
            let kinds: Vec<bool> =
                model.variables().map(|variable| variable.kind().is_integral()).collect();
            if let Some(Floats(values)) = &at {
                let columns = self.layout.variables.iter().zip(values).zip(kinds);
                for ((&variable, &value), _) in columns.filter(|(_, is_integral)| *is_integral) {
                    model.fix(variable, value.round())?;
                }
            }
            relaxed(&model)
        };
        let model = py.detach(relax).map_err(|error: Error| exception(&error))?;
        Ok(Program { model: Arc::new(model), layout: Arc::clone(&self.layout) })
    }
}

fn unknown(format: &str) -> PyErr {
    PyValueError::new_err(format!(
        "no such format: `{format}`; `mps`, `lp`, `cbf` and `nl` are read and written, `qplib` is read"
    ))
}
