//! A step of a controller: plan, move, fall back.

use web_time::{Duration, Instant};

use super::RecedingHorizon;
use super::fallback::Present;
use super::loop_plan::LoopPlan;
use super::planner::{Planned, Question};
use super::recovery::rounded_into;
use super::step::{ControlMove, MoveSource};
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::error::{Error, check_finite};
#[cfg(doc)]
use crate::model::Model;

impl RecedingHorizon<'_> {
    /// The next move from a measured state.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Length`] and [`ErrorKind::NotFinite`] for the state; [`ErrorKind::UnknownName`]
    /// for a [memory](Self::set_memory) of another system; errors of the solver; for a shrinking or
    /// moving horizon those of building the program, and [`ErrorKind::OutOfRange`] after the last
    /// step of a shrinking one; those of [`Model::set_parameter`] for
    /// [parameters](Self::with_parameters). A state outside the declared ranges, an infeasible
    /// program and a limit without a point are no errors: the move then comes from a fallback.
    pub fn step(&mut self, state: &[f64]) -> Result<ControlMove, Error> {
        let began = Instant::now();
        check_finite("the measured state", "an entry", state.iter().copied())?;
        self.planner.begin(self.steps, &mut self.memory)?;
        if let Some(systems) = self.planner.systems() {
            self.system = systems.steered().map(|only| only.system().clone());
        }
        let mut memory = self.memory.clone();
        let searched = Instant::now();
        let planned = self.plan(state, None)?;
        self.missed = matches!(planned, Planned::Nothing(..));
        let mut next = match planned {
            Planned::Found(solution, plan, excess) => {
                self.rest = plan.clone();
                let mut next = ControlMove::planned(&solution, plan, excess);
                if !solution.relaxed().is_empty() {
                    let present = Present { system: self.system.as_ref(), state, memory: &memory };
                    next.is_admissible = self.fallback.is_run(present, self.rest.clone());
                }
                next
            }
            Planned::Nothing(solution, why) => {
                let present = Present { system: self.system.as_ref(), state, memory: &memory };
                let substitute = self.fallback.instead(present, &self.rest)?;
                let is_lost = substitute.source == MoveSource::Emergency
                    && substitute.is_admissible != Some(true);
                let may_recover =
                    is_lost && solution.as_ref().is_none_or(|own| own.is_infeasible());
                let recovered = if may_recover { self.recover(state, searched)? } else { None };
                let mut next = recovered.unwrap_or_else(|| ControlMove::of(substitute));
                next.reason = Some(why);
                if let Some(solution) = solution.filter(|_| next.source != MoveSource::Recovery) {
                    next.count(&solution);
                }
                next
            }
        };
        let choices = self.planner.systems().map(|systems| systems.choices()).unwrap_or_default();
        let first = LoopPlan { transitions: next.transitions.clone(), ..LoopPlan::default() };
        self.memory = first.pass(&choices, &mut memory);
        self.rest = self.rest.rest();
        next.memory = memory;
        next.step = self.steps;
        next.state = state.to_vec();
        self.steps += 1;
        self.planner.shift();
        next.time = began.elapsed();
        Ok(next)
    }

    /// Plans from a state, in what is left of the budget since a time.
    pub(super) fn plan(&mut self, state: &[f64], since: Option<Instant>) -> Result<Planned, Error> {
        let parameters = match self.planner.model() {
            Some(model) if !self.forecasts.is_empty() => {
                self.forecasts.at(model, self.steps, state)?
            }
            _ => Vec::new(),
        };
        let first = self.first_budget.filter(|_| self.steps == 0);
        let left = |budget: Duration| {
            budget.saturating_sub(since.map_or(Duration::ZERO, |since| since.elapsed()))
        };
        let ranges = self.planner.ranges()?;
        let question = Question {
            state: &rounded_into(state, &ranges),
            memory: &self.memory,
            parameters: &parameters,
            budget: first.or(self.budget).map(left),
            excess: self.excess.as_ref(),
            missed: self.missed.then_some(&self.rest),
        };
        self.planner.plan(&question)
    }
}
