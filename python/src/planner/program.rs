//! Programs of hybrid systems, and missions.

use carom::explain::{ExplainOptions, infeasibility};
use carom::hybrid::{self, Feedback, When};
use carom::solver::Control;
use pyo3::prelude::*;

use super::expression::{Expression, Operand, Row, Value, rows};
use super::plan::Plan;
use super::solve;
use crate::errors::exception;
use crate::settings::Settings;

/// A program: a system over a number of steps, with a cost.
#[pyclass(module = "carom._carom")]
#[derive(Debug)]
pub(crate) struct HybridProgram {
    pub(crate) program: hybrid::HybridProgram,
}

/// A mission: what is to hold when.
#[pyclass(frozen, module = "carom._carom")]
#[derive(Debug, Clone)]
pub(crate) struct Mission {
    pub(crate) mission: hybrid::Mission,
}

#[pymethods]
impl Mission {
    /// The mission of a text in which names stand for rows.
    #[new]
    fn new(text: &str, names: Vec<(String, Vec<PyRef<'_, Row>>)>) -> PyResult<Self> {
        let named = names.into_iter().map(|(name, own)| hybrid::Mission::holds(name, rows(&own)));
        let mission = hybrid::Mission::parse(text, named);
        Ok(Mission { mission: mission.map_err(|error| exception(&error))? })
    }

    fn __str__(&self) -> String {
        self.mission.to_string()
    }
}

fn done<T>(result: Result<T, carom::Error>) -> PyResult<T> {
    result.map_err(|error| exception(&error))
}

#[pymethods]
impl HybridProgram {
    #[getter]
    fn steps(&self) -> usize {
        self.program.steps()
    }

    fn start(&mut self, given: Vec<PyRef<'_, Row>>) -> PyResult<()> {
        done(self.program.start(rows(&given)))
    }

    fn goal(&mut self, given: Vec<PyRef<'_, Row>>) -> PyResult<()> {
        done(self.program.goal(rows(&given)))
    }

    /// Rows at some samples: at all of them, or at one of them.
    fn require(
        &mut self,
        name: &str,
        given: Vec<PyRef<'_, Row>>,
        first: usize,
        last: usize,
        once: bool,
    ) -> PyResult<()> {
        let when = match (once, first == last) {
            (_, true) => When::At(first),
            (true, false) => When::OnceIn(first..=last),
            (false, false) => When::Throughout(first..=last),
        };
        done(self.program.require(name, rows(&given), when))
    }

    fn require_mission(&mut self, name: &str, mission: &Mission) -> PyResult<()> {
        done(self.program.require_mission(name, &mission.mission))
    }

    fn sum(&self, of: Operand) -> PyResult<Expression> {
        Ok(match of.0 {
            Value::Affine(affine) => Expression::affine(done(self.program.sum(affine))?),
            Value::Quadratic(squares) => Expression::quadratic(done(self.program.sum(squares))?),
        })
    }

    fn sum_abs(&mut self, name: &str, of: Operand) -> PyResult<Expression> {
        Ok(Expression::affine(done(self.program.sum_abs(name, of.affine()?))?))
    }

    fn at(&self, of: Operand, sample: usize) -> PyResult<Expression> {
        Ok(match of.0 {
            Value::Affine(affine) => Expression::affine(done(self.program.at(affine, sample))?),
            Value::Quadratic(squares) => {
                Expression::quadratic(done(self.program.at(squares, sample))?)
            }
        })
    }

    fn minimize(&mut self, cost: Operand) -> PyResult<()> {
        done(self.program.minimize(cost.quadratic()))
    }

    fn maximize(&mut self, gain: Operand) -> PyResult<()> {
        done(self.program.maximize(gain.quadratic()))
    }

    /// The best plan; with `robust`, one that holds for every disturbance.
    fn solve(&self, py: Python<'_>, robust: bool, settings: Settings) -> PyResult<Plan> {
        let program = self.program.clone();
        if robust {
            let plan = solve(py, &settings, move |interrupt, solver| {
                let program = program.robust(&Feedback::regulator(program.system())?)?;
                program.solve_with(&mut Control::default().with_interrupt(interrupt), solver)
            })?;
            return Ok(plan.into());
        }
        let plan = solve(py, &settings, move |interrupt, solver| {
            program.solve_with(&mut Control::default().with_interrupt(interrupt), solver)
        })?;
        Ok(plan.into())
    }

    /// Which statements cannot hold together.
    fn explain(&self, py: Python<'_>, settings: Settings) -> PyResult<String> {
        let model = self.program.model().clone();
        let limit = settings.options()?.time_limit;
        solve(py, &settings, move |interrupt, solver| {
            let mut options = ExplainOptions::default().with_interrupt(interrupt);
            options.time_limit = limit.or(options.time_limit);
            Ok(infeasibility(&model, &options, solver)?.to_string())
        })
    }

    /// The lowered program as the text of an MPS file.
    fn write(&self) -> PyResult<String> {
        let lowered = done(carom::reformulate::lower(self.program.model()))?;
        done(carom::model::mps::write(lowered.model()))
    }
}
