//! The conditions that a step or a sample of a run has to satisfy, by name.

use std::fmt;

/// A condition on a step or a sample of a run, for reports.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Condition {
    /// A guard on the start of the step.
    Guard {
        /// Its name.
        name: String,
    },
    /// A guard on the prediction.
    PredictionGuard {
        /// Its name.
        name: String,
    },
    /// The range of an input.
    InputRange {
        /// The input.
        input: String,
    },
    /// The domain of a state.
    Domain {
        /// The state.
        state: String,
    },
    /// A limit of the system.
    Limit {
        /// Its name.
        name: String,
    },
    /// The transition begins in this mode. It has no slack: it holds or not.
    Mode {
        /// The mode.
        mode: String,
    },
    /// The mode is kept long enough before it is left; the slack is a number of samples.
    LeastDwell {
        /// The mode.
        mode: String,
    },
    /// The mode is not kept too long; the slack is a number of samples.
    MostDwell {
        /// The mode.
        mode: String,
    },
    /// The run has not too many events; the slack is a number of events.
    MostEvents,
}

impl fmt::Display for Condition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Condition::Guard { name } => write!(f, "the guard `{name}`"),
            Condition::PredictionGuard { name } => {
                write!(f, "the guard `{name}` on the prediction")
            }
            Condition::InputRange { input } => write!(f, "the range of `{input}`"),
            Condition::Domain { state } => write!(f, "the domain of `{state}`"),
            Condition::Limit { name } => write!(f, "the limit `{name}`"),
            Condition::Mode { mode } => write!(f, "the start in the mode `{mode}`"),
            Condition::LeastDwell { mode } => write!(f, "the least time in the mode `{mode}`"),
            Condition::MostDwell { mode } => write!(f, "the longest time in the mode `{mode}`"),
            Condition::MostEvents => write!(f, "the limit on the number of events"),
        }
    }
}
