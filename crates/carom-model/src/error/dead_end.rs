//! Why a simulation ends early, and which transitions were possible there.

use std::fmt;

use super::condition::Condition;

/// A transition in one step of a simulation: whether it was possible, and by how much.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TransitionCandidate {
    /// Its name.
    pub transition: String,
    /// Whether all its conditions hold to the tolerance. With several choices, it must also be part
    /// of a combination whose next state is allowed.
    pub is_possible: bool,
    /// The condition that is the nearest to being violated, or the most violated one. None if the
    /// transition has no conditions.
    pub tightest: Option<Condition>,
    /// By how much it holds, in its unit; negative if it is violated, infinite without conditions.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_numbers"))]
    pub slack: f64,
}

impl TransitionCandidate {
    /// From its fields, in their order.
    #[doc(hidden)]
    pub fn new(
        transition: String,
        is_possible: bool,
        tightest: Option<Condition>,
        slack: f64,
    ) -> Self {
        TransitionCandidate { transition, is_possible, tightest, slack }
    }
}

impl fmt::Display for TransitionCandidate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let TransitionCandidate { transition, slack, .. } = self;
        match &self.tightest {
            None => write!(f, "`{transition}` is possible"),
            Some(condition) if self.is_possible => {
                write!(f, "`{transition}` is possible, by {slack:.3e} in {condition}")
            }
            Some(condition) if slack.is_infinite() => {
                write!(f, "`{transition}` violates {condition}")
            }
            Some(condition) => {
                write!(f, "`{transition}` violates {condition} by {:.3e}", -slack)
            }
        }
    }
}

/// Why a simulation ended before its last input.
///
/// It is an [`ErrorKind::DeadEnd`](super::ErrorKind::DeadEnd) where the end of the run is asked
/// for.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum DeadEnd {
    /// The state, or the state and the input, at a sample are not allowed.
    Sample {
        /// The sample.
        step: usize,
        /// The violated condition.
        condition: Condition,
        /// By how much, in its unit.
        violation: f64,
    },
    /// No transition of a choice is possible.
    Choice {
        /// The step.
        step: usize,
        /// The choice.
        choice: String,
        /// Its transitions, with what they violate and by how much.
        candidates: Vec<TransitionCandidate>,
    },
    /// Transitions of every choice are possible, but no combination of them is.
    Combination {
        /// The step.
        step: usize,
        /// The condition that the least violating combination violates.
        condition: Condition,
        /// By how much, in its unit.
        violation: f64,
    },
    /// A planned transition is not possible, or does not exist.
    Planned {
        /// The step.
        step: usize,
        /// The choice.
        choice: String,
        /// The planned transition; with what it violates, unless it does not exist.
        transition: String,
        /// The transition and the condition that it violates; `None` if it does not exist.
        candidate: Option<TransitionCandidate>,
    },
    /// Several transitions of a choice are possible that lead to different states or modes, and
    /// nothing says which one is taken. It is an error of the simulation, not the end of a run.
    Ambiguous {
        /// The step.
        step: usize,
        /// The choice.
        choice: String,
        /// The transitions that are possible.
        transitions: Vec<String>,
    },
}

impl DeadEnd {
    /// The step that could not be taken, or whose sample is not allowed.
    pub fn step(&self) -> usize {
        match self {
            DeadEnd::Sample { step, .. }
            | DeadEnd::Choice { step, .. }
            | DeadEnd::Combination { step, .. }
            | DeadEnd::Planned { step, .. }
            | DeadEnd::Ambiguous { step, .. } => *step,
        }
    }
}

impl fmt::Display for DeadEnd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            DeadEnd::Sample { step, condition, violation } => {
                write!(f, "sample {step} violates {condition} by {violation:.3e}")
            }
            DeadEnd::Choice { step, choice, candidates } => {
                write!(f, "no transition of `{choice}` is possible in step {step}: ")?;
                for (k, candidate) in candidates.iter().enumerate() {
                    write!(f, "{}{candidate}", if k == 0 { "" } else { ", " })?;
                }
                Ok(())
            }
            DeadEnd::Combination { step, condition, violation } => write!(
                f,
                "no combination of transitions is possible in step {step}: the best one violates \
                 {condition} by {violation:.3e}"
            ),
            DeadEnd::Planned { step, choice, transition, candidate } => {
                write!(f, "the plan for `{choice}` is not possible in step {step}: ")?;
                match candidate {
                    Some(candidate) => write!(f, "{candidate}"),
                    None => write!(f, "there is no transition `{transition}`"),
                }
            }
            DeadEnd::Ambiguous { step, choice, transitions } => {
                write!(
                    f,
                    "step {step} is ambiguous: `{}` of `{choice}` are possible and lead to different \
                     states or modes, and nothing says which one is taken; simulate the whole move of a \
                     controller (`simulate(state, &next)`), name transitions by \
                     `SimulationOptions::with_transitions` and modes by `with_mode`, or allow the first one \
                     by `with_first_possible`",
                    transitions.join("` and `")
                )
            }
        }
    }
}

impl std::error::Error for DeadEnd {}
