//! Moves when there is no plan.

use super::loop_plan::LoopPlan;
use super::step::MoveSource;
use crate::error::{Error, check_finite, check_length};
use crate::hybrid::memory::Memory;
use crate::hybrid::simulate::{Simulation, SimulationOptions};
use crate::hybrid::system::HybridSystem;
use crate::hybrid::terminal::TerminalSet;

/// By how much a fallback may violate a condition of the system, in its unit: as much as a plan
/// may.
pub(super) const TOLERANCE: f64 = 1e-6;

/// Where inputs come from when there is no plan.
#[derive(Default)]
pub(super) struct Fallback<'a> {
    pub(super) given: Option<Box<Given<'a>>>,
    pub(super) terminal: Option<TerminalSet>,
    /// A simulation of the user's, where there is no system.
    pub(super) check: Option<Box<Check<'a>>>,
}

/// The user's input for a state.
pub(super) type Given<'a> = dyn FnMut(&[f64]) -> Vec<f64> + 'a;

/// Whether inputs, an entry per step, are admissible from a state on.
pub(super) type Check<'a> = dyn FnMut(&[f64], &[Vec<f64>]) -> bool + 'a;

/// The state and the memory with which a step begins.
#[derive(Clone, Copy)]
pub(super) struct Present<'p> {
    pub(super) system: Option<&'p HybridSystem>,
    pub(super) state: &'p [f64],
    pub(super) memory: &'p Memory,
}

/// Steps to hand out, where they come from, and whether a simulation allows them.
pub(super) struct Substitute {
    pub(super) plan: LoopPlan,
    pub(super) source: MoveSource,
    pub(super) is_admissible: Option<bool>,
}

/// The options of the simulations that judge a substitute: the transitions of a plan as far as they
/// are possible.
pub(super) fn judging(memory: &Memory) -> SimulationOptions {
    let options = SimulationOptions { prefers: true, ..SimulationOptions::default() };
    options.with_tolerance(TOLERANCE).with_first_possible(true).with_memory(memory.clone())
}

impl Fallback<'_> {
    /// The first input that a simulation allows: of the rest of the last plan, the terminal
    /// feedback, the given input, and the next input of the last plan alone. If it allows none, the
    /// given input, or the last.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Length`](crate::error::ErrorKind::Length) and
    /// [`ErrorKind::NotFinite`](crate::error::ErrorKind::NotFinite) for the input that the user
    /// gives.
    pub(super) fn instead(
        &mut self,
        present: Present<'_>,
        last: &LoopPlan,
    ) -> Result<Substitute, Error> {
        if !last.inputs.is_empty() {
            let own = self.judged(present, last.clone(), MoveSource::LastPlan);
            if own.is_admissible != Some(false) {
                return Ok(own);
            }
        }
        if let Some(set) = &self.terminal
            && set.region.contains(present.state, 0.0)?
        {
            let mut plan = last.with_first_input(&set.feedback(present.state)?);
            if let Some(system) = present.system {
                let stay = system.choices.iter().zip(set.transitions());
                plan.transitions =
                    stay.map(|(choice, stay)| (choice.name.clone(), vec![stay.clone()])).collect();
            }
            let own = self.judged(present, plan, MoveSource::TerminalFeedback);
            // Whether the set may be entered is a matter of the modes, which the region does not
            // know.
            if own.is_admissible != Some(false) {
                return Ok(Substitute { is_admissible: Some(true), ..own });
            }
        }
        let given = match self.given(present, last)? {
            Some(given) if given.is_admissible != Some(false) => return Ok(given),
            given => given,
        };
        let mut input = last.inputs.first().cloned().unwrap_or_default();
        if let Some(system) = present.system {
            input.resize(system.inputs.len(), 0.0);
            for (u, (value, (_, range))) in input.iter_mut().zip(&system.inputs).enumerate() {
                if let Some(range) = range.get(0) {
                    *value = value.max(range.lower).min(range.upper);
                }
                if let Some(values) = system.values_of_input(u) {
                    *value = values.nearest(*value);
                }
            }
        }
        // Without a system, nobody knows how many inputs there are.
        let plan = last.with_first_input(&input);
        let own = match present.system {
            None if input.is_empty() => {
                Substitute { plan, source: MoveSource::Emergency, is_admissible: None }
            }
            _ => self.judged(present, plan, MoveSource::Emergency),
        };
        Ok(match given {
            Some(given) if own.is_admissible != Some(true) => given,
            _ => own,
        })
    }

    /// The user's input, if there is one.
    fn given(
        &mut self,
        present: Present<'_>,
        last: &LoopPlan,
    ) -> Result<Option<Substitute>, Error> {
        let Some(given) = &mut self.given else { return Ok(None) };
        let mut input = given(present.state);
        if let Some(system) = present.system {
            input = system.with_places(&input);
            check_length("the input of the fallback", input.len(), system.inputs.len())?;
        }
        check_finite("the input of the fallback", "an entry", input.iter().copied())?;
        let plan = last.with_first_input(&input);
        Ok(Some(self.judged(present, plan, MoveSource::Given)))
    }

    /// Whether the system runs as a plan says; `None` without a system.
    pub(super) fn is_run(&mut self, present: Present<'_>, plan: LoopPlan) -> Option<bool> {
        self.judged(present, plan, MoveSource::IntegerHorizon).is_admissible
    }

    /// A plan with what a simulation says of it: whether it comes to the end, and if it does, with
    /// which states and transitions. Where it does not, the transitions are those of the plan, or
    /// stay in the modes.
    fn judged(&mut self, present: Present<'_>, plan: LoopPlan, source: MoveSource) -> Substitute {
        let Present { system, state, memory } = present;
        if let Some(check) = &mut self.check {
            let is_admissible = Some(check(state, &plan.inputs));
            let plan = LoopPlan { states: Vec::new(), ..plan };
            return Substitute { plan, source, is_admissible };
        }
        let Some(system) = system else {
            let plan = LoopPlan { states: Vec::new(), ..plan };
            return Substitute { plan, source, is_admissible: None };
        };
        let run = system.simulate_with(state, &plan, &judging(memory)).ok();
        let (plan, is_admissible) = match run.filter(Simulation::is_complete) {
            Some(run) => (LoopPlan::of_simulation(&run), true),
            None if plan.transitions.is_empty() => {
                let input = plan.inputs.first().map_or(&[][..], Vec::as_slice);
                (LoopPlan::idle(system, memory, input), false)
            }
            None => (LoopPlan { states: Vec::new(), ..plan }, false),
        };
        Substitute { plan, source, is_admissible: Some(is_admissible) }
    }
}
