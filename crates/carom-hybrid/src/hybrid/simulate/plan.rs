//! A run of names and numbers, sorted as its system is.

use super::step::StepStart;
use crate::error::{Error, RunError, check_finite, check_length};
use crate::hybrid::memory::Memory;
use crate::hybrid::rows::HybridRun;
use crate::hybrid::system::{Coordinates, HybridSystem};

/// A run in the order of its system.
pub(super) struct PlannedRun<'a> {
    pub(super) system: &'a HybridSystem,
    /// By sample, then by state; one sample more than steps.
    pub(super) states: Vec<Vec<f64>>,
    /// By step, then by input.
    pub(super) inputs: Vec<Vec<f64>>,
    /// By choice, then by step: the position of the transition in its choice.
    pub(super) taken: Vec<Vec<usize>>,
    /// By choice: the modes at all samples, if the run names them.
    modes: Vec<Option<&'a [String]>>,
    pub(super) outputs: &'a [(String, Vec<f64>)],
}

impl<'a> PlannedRun<'a> {
    /// Refuses runs of another system and of lengths that do not fit.
    pub(super) fn new(system: &'a HybridSystem, run: &'a HybridRun) -> Result<Self, Error> {
        let first = system.choices.first().map_or("", |choice| &choice.name);
        let steps = run.transitions(first)?.len();
        let mut taken = Vec::new();
        let mut modes = Vec::new();
        for choice in &system.choices {
            let names = run.transitions(&choice.name)?;
            check_length("the transitions of the run", names.len(), steps)?;
            let number = |name: &String| {
                let found = choice.transitions.iter().position(|own| own.name == *name);
                let kind = "transition of the choice";
                found.ok_or_else(|| Error::unknown_name(name, kind))
            };
            taken.push(names.iter().map(number).collect::<Result<_, Error>>()?);
            let own = run.modes(&choice.name).ok().filter(|_| !choice.modes().is_empty());
            if let Some(own) = own {
                check_length("the modes of the run", own.len(), steps + 1)?;
            }
            modes.push(own);
        }
        let states = system.states.iter().map(|(name, _)| run.state(name));
        let states = by_sample("the states of the run", states, steps + 1)?;
        let inputs = system.inputs.iter().map(|(name, _)| run.input(name));
        let mut inputs = by_sample("the inputs of the run", inputs, steps)?;
        if system.is_nonlinear() {
            for (step, input) in inputs.iter_mut().enumerate() {
                *input = system.with_function_values(&states[step], &states[step + 1], input);
            }
        }
        for (_, values) in &run.outputs {
            check_length("the outputs of the run", values.len(), steps)?;
        }
        Ok(PlannedRun { system, states, inputs, taken, modes, outputs: &run.outputs })
    }

    /// The sample and the input at which a step starts.
    pub(super) fn start<'s>(&'s self, coordinates: &'s Coordinates, step: usize) -> StepStart<'s> {
        let (state, input) = (&self.states[step], &self.inputs[step]);
        let guess = &self.states[step + 1];
        StepStart { system: self.system, coordinates, step, state, input, guess }
    }

    /// The memory at the first sample: its modes, which may have lasted for any time.
    pub(super) fn first_memory(&self) -> Result<Memory, Error> {
        let named = self.system.choices.iter().zip(&self.modes);
        let first = named.filter_map(|(choice, modes)| Some((choice, (*modes)?.first()?)));
        let memory = first.fold(Memory::default(), |memory, (choice, mode)| {
            memory.with_mode(&choice.name, mode, None)
        });
        memory.check(self.system)?;
        Ok(memory)
    }

    /// Refuses modes at a sample that differ from those in which the transitions lead.
    pub(super) fn check_modes(&self, memory: &Memory, sample: usize) -> Result<(), Error> {
        for (choice, modes) in self.system.choices.iter().zip(&self.modes) {
            let found = modes.and_then(|modes| modes.get(sample));
            let (Some(found), Some(expected)) = (found, memory.mode(&choice.name)) else {
                continue;
            };
            if found != expected {
                return Err(RunError::Mode {
                    sample,
                    choice: choice.name.clone(),
                    found: found.clone(),
                    expected: expected.to_owned(),
                }
                .into());
            }
        }
        Ok(())
    }
}

/// Lists by name turned into lists by sample.
fn by_sample<'a>(
    what: &'static str,
    lists: impl Iterator<Item = Result<&'a [f64], Error>>,
    count: usize,
) -> Result<Vec<Vec<f64>>, Error> {
    let mut samples = vec![Vec::new(); count];
    for list in lists {
        let list = list?;
        check_length(what, list.len(), count)?;
        check_finite("the run", "a value", list.iter().copied())?;
        samples.iter_mut().zip(list).for_each(|(sample, &value)| sample.push(value));
    }
    Ok(samples)
}
