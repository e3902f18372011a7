//! How a run of a hybrid system begins and which transitions it takes.

use crate::hybrid::memory::Memory;
use crate::setters::setters;

/// How [`HybridSystem::simulate_with`](crate::hybrid::HybridSystem::simulate_with) simulates.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct SimulationOptions {
    /// Modes, how long they have lasted and the number of events at the first sample. The mode of a
    /// choice that is not named is open, and its first transition decides.
    pub memory: Memory,
    /// The transitions that are taken, by name: a list per step with an entry per choice. The run
    /// ends where one of them is not possible. In the steps after the last list, the only possible
    /// ones are taken.
    pub transitions: Vec<Vec<String>>,
    /// The disturbance that is added to the next state, by step; none after the last entry.
    pub disturbances: Vec<Vec<f64>>,
    /// By how much a condition may be violated, in its unit; 1e-9 by default, for rounding. Beyond
    /// a magnitude of 1000 it grows in proportion.
    pub tolerance: f64,
    /// Whether the first transition is taken where several are possible that lead to different
    /// states or modes and nothing says which, instead of an error; false by default. With several
    /// choices it is the first combination whose next state is allowed, where the last choice
    /// varies first.
    pub first_possible: bool,
    /// Whether a run ends where a domain or a limit of the system is violated; true by default. A
    /// plant goes on beyond what is allowed: guards, ranges of inputs and modes still say what is
    /// possible.
    pub keeps_limits: bool,
    /// Whether another transition is taken where one that is named is not possible.
    pub(crate) prefers: bool,
}

impl Default for SimulationOptions {
    fn default() -> Self {
        SimulationOptions {
            memory: Memory::default(),
            transitions: Vec::new(),
            disturbances: Vec::new(),
            tolerance: 1e-9,
            first_possible: false,
            keeps_limits: true,
            prefers: false,
        }
    }
}

impl SimulationOptions {
    setters! {
        /// Sets the modes, how long they have lasted and the number of events at the first sample.
        with_memory(memory: Memory) => memory = memory;
        /// Sets the transitions that are taken, by name: a list per step with an entry per choice,
        /// as [`Simulation::taken`](super::Simulation::taken) returns them.
        with_transitions(transitions: Vec<Vec<String>>) => transitions = transitions;
        /// Sets what is added to the next state, by step, in the states' units.
        with_disturbances(disturbances: Vec<Vec<f64>>) => disturbances = disturbances;
        /// Sets by how much a condition may be violated, in its unit; finite, at least 0.
        with_tolerance(tolerance: f64) => tolerance = tolerance;
        /// Sets whether the first of several possible transitions is taken where they lead to
        /// different states or modes, instead of an error.
        with_first_possible(first_possible: bool) => first_possible = first_possible;
        /// Sets whether a run ends where a domain or a limit of the system is violated.
        with_limits(keeps_limits: bool) => keeps_limits = keeps_limits;
    }

    /// Sets the mode of a choice at the first sample, which may have lasted for any time.
    #[must_use]
    pub fn with_mode(mut self, choice: impl Into<String>, mode: impl Into<String>) -> Self {
        self.memory = self.memory.with_mode(choice, mode, None);
        self
    }
}
