//! Runs of a hybrid system, step by step.

use super::decisions::{Decided, Decisions};
use super::options::SimulationOptions;
use super::simulation::Simulation;
use super::step::{StepStart, sample_conditions};
use super::stepper::{Stepper, Taken, violated};
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::error::{Error, check_finite, check_length};
use crate::hybrid::memory::Memory;
use crate::hybrid::system::{Coordinates, HybridSystem, Transition};
use crate::interval::Interval;

impl HybridSystem {
    /// Simulates the system from a state, with the default [`SimulationOptions`]: where nothing
    /// says which transitions are taken, the only possible ones are. Each step says which ones were
    /// possible.
    ///
    /// Where several are possible that lead to different states or modes, an error says so, because
    /// the run that is taken may not be the one that was meant: a step of a controller is simulated
    /// as the whole [`ControlMove`](crate::hybrid::ControlMove), which has the transitions of its
    /// plan. At a tie on a boundary that their guards share, the first one is taken.
    ///
    /// # Arguments
    ///
    /// * `state`: the first sample, an entry per state.
    /// * `decided`: the input of every step, an entry per input of the system; or a move.
    ///   Conditions then hold to the tolerance of plans, and those of domains and limits only if
    ///   the move is admissible.
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
    /// state and the inputs; [`ErrorKind::DeadEnd`] with [`DeadEnd::Ambiguous`] for a step in
    /// which nothing says what is taken. A state or an input that the system does not allow is no
    /// error: the simulation ends there, and [`Simulation::dead_end`] says why.
    ///
    /// [`DeadEnd::Ambiguous`]: super::DeadEnd::Ambiguous
    pub fn simulate<D: Decisions + ?Sized>(
        &self,
        state: &[f64],
        decided: &D,
    ) -> Result<Simulation, Error> {
        self.simulate_with(state, decided, &SimulationOptions::default())
    }

    /// Simulates the system with first modes, planned transitions or disturbances. Where the
    /// options and a move both name transitions or a memory, those of the options count.
    ///
    /// # Errors
    ///
    /// As for [`simulate`](HybridSystem::simulate); [`ErrorKind::UnknownName`] for a mode that does
    /// not exist, [`ErrorKind::OutOfRange`] for a disturbance outside the system's and for a
    /// tolerance below 0.
    pub fn simulate_with<D: Decisions + ?Sized>(
        &self,
        state: &[f64],
        decided: &D,
        options: &SimulationOptions,
    ) -> Result<Simulation, Error> {
        self.check()?;
        let mut decided = decided.decided();
        let inputs: Vec<Vec<f64>> =
            decided.inputs.iter().map(|input| self.with_places(input)).collect();
        decided.inputs = inputs.iter().map(Vec::as_slice).collect();
        self.check_simulation(state, &decided.inputs, options)?;
        let coordinates = &Coordinates::of(self);
        let mut memory = match decided.memory {
            Some(memory) if options.memory == Memory::default() => memory.clone(),
            _ => options.memory.clone(),
        };
        memory.check(self)?;
        let mut options = options.clone();
        options.keeps_limits &= !decided.is_beyond_limits;
        options.tolerance = options.tolerance.max(decided.tolerance);
        let options = &options;
        let modes = |memory: &Memory| {
            let modes = self.choices.iter().map(|own| memory.mode(&own.name).map(str::to_owned));
            modes.collect::<Vec<_>>()
        };
        let first = match options.keeps_limits {
            true => violated(0, sample_conditions(self, coordinates, 0, state), options.tolerance),
            false => None,
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
            memory: memory.clone(),
            dead_end: first,
        };
        let mut state = state.to_vec();
        for (step, input) in decided.inputs.iter().enumerate() {
            if run.dead_end.is_some() {
                break;
            }
            let filled = self.with_function_values(&state, &state, input);
            let (own, guess) = (&state, &state);
            let start =
                StepStart { system: self, coordinates, step, state: own, input: &filled, guess };
            let disturbance = options.disturbances.get(step).map_or(&[][..], Vec::as_slice);
            let plan = self.planned(step, &decided, options);
            let stepper = Stepper { start, memory: &memory, options, disturbance };
            match stepper.take(&plan)? {
                Err(end) => run.dead_end = Some(end),
                Ok(Taken { picked, next, report }) => {
                    let taken = self.choices.iter().zip(picked);
                    let taken = taken.filter_map(|(choice, k)| choice.transitions.get(k));
                    let transitions: Vec<&Transition> = taken.collect();
                    for (choice, transition) in self.choices.iter().zip(&transitions) {
                        memory.advance(&choice.name, transition);
                    }
                    run.memory = memory.clone();
                    run.inputs.push(self.with_function_values(&state, &next, input));
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

    /// The transitions that are named for a step, by choice.
    fn planned<'a>(
        &self,
        step: usize,
        decided: &Decided<'a>,
        options: &'a SimulationOptions,
    ) -> Vec<Option<&'a str>> {
        match options.transitions.get(step) {
            Some(names) => names.iter().map(|name| Some(name.as_str())).collect(),
            None => {
                let own = self.choices.iter().map(|choice| decided.transition(step, &choice.name));
                own.collect()
            }
        }
    }

    fn check_simulation(
        &self,
        state: &[f64],
        inputs: &[&[f64]],
        options: &SimulationOptions,
    ) -> Result<(), Error> {
        let (n, m) = (self.states.len(), self.inputs.len());
        check_length("the state", state.len(), n)?;
        check_finite("the simulation", "an entry of the state", state.iter().copied())?;
        for input in inputs {
            check_length("the input", input.len(), m)?;
            check_finite("the simulation", "an entry of an input", input.iter().copied())?;
        }
        if !(options.tolerance.is_finite() && options.tolerance >= 0.0) {
            let what = "the tolerance of the simulation";
            return Err(Error::out_of_range(what, options.tolerance, 0.0..f64::INFINITY));
        }
        for disturbance in &options.disturbances {
            check_length("the disturbance", disturbance.len(), n)?;
            for (i, ((name, _), &value)) in self.states.iter().zip(disturbance).enumerate() {
                let range = self.disturbance.get(i).copied();
                let range = range.unwrap_or(Interval::point(0.0));
                if !range.contains(value) {
                    let what = format!("the disturbance of `{name}`");
                    let Interval { lower, upper } = range;
                    let words = format!("from {lower} to {upper}");
                    return Err(Error::out_of_range_in_words(what, value, lower..=upper, words));
                }
            }
        }
        for step in &options.transitions {
            check_length("the planned transitions of a step", step.len(), self.choices.len())?;
        }
        Ok(())
    }
}
