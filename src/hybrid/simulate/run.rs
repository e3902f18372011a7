//! Runs of a hybrid system, step by step.

use super::memory::Memory;
use super::options::SimulationOptions;
use super::simulation::Simulation;
use super::step::{StepStart, sample_conditions};
use super::stepper::{Stepper, Taken, violated};
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::error::{Error, check_finite, check_length};
use crate::hybrid::system::{HybridSystem, Transition};
use crate::interval::Interval;

impl HybridSystem {
    /// Simulates the system from a state under given inputs, with the default
    /// [`SimulationOptions`]: the modes at the first sample are open, and among several possible
    /// transitions the first in the list is taken. Each step says which ones were possible.
    ///
    /// # Arguments
    ///
    /// * `state`: the first sample, an entry per state.
    /// * `inputs`: the input of every step, an entry per input of the system.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// // Drag doubles from 10 m/s on.
    /// let mut vehicle = HybridSystem::new(1.0); // s
    /// let v = vehicle.state("v", 0.0, 30.0)?; // m/s
    /// let thrust = vehicle.input("thrust", 0.0, 3.0)?; // m/s²
    /// vehicle.mode("slow")?.next([v.is(0.9 * v + thrust)])?.guard(v.le(10.0))?;
    /// vehicle.mode("fast")?.next([v.is(0.8 * v + thrust)])?.guard(v.ge(10.0))?;
    ///
    /// let run = vehicle.simulate(&[20.0], &[[0.0], [0.0], [0.0], [0.0]])?;
    /// assert!(run.is_complete());
    /// assert_eq!(run.steps[3].taken, ["fast"]);
    /// assert!((run.last()[0] - 8.192).abs() < 1e-12);
    ///
    /// // At exactly 10 m/s the speed after the step is one of two.
    /// let tie = vehicle.simulate(&[10.0], &[[0.0]])?;
    /// assert_eq!((tie.ambiguous_steps(), tie.steps[0].moves), (vec![0], 2));
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Those of [`HybridSystem::check`]; [`ErrorKind::Length`] and [`ErrorKind::NotFinite`] for the
    /// state and the inputs. A state or an input that the system does not allow is no error: the
    /// simulation ends there, and [`Simulation::dead_end`] says why.
    pub fn simulate<U: AsRef<[f64]>>(
        &self,
        state: &[f64],
        inputs: &[U],
    ) -> Result<Simulation, Error> {
        self.simulate_with(state, inputs, &SimulationOptions::default())
    }

    /// Simulates the system with first modes, planned transitions or disturbances.
    ///
    /// # Errors
    ///
    /// As for [`simulate`](HybridSystem::simulate); [`ErrorKind::UnknownName`] for a mode that does
    /// not exist, [`ErrorKind::OutOfRange`] for a disturbance outside the system's and for a
    /// tolerance below 0.
    pub fn simulate_with<U: AsRef<[f64]>>(
        &self,
        state: &[f64],
        inputs: &[U],
        options: &SimulationOptions,
    ) -> Result<Simulation, Error> {
        self.check()?;
        self.check_simulation(state, inputs, options)?;
        let mut memory = Memory::new(self, &options.modes)?;
        let modes = |memory: &Memory| {
            let modes = (0..self.choices.len()).map(|c| memory.mode(c).map(str::to_owned));
            modes.collect::<Vec<_>>()
        };
        let names = |names: Vec<&String>| names.into_iter().cloned().collect();
        let mut run = Simulation {
            time_step: self.time_step,
            state_names: names(self.states.iter().map(|(name, _)| name).collect()),
            input_names: names(self.inputs.iter().map(|(name, _)| name).collect()),
            choice_names: names(self.choices.iter().map(|choice| &choice.name).collect()),
            output_names: self.output_names(),
            states: vec![state.to_vec()],
            modes: vec![modes(&memory)],
            inputs: Vec::new(),
            steps: Vec::new(),
            dead_end: violated(0, sample_conditions(self, 0, state), options.tolerance),
        };
        let mut state = state.to_vec();
        for (step, input) in inputs.iter().enumerate() {
            if run.dead_end.is_some() {
                break;
            }
            let start = StepStart { system: self, step, state: &state, input: input.as_ref() };
            let disturbance = options.disturbances.get(step).map_or(&[][..], Vec::as_slice);
            let plan = options.transitions.get(step).map(Vec::as_slice);
            let stepper = Stepper { start, memory: &memory, options, disturbance };
            match stepper.take(plan)? {
                Err(end) => run.dead_end = Some(end),
                Ok(Taken { picked, next, report }) => {
                    let taken = self.choices.iter().zip(picked);
                    let taken = taken.filter_map(|(choice, k)| choice.transitions.get(k));
                    let transitions: Vec<&Transition> = taken.collect();
                    for (choice, transition) in transitions.iter().enumerate() {
                        memory.advance(choice, transition);
                    }
                    run.inputs.push(input.as_ref().to_vec());
                    run.steps.push(report);
                    run.states.push(next.clone());
                    run.modes.push(modes(&memory));
                    if let (Some(first), 0) = (run.modes.first_mut(), step) {
                        // The first transition has decided on a mode that was open.
                        for (mode, transition) in first.iter_mut().zip(&transitions) {
                            *mode = transition.modes.as_ref().map(|(from, _)| from.clone());
                        }
                    }
                    state = next;
                }
            }
        }
        Ok(run)
    }

    fn check_simulation<U: AsRef<[f64]>>(
        &self,
        state: &[f64],
        inputs: &[U],
        options: &SimulationOptions,
    ) -> Result<(), Error> {
        let (n, m) = (self.states.len(), self.inputs.len());
        check_length("the state", state.len(), n)?;
        check_finite("the simulation", "an entry of the state", state.iter().copied())?;
        for input in inputs.iter().map(AsRef::as_ref) {
            check_length("the input", input.len(), m)?;
            check_finite("the simulation", "an entry of an input", input.iter().copied())?;
        }
        if !(options.tolerance.is_finite() && options.tolerance >= 0.0) {
            let what = "the tolerance of the simulation";
            return Err(Error::out_of_range(what, options.tolerance, "finite and at least 0"));
        }
        for disturbance in &options.disturbances {
            check_length("the disturbance", disturbance.len(), n)?;
            for (i, ((name, _), &value)) in self.states.iter().zip(disturbance).enumerate() {
                let range = self.disturbance.get(i).copied();
                let range = range.unwrap_or(Interval::point(0.0));
                if !range.contains(value) {
                    let what = format!("the disturbance of `{name}`");
                    let range = format!("from {} to {}", range.lower, range.upper);
                    return Err(Error::out_of_range(what, value, range));
                }
            }
        }
        for step in &options.transitions {
            check_length("the planned transitions of a step", step.len(), self.choices.len())?;
        }
        Ok(())
    }
}
