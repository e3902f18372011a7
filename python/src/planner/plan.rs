//! Plans, and what a search for the shortest one has found.

use carom::hybrid::reach::{ReachSets, Tube};
use carom::hybrid::{Disturbance, HybridPlan, HybridRun, RobustPlan, ShortestHorizon};
use carom::interval::Interval;
use carom::picture::Chart;
use carom::solution::Solution;
use pyo3::prelude::*;
use pyo3::types::PyByteArray;

use super::expression::{Expression, Operand};
use super::program::Mission;
use crate::errors::exception;
use crate::numbers::bytes;

const COLOURS: [&str; 2] = ["#1f77b4", "#d95f02"];

fn done<T>(result: Result<T, carom::Error>) -> PyResult<T> {
    result.map_err(|error| exception(&error))
}

/// A certified plan.
#[pyclass(frozen, module = "carom._carom")]
#[derive(Debug, Clone)]
pub(crate) struct Plan {
    plan: HybridPlan,
    /// Of a plan that holds for every disturbance.
    robust: Option<RobustPlan>,
}

impl From<HybridPlan> for Plan {
    fn from(plan: HybridPlan) -> Self {
        Plan { plan, robust: None }
    }
}

impl From<RobustPlan> for Plan {
    fn from(robust: RobustPlan) -> Self {
        Plan { plan: robust.plan.clone(), robust: Some(robust) }
    }
}

/// Objective, bound, and whether nothing better exists.
pub(super) fn answer(solution: &Solution) -> (Option<f64>, f64, bool) {
    (solution.objective(), solution.bound(), solution.is_optimal())
}

#[pymethods]
impl Plan {
    #[getter]
    fn steps(&self) -> usize {
        self.plan.steps()
    }

    #[getter]
    fn time_step(&self) -> f64 {
        self.plan.run.time_step
    }

    fn answer(&self) -> (Option<f64>, f64, bool) {
        answer(&self.plan.solution)
    }

    /// The values of a handle: at the samples, or in the steps.
    fn values<'py>(&self, py: Python<'py>, of: &Expression) -> PyResult<Bound<'py, PyByteArray>> {
        Ok(bytes(py, &done(self.plan.values(of.handle()?.variable()))?))
    }

    fn value(&self, of: Operand, sample: usize) -> PyResult<f64> {
        done(self.plan.value(of.affine()?, sample))
    }

    fn modes(&self, choice: &str) -> PyResult<Vec<String>> {
        Ok(done(self.plan.run.modes(choice))?.to_vec())
    }

    fn transitions(&self, choice: &str) -> PyResult<Vec<String>> {
        Ok(done(self.plan.run.transitions(choice))?.to_vec())
    }

    /// States with their values at the samples, and inputs with those in the steps.
    fn table<'py>(&self, py: Python<'py>) -> [Vec<(String, Bound<'py, PyByteArray>)>; 2] {
        let run = &self.plan.run;
        let columns = |named: &[(String, Vec<f64>)]| {
            named.iter().map(|(name, values)| (name.clone(), bytes(py, values))).collect()
        };
        [columns(&run.states), columns(&run.inputs)]
    }

    /// States with the ends of their values in all disturbed runs, by sample; `None` for a plan
    /// without disturbances.
    fn tube<'py>(&self, py: Python<'py>) -> Option<Vec<(String, Bound<'py, PyByteArray>)>> {
        let widths = &self.robust.as_ref()?.certificate.states;
        let ends = |(k, (name, values)): (usize, &(String, Vec<f64>))| {
            let around = |(value, errors): (&f64, &Vec<Interval>)| {
                [value + errors[k].lower, value + errors[k].upper]
            };
            let ends: Vec<f64> = values.iter().zip(widths).flat_map(around).collect();
            (name.clone(), bytes(py, &ends))
        };
        Some(self.plan.run.states.iter().enumerate().map(ends).collect())
    }

    /// A run through random disturbances, the same for the same seed: states by sample, and whether
    /// it keeps the transitions of the plan. `None` for a plan without disturbances.
    #[expect(clippy::type_complexity, reason = "as Python gets it")]
    fn fly<'py>(
        &self,
        py: Python<'py>,
        seed: u64,
    ) -> PyResult<Option<(Vec<(String, Bound<'py, PyByteArray>)>, bool)>> {
        let Some(robust) = &self.robust else { return Ok(None) };
        let mut dice = Disturbance::new([0.0..=1.0], seed);
        let mut draw = |range: Interval| {
            let share = dice.next_value().first().copied().unwrap_or(0.5);
            range.lower + share * (range.upper - range.lower)
        };
        let flown = done(robust.simulate(&mut draw))?;
        let states = flown.run.states.iter();
        let states = states.map(|(name, values)| (name.clone(), bytes(py, values))).collect();
        Ok(Some((states, flown.kept)))
    }

    fn robustness(&self, mission: &Mission) -> PyResult<f64> {
        done(self.plan.robustness(&mission.mission))
    }

    fn csv(&self) -> String {
        self.plan.to_string()
    }

    fn svg(&self, title: &str) -> String {
        Chart::to_svg(&charts(&self.plan.run), title)
    }
}

