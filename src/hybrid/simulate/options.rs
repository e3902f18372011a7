//! How a run of a hybrid system begins and which transitions it takes.

use crate::setters::setters;

/// How [`HybridSystem::simulate_with`](crate::hybrid::HybridSystem::simulate_with) simulates.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct SimulationOptions {
    /// The modes at the first sample, as pairs of choice and mode. The mode of a choice that is
    /// not named is open, and its first transition decides.
    pub modes: Vec<(String, String)>,
    /// The transitions that are taken, by name: a list per step with an entry per choice. The run ends
    /// where one of them is not possible. In the steps after the last list, the first possible
    /// transition of each choice is taken; with several choices, the first combination whose next state
    /// is allowed, where the last choice varies first.
    pub transitions: Vec<Vec<String>>,
    /// The disturbance that is added to the next state, by step; none after the last entry.
    pub disturbances: Vec<Vec<f64>>,
    /// By how much a condition may be violated, in its unit; 1e-9 by default, for rounding. Beyond
    /// a magnitude of 1000 it grows in proportion.
    pub tolerance: f64,
}

impl Default for SimulationOptions {
    fn default() -> Self {
        SimulationOptions {
            modes: Vec::new(),
            transitions: Vec::new(),
            disturbances: Vec::new(),
            tolerance: 1e-9,
        }
    }
}

impl SimulationOptions {
    setters! {
        /// Sets the transitions that are taken, by name: a list per step with an entry per choice, as
        /// [`Simulation::taken`](super::Simulation::taken) returns them.
        with_transitions(transitions: Vec<Vec<String>>) => transitions = transitions;
        /// Sets what is added to the next state, by step, in the states' units.
        with_disturbances(disturbances: Vec<Vec<f64>>) => disturbances = disturbances;
        /// Sets by how much a condition may be violated, in its unit; finite, at least 0.
        with_tolerance(tolerance: f64) => tolerance = tolerance;
    }

    /// Sets the mode of a choice at the first sample.
    #[must_use]
    pub fn with_mode(mut self, choice: impl Into<String>, mode: impl Into<String>) -> Self {
        self.modes.push((choice.into(), mode.into()));
        self
    }
}
