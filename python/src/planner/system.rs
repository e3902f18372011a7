//! Hybrid systems and their transitions.

use carom::Error;
use carom::hybrid::{self, Feedback, ShortestOptions, State, TransitionMut};
use carom::model::{Affine, Variable};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::expression::{Expression, Handle, Operand, Row, rows};
use super::plan::Shortest;
use super::program::{HybridProgram, Mission};
use super::solve;
use crate::errors::exception;
use crate::settings::{Settings, seconds};

/// A state and what it becomes.
type Entry<'py> = (PyRef<'py, Expression>, Operand);

/// A hybrid system.
#[pyclass(module = "carom._carom")]
#[derive(Debug)]
pub(crate) struct HybridSystem {
    pub(crate) system: hybrid::HybridSystem,
}

/// A transition of a system, to say more about it.
#[pyclass(module = "carom._carom")]
#[derive(Debug)]
pub(crate) struct Transition {
    system: Py<HybridSystem>,
    taken: Variable,
    name: String,
    has_flow: bool,
}

/// Entries of a flow or a reset.
fn entries(given: Vec<Entry<'_>>) -> PyResult<Vec<(State, Affine)>> {
    given.into_iter().map(|(state, value)| Ok((state.state()?, value.affine()?))).collect()
}

/// A value, or the exception for an error.
fn done<T>(result: Result<T, Error>) -> PyResult<T> {
    result.map_err(|error| exception(&error))
}

impl HybridSystem {
    /// The transition that a statement makes.
    fn transition(
        this: &Bound<'_, Self>,
        name: &str,
        state: impl FnOnce(&mut hybrid::HybridSystem) -> Result<Variable, Error>,
    ) -> PyResult<Transition> {
        let taken = done(state(&mut this.borrow_mut().system))?;
        Ok(Transition {
            system: this.clone().unbind(),
            taken,
            name: name.to_owned(),
            has_flow: false,
        })
    }
}

#[pymethods]
impl HybridSystem {
    #[new]
    fn new(time_step: f64) -> Self {
        HybridSystem { system: hybrid::HybridSystem::new(time_step) }
    }

    #[getter]
    fn time_step(&self) -> f64 {
        self.system.time_step()
    }

    fn state(&mut self, name: &str, lower: f64, upper: f64) -> PyResult<Expression> {
        let state = done(self.system.state(name, lower, upper))?;
        Ok(Expression::of(Handle::State(state), name))
    }

    fn input(&mut self, name: &str, lower: Vec<f64>, upper: Vec<f64>) -> PyResult<Expression> {
        let input = done(self.system.input(name, lower, upper))?;
        Ok(Expression::of(Handle::Input(input), name))
    }

    fn series(&mut self, name: &str, values: Vec<f64>) -> PyResult<Expression> {
        let series = done(self.system.series(name, values))?;
        Ok(Expression::of(Handle::Other(series), name))
    }

    fn output(&mut self, name: &str) -> PyResult<Expression> {
        let output = done(self.system.output(name))?;
        Ok(Expression::of(Handle::Other(output), name))
    }

    fn rates(&mut self, rates: Vec<Entry<'_>>) -> PyResult<()> {
        done(self.system.rates(entries(rates)?))
    }

    fn next(&mut self, values: Vec<Entry<'_>>) -> PyResult<()> {
        done(self.system.next(entries(values)?))
    }

    fn limit(&mut self, name: &str, row: PyRef<'_, Row>) -> PyResult<()> {
        done(self.system.limit(name, row.row.clone()))
    }

    fn invariant(&mut self, row: PyRef<'_, Row>) -> PyResult<()> {
        done(self.system.invariant(row.row.clone()))
    }

    fn disturbance(&mut self, state: &Expression, lower: f64, upper: f64) -> PyResult<()> {
        done(self.system.disturbance(state.state()?, lower, upper))
    }

    fn most_events(&mut self, most: usize) {
        self.system.most_events(most);
    }

    fn mode(slf: &Bound<'_, Self>, choice: &str, name: &str) -> PyResult<Transition> {
        Self::transition(slf, name, |own| Ok(own.mode_of(choice, name)?.taken()))
    }

    fn event(slf: &Bound<'_, Self>, choice: &str, name: &str) -> PyResult<Transition> {
        Self::transition(slf, name, |own| Ok(own.event_of(choice, name)?.taken()))
    }

    fn modes(&mut self, choice: &str, names: Vec<String>) -> PyResult<Vec<Expression>> {
        if let Some(name) = names.iter().enumerate().find(|(k, name)| names[..*k].contains(name)) {
            return Err(PyValueError::new_err(format!(
                "two modes of one choice are called `{}`",
                name.1
            )));
        }
        let mode = |name: &String| {
            let [mode] = done(self.system.modes(choice, [name]))?;
            Ok(Expression::of(Handle::Other(mode), name))
        };
        names.iter().map(mode).collect()
    }

    fn stay(slf: &Bound<'_, Self>, mode: &Expression) -> PyResult<Transition> {
        let handle = mode.handle()?.variable();
        Self::transition(slf, "stay", |own| Ok(own.stay(handle)?.taken()))
    }

