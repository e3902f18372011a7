//! The guess that a step hands to the next one: the integers of the last plan, moved ahead.

use std::collections::BTreeMap;

use super::fallback::judging;
use super::loop_plan::LoopPlan;
use crate::error::Error;
use crate::hybrid::memory::Memory;
use crate::hybrid::rows::SystemVariables;
use crate::model::{Model, Variable};
use crate::solution::Point;
use crate::solver::MipStart;

/// The integers of the last plan by name, for programs that are built anew in each step.
#[derive(Debug, Default)]
pub(super) struct LastIntegers {
    /// By family and step.
    values: BTreeMap<(String, Option<usize>), f64>,
    /// Steps since the plan.
    ahead: usize,
}

impl LastIntegers {
    /// Takes in a plan for the present step.
    pub(super) fn take_in(&mut self, model: &Model, point: &Point) -> Result<(), Error> {
        self.values.clear();
        self.ahead = 0;
        for variable in model.variables().filter(|variable| variable.kind().is_integral()) {
            let name = variable.name();
            let key = (name.family().to_owned(), name.step());
            self.values.insert(key, point.value(variable.id())?.round());
        }
        Ok(())
    }

    /// A step passes.
    pub(super) fn shift(&mut self) {
        self.ahead += 1;
    }

    /// The values of the same integers in another model, moved ahead, the earliest steps first.
    /// Behind the end of the last plan, its last values go on.
    pub(super) fn start(&self, model: &Model) -> Option<MipStart> {
        let mut guess: Vec<(Option<usize>, Variable, f64)> = Vec::new();
        for variable in model.variables().filter(|variable| variable.kind().is_integral()) {
            let (family, step) = (variable.name().family().to_owned(), variable.name().step());
            let value = match step {
                None => self.values.get(&(family, None)),
                Some(step) => {
                    let from = (family.clone(), Some(0));
                    let to = (family, Some(step + self.ahead));
                    self.values.range(from..=to).next_back().map(|(_, value)| value)
                }
            };
            guess.extend(value.map(|&value| (step, variable.id(), value)));
        }
        guess.sort_by_key(|&(step, ..)| step);
        let guess: Vec<(Variable, f64)> =
            guess.into_iter().map(|(_, v, value)| (v, value)).collect();
        (!guess.is_empty()).then(|| MipStart::new().with_values(guess))
    }
}

/// The transitions and modes that a simulation of the rest of the last plan takes from a measured
/// state, as far as it comes: those of the plan where they are possible.
pub(super) fn simulated(
    program: &SystemVariables,
    state: &[f64],
    memory: &Memory,
    rest: &LoopPlan,
) -> Result<Option<MipStart>, Error> {
    let run = program.system().simulate_with(state, rest, &judging(memory));
    let Ok(run) = run else { return Ok(None) };
    let mut guess = Vec::new();
    let steps = program.horizon().steps();
    for (t, step) in run.steps.iter().enumerate().take(steps) {
        for (choice, taken) in program.system().choices.iter().zip(&step.taken) {
            guess.extend(program.taken(&choice.name, taken, t)?);
        }
    }
    for (t, modes) in run.modes.iter().enumerate().take(steps + 1) {
        for (choice, mode) in program.system().choices.iter().zip(modes) {
            if let Some(mode) = mode {
                guess.extend(program.mode(&choice.name, mode, t)?);
            }
        }
    }
    let value = |literal: crate::model::Literal| {
        (literal.variable(), if literal.is_on() { 1.0 } else { 0.0 })
    };
    let guess: Vec<(Variable, f64)> = guess.into_iter().map(value).collect();
    Ok((!guess.is_empty()).then(|| MipStart::new().with_values(guess)))
}
