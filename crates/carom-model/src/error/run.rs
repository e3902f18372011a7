//! The disagreement of a run and its system.

use thiserror::Error;

use super::condition::Condition;

/// A run of a hybrid system that does not satisfy what the system states.
///
/// It is an [`ErrorKind::Run`](super::ErrorKind::Run).
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum RunError {
    /// A sample is not where the transitions of the step before lead.
    #[error(
        "the run is not certified: `{state}` at sample {sample} is off by {residual:.3e} from where \
         step {} leads, more than {allowed:.0e}; tighten the solver's feasibility tolerance",
        sample - 1
    )]
    State {
        /// The sample, from 1 on.
        sample: usize,
        /// The state.
        state: String,
        /// The difference, in the state's unit.
        residual: f64,
        /// The largest allowed difference, in the same unit.
        allowed: f64,
    },
    /// A sample, or a sample and the input there, violates a limit of the system.
    #[error(
        "the run is not certified: sample {sample} violates {condition} by {violation:.3e}; tighten \
         the solver's feasibility tolerance"
    )]
    Sample {
        /// The sample.
        sample: usize,
        /// The violated condition.
        condition: Condition,
        /// By how much, in its unit.
        violation: f64,
    },
    /// A transition is not possible in its step.
    #[error(
        "the run is not certified: the transition `{transition}` of `{choice}` in step {step} \
         violates {condition} by {violation:.3e}; tighten the solver's feasibility tolerance"
    )]
    Transition {
        /// The step.
        step: usize,
        /// The choice.
        choice: String,
        /// The transition.
        transition: String,
        /// The violated condition.
        condition: Condition,
        /// By how much, in its unit; infinite for a condition that holds or not.
        violation: f64,
    },
    /// The run names another mode than the one in which its transitions lead.
    #[error(
        "the run is not certified: it has the mode `{found}` of `{choice}` at sample {sample}, but \
         its transitions lead to `{expected}`; check the rows that link modes and transitions"
    )]
    Mode {
        /// The sample.
        sample: usize,
        /// The choice.
        choice: String,
        /// The mode of the run.
        found: String,
        /// The mode in which its transitions lead.
        expected: String,
    },
    /// An output differs from what the transitions of the step give.
    #[error(
        "the run is not certified: the output `{output}` in step {step} is off by {residual:.3e}, \
         more than {allowed:.0e}; tighten the solver's feasibility tolerance"
    )]
    Output {
        /// The step.
        step: usize,
        /// The output.
        output: String,
        /// The difference, in the output's unit.
        residual: f64,
        /// The largest allowed difference, in the same unit.
        allowed: f64,
    },
    /// The samples leave the run to which the inputs and transitions lead from the first one,
    /// because the system multiplies what they miss.
    #[error(
        "the run is not certified: the plan lives on violations within the tolerance: {violation:.0e} at \
         step {step} grows to {drift:.2e} (state `{state}` at sample {sample}), more than {allowed:.0e}; \
         leave its inputs room to correct that, or shorten the horizon"
    )]
    Drift {
        /// The step in which a sample misses what grows the most.
        step: usize,
        /// By how much it does so, in the state's unit.
        violation: f64,
        /// The sample, from 0 on, at which the plan has left the run the farthest.
        sample: usize,
        /// The state.
        state: String,
        /// The difference there, in the state's unit.
        drift: f64,
        /// The largest allowed difference, in the same unit.
        allowed: f64,
    },
}