    fn switch(slf: &Bound<'_, Self>, from: &Expression, to: &Expression) -> PyResult<Transition> {
        let [from, to] = [from.handle()?.variable(), to.handle()?.variable()];
        Self::transition(slf, "switch", |own| Ok(own.switch(from, to)?.taken()))
    }

    fn acting(&mut self, mode: &Expression) -> PyResult<Expression> {
        let acting = done(self.system.acting(mode.handle()?.variable()))?;
        Ok(Expression::of(Handle::Other(acting), "acting"))
    }

    fn dwell(&mut self, mode: &Expression, least: usize, most: Option<usize>) -> PyResult<()> {
        done(self.system.dwell(mode.handle()?.variable(), least, most))
    }

    fn check(&self) -> PyResult<()> {
        done(self.system.check())
    }

    fn program(&self, py: Python<'_>, steps: usize) -> PyResult<HybridProgram> {
        let program = py.detach(|| self.system.program(steps));
        Ok(HybridProgram { program: done(program)? })
    }

    /// The plan with the fewest steps, under a mission and for every disturbance if that is asked
    /// for.
    #[expect(clippy::too_many_arguments, reason = "the options of the method in Python")]
    fn shortest(
        &self,
        py: Python<'_>,
        start: Vec<PyRef<'_, Row>>,
        goal: Vec<PyRef<'_, Row>>,
        mission: Option<&Mission>,
        robust: bool,
        max_steps: Option<usize>,
        total_time_limit: Option<f64>,
        settings: Settings,
    ) -> PyResult<Shortest> {
        let (system, start, goal) = (self.system.clone(), rows(&start), rows(&goal));
        let mut options = ShortestOptions::default();
        options.max_steps = max_steps.unwrap_or(options.max_steps);
        options.time_limit = seconds(total_time_limit)?;
        if let Some(mission) = mission {
            options = options.with_mission("mission", &mission.mission);
        }
        if robust {
            let found = solve(py, &settings, move |interrupt, solver| {
                let (feedback, options) =
                    (Feedback::regulator(&system)?, options.with_interrupt(interrupt));
                system.shortest_robust(start, goal, &feedback, &options, solver)
            })?;
            return Ok(Shortest::new(found));
        }
        let found = solve(py, &settings, move |interrupt, solver| {
            system.shortest_with(start, goal, &options.with_interrupt(interrupt), solver)
        })?;
        Ok(Shortest::new(found))
    }
}

impl Transition {
    /// Says more about the transition.
    fn say(
        slf: &Bound<'_, Self>,
        say: impl for<'a> FnOnce(TransitionMut<'a>) -> Result<TransitionMut<'a>, Error>,
    ) -> PyResult<()> {
        let this = slf.borrow();
        let mut system = this.system.bind(slf.py()).borrow_mut();
        done(system.system.transition_mut(this.taken).and_then(say).map(drop))
    }

    /// Takes note that the flow is stated; an error if it was.
    fn take_flow(slf: &Bound<'_, Self>) -> PyResult<()> {
        let mut this = slf.borrow_mut();
        if std::mem::replace(&mut this.has_flow, true) {
            return Err(PyValueError::new_err(format!(
                "a second flow of `{}`; state all rows of the flow at once",
                this.name
            )));
        }
        Ok(())
    }
}

#[pymethods]
impl Transition {
    fn rates(slf: &Bound<'_, Self>, rates: Vec<Entry<'_>>) -> PyResult<()> {
        let rates = entries(rates)?;
        Self::take_flow(slf)?;
        Self::say(slf, |own| own.rates(rates))
    }

    fn next(slf: &Bound<'_, Self>, values: Vec<Entry<'_>>) -> PyResult<()> {
        let values = entries(values)?;
        Self::take_flow(slf)?;
        Self::say(slf, |own| own.next(values))
    }

    fn reset(slf: &Bound<'_, Self>, values: Vec<Entry<'_>>) -> PyResult<()> {
        let values = entries(values)?;
        Self::say(slf, |own| own.reset(values))
    }

    fn guard(slf: &Bound<'_, Self>, row: PyRef<'_, Row>) -> PyResult<()> {
        Self::say(slf, |own| own.guard(row.row.clone()))
    }

    fn invariant(slf: &Bound<'_, Self>, row: PyRef<'_, Row>) -> PyResult<()> {
        Self::say(slf, |own| own.invariant(row.row.clone()))
    }

    fn limit(slf: &Bound<'_, Self>, name: &str, row: PyRef<'_, Row>) -> PyResult<()> {
        Self::say(slf, |own| own.limit(name, row.row.clone()))
    }

    fn output(slf: &Bound<'_, Self>, output: &Expression, value: Operand) -> PyResult<()> {
        let (output, value) = (output.handle()?.variable(), value.affine()?);
        Self::say(slf, |own| own.output(output, value))
    }

    fn named(slf: &Bound<'_, Self>, name: &str) -> PyResult<()> {
        Self::say(slf, |own| own.named(name))
    }

    /// The handle of the transition.
    fn taken(&self) -> Expression {
        Expression::of(Handle::Other(self.taken), &self.name)
    }
}
