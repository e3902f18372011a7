//! The result of a simulation.

use std::fmt;

use crate::error::{DeadEnd, Error, TransitionCandidate};
use crate::hybrid::memory::Memory;
use crate::hybrid::rows::HybridRun;

/// A record of one step of a simulation.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SimulatedStep {
    /// The name of the transition that was taken, by choice.
    pub taken: Vec<String>,
    /// All transitions, by choice, whether they were possible or not.
    pub candidates: Vec<Vec<TransitionCandidate>>,
    /// How many combinations of transitions, one per choice, were possible. More than 1 means that
    /// the system does not determine the next state alone. It is counted up to 65,536.
    pub moves: usize,
    /// How many of the transitions taken are events.
    pub events: usize,
    /// Names and values of the outputs of the transitions taken, in their order; in the outputs'
    /// units.
    pub outputs: Vec<(String, f64)>,
}

/// A run of a hybrid system, computed step by step.
///
/// `{}` prints a table with a line per sample.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Simulation {
    /// Δt, in s.
    pub time_step: f64,
    /// Names of the states.
    pub state_names: Vec<String>,
    /// Names of the inputs.
    pub input_names: Vec<String>,
    /// Names of the choices.
    pub choice_names: Vec<String>,
    /// Names of the outputs.
    #[cfg_attr(feature = "serde", serde(default))]
    pub output_names: Vec<String>,
    /// The state at every sample, the first one included.
    pub states: Vec<Vec<f64>>,
    /// The modes at every sample, by choice; None without memory, and while a mode is open.
    pub modes: Vec<Vec<Option<String>>>,
    /// The input of every step that was taken.
    pub inputs: Vec<Vec<f64>>,
    /// The record of every step that was taken.
    pub steps: Vec<SimulatedStep>,
    /// The memory of the run at the last sample that was reached: modes, how long they have lasted,
    /// events.
    #[cfg_attr(feature = "serde", serde(default))]
    pub memory: Memory,
    /// Why the run ended early, if it did.
    pub dead_end: Option<DeadEnd>,
}

impl Simulation {
    /// Whether every input was used.
    pub fn is_complete(&self) -> bool {
        self.dead_end.is_none()
    }

    /// The values of a state at all samples, in its unit. `None` if there is no such state.
    pub fn state(&self, name: &str) -> Option<Vec<f64>> {
        let column = self.state_names.iter().position(|own| own == name)?;
        self.states.iter().map(|state| state.get(column).copied()).collect()
    }

    /// The state after the last input.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::DeadEnd`](crate::error::ErrorKind::DeadEnd) if the run ended before the last
    /// input.
    pub fn end(&self) -> Result<Vec<f64>, Error> {
        match &self.dead_end {
            Some(dead_end) => Err(dead_end.clone().into()),
            None => Ok(self.last().to_vec()),
        }
    }

    /// The state at the last sample that was reached; a run that ended early says why in
    /// [`dead_end`](Simulation::dead_end).
    pub fn last(&self) -> &[f64] {
        self.states.last().map_or(&[], Vec::as_slice)
    }

    /// The transitions taken, a list per step with an entry per choice, for
    /// [`SimulationOptions::with_transitions`](super::SimulationOptions::with_transitions).
    pub fn taken(&self) -> Vec<Vec<String>> {
        self.steps.iter().map(|step| step.taken.clone()).collect()
    }

    /// The steps in which several combinations of transitions were possible.
    pub fn ambiguous_steps(&self) -> Vec<usize> {
        let steps = self.steps.iter().enumerate().filter(|(_, step)| step.moves > 1);
        steps.map(|(t, _)| t).collect()
    }

    /// The number of events.
    pub fn events(&self) -> usize {
        self.steps.iter().map(|step| step.events).sum()
    }

    /// The steps that were taken, by name: for [`to_csv`](HybridRun::to_csv), for a certificate, or
    /// as a MIP start.
    pub fn to_run(&self) -> HybridRun {
        let columns = |names: &[String], samples: &[Vec<f64>]| {
            let column = |k: usize| samples.iter().filter_map(move |sample| sample.get(k)).copied();
            let named = names.iter().enumerate();
            named.map(|(k, name)| (name.clone(), column(k).collect())).collect()
        };
        let mut run = HybridRun { time_step: self.time_step, ..HybridRun::default() };
        run.states = columns(&self.state_names, &self.states);
        run.inputs = columns(&self.input_names, &self.inputs);
        for (c, choice) in self.choice_names.iter().enumerate() {
            let taken = self.steps.iter().filter_map(|step| step.taken.get(c)).cloned();
            run.transitions.push((choice.clone(), taken.collect()));
            let modes = self.modes.iter().map(|modes| modes.get(c).cloned().flatten());
            let modes: Option<Vec<String>> = modes.collect();
            run.modes.extend(modes.map(|modes| (choice.clone(), modes)));
        }
        let none = || vec![0.0; self.steps.len()];
        run.outputs = self.output_names.iter().map(|name| (name.clone(), none())).collect();
        for (t, step) in self.steps.iter().enumerate() {
            for (name, value) in &step.outputs {
                let known = run.outputs.iter().position(|(own, _)| own == name);
                let k = known.unwrap_or_else(|| {
                    run.outputs.push((name.clone(), none()));
                    run.outputs.len() - 1
                });
                run.outputs[k].1[t] += value;
            }
        }
        run
    }
}

impl fmt::Display for Simulation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:>5}", "step")?;
        for name in self.state_names.iter().chain(&self.input_names) {
            write!(f, " {name:>12}")?;
        }
        writeln!(f, "  {}", self.choice_names.join(", "))?;
        for (t, state) in self.states.iter().enumerate() {
            write!(f, "{t:>5}")?;
            for value in state.iter().chain(self.inputs.get(t).into_iter().flatten()) {
                write!(f, " {value:>12.6}")?;
            }
            if let Some(step) = self.steps.get(t) {
                write!(f, "  {}", step.taken.join(", "))?;
                if step.moves > 1 {
                    write!(f, " (one of {})", step.moves)?;
                }
            }
            writeln!(f)?;
        }
        match &self.dead_end {
            Some(end) => writeln!(f, "{end}"),
            None => Ok(()),
        }
    }
}