/// A chart for each state and each input over time, one below the other.
fn charts(run: &HybridRun) -> Vec<Chart> {
    let count = run.states.len() + run.inputs.len();
    let steps = run.states.first().map_or(0, |(_, values)| values.len().saturating_sub(1));
    let end = Interval::new(0.0, run.time_step * steps as f64);
    let chart = |k: usize, name: &str| {
        let time = if k + 1 == count { "time (s)" } else { "" };
        Chart::new(time, name).with_size(720.0, 150.0).with_horizontal_range(end)
    };
    let mut charts = Vec::with_capacity(count);
    for (name, values) in &run.states {
        let mut own = chart(charts.len(), name);
        let at = |(t, value): (usize, &f64)| [t as f64 * run.time_step, *value];
        own.line("", COLOURS[0], values.iter().enumerate().map(at));
        charts.push(own);
    }
    for (name, values) in &run.inputs {
        let mut own = chart(charts.len(), name);
        // An input holds for a whole step.
        let ends = |(t, value): (usize, &f64)| {
            let value = *value;
            [t, t + 1].map(|end| [end as f64 * run.time_step, value])
        };
        own.line("", COLOURS[1], values.iter().enumerate().flat_map(ends));
        charts.push(own);
    }
    charts
}

/// What a search for the shortest plan has found.
#[pyclass(module = "carom._carom")]
#[derive(Debug)]
pub(crate) struct Shortest {
    steps: Option<usize>,
    refuted_steps: Option<usize>,
    text: String,
    plan: Option<Plan>,
    sets: Option<ReachSets>,
    tube: Option<Tube>,
}

impl Shortest {
    pub(super) fn new<P: Into<Plan>>(found: ShortestHorizon<P>) -> Self {
        let text = found.to_string();
        let ShortestHorizon { steps, refuted_steps, plan, sets, tube, .. } = found;
        let plan = plan.map(P::into);
        Shortest { steps, refuted_steps, text, plan, sets, tube }
    }
}

#[pymethods]
impl Shortest {
    #[getter]
    fn steps(&self) -> Option<usize> {
        self.steps
    }

    #[getter]
    fn refuted_steps(&self) -> Option<usize> {
        self.refuted_steps
    }

    #[getter]
    fn plan(&self) -> Option<Plan> {
        self.plan.clone()
    }

    /// Why there is no plan of so many steps; `None` if the reach sets do not tell.
    fn explain(&mut self, steps: usize) -> PyResult<Option<String>> {
        let Some(sets) = &mut self.sets else { return Ok(None) };
        Ok(done(sets.explain(steps))?.map(|reason| reason.to_string()))
    }

    /// A picture of two states among the reach sets; `None` without sets.
    fn svg(&self, first: usize, second: usize, title: &str) -> PyResult<Option<String>> {
        let Some(tube) = &self.tube else { return Ok(None) };
        let run = self.plan.as_ref().map(|plan| &plan.plan.run);
        let chart = done(tube.chart(first, second, run))?;
        Ok(Some(Chart::to_svg(&[chart], title)))
    }

    fn __str__(&self) -> String {
        self.text.clone()
    }
}
