//! Possible flaws in the statement of a hybrid system, in words.

use std::fmt;

/// A state and an input at which something is wrong, as pairs of name and value.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WitnessPoint {
    /// The first step for which it holds.
    pub step: usize,
    /// Names and values of the states, in their units.
    pub state: Vec<(String, f64)>,
    /// Names and values of the inputs, in their units.
    pub input: Vec<(String, f64)>,
}

impl WitnessPoint {
    /// The values of the states.
    pub fn states(&self) -> Vec<f64> {
        self.state.iter().map(|(_, value)| *value).collect()
    }

    /// The values of the inputs.
    pub fn inputs(&self) -> Vec<f64> {
        self.input.iter().map(|(_, value)| *value).collect()
    }
}

impl fmt::Display for WitnessPoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, (name, value)) in self.state.iter().chain(&self.input).enumerate() {
            write!(f, "{}{name} = {value:.6}", if k == 0 { "" } else { ", " })?;
        }
        if self.step > 0 {
            write!(f, " in step {}", self.step)?;
        }
        Ok(())
    }
}

/// Something in the statement of a hybrid system that is probably a slip, found by
/// [`HybridSystem::well_posedness`](crate::hybrid::HybridSystem::well_posedness).
///
/// `{}` says in words what is wrong and where, and ends with the [code](Self::code) in brackets.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum IllPosedness {
    /// At some states and inputs no transition of a choice is possible.
    Gap {
        /// The choice.
        choice: String,
        /// The mode, in a choice with memory.
        mode: Option<String>,
        /// The point in the gap that is the farthest from all transitions.
        witness: WitnessPoint,
        /// Its distance from them, as a fraction of the widths of domains and ranges.
        margin: f64,
    },
    /// Two transitions are possible at once, and not only on a common boundary.
    Overlap {
        /// The choice.
        choice: String,
        /// The two transitions.
        transitions: [String; 2],
        /// The point in the overlap that is the farthest from its boundary.
        witness: WitnessPoint,
        /// Its distance from the boundary, as a fraction of the widths of domains and ranges.
        margin: f64,
    },
    /// A transition is not possible anywhere.
    NeverTaken {
        /// The choice.
        choice: String,
        /// The transition.
        transition: String,
    },
    /// From a state, every transition leads out of the domain, whatever the inputs are, although
    /// some are possible there.
    Stuck {
        /// Choices and their modes, in choices with memory.
        modes: Vec<(String, String)>,
        /// The state, without inputs.
        witness: WitnessPoint,
        /// Its distance from the states that can stay inside, as a fraction of the widths of
        /// domains.
        margin: f64,
    },
}

impl IllPosedness {
    /// The section of the guide's page "Help" about it, such as `gap`.
    pub fn code(&self) -> &'static str {
        match self {
            IllPosedness::Gap { .. } => "gap",
            IllPosedness::Overlap { .. } => "overlap",
            IllPosedness::NeverTaken { .. } => "never-taken",
            IllPosedness::Stuck { .. } => "dead-end",
        }
    }
}

impl fmt::Display for IllPosedness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            IllPosedness::Gap { choice, mode, witness, .. } => {
                write!(f, "gap in `{choice}`: no transition is possible")?;
                if let Some(mode) = mode {
                    write!(f, " in the mode `{mode}`")?;
                }
                write!(f, " at {witness}; check the guards, or allow dead ends by `expect`")?;
            }
            IllPosedness::Overlap { choice, transitions: [a, b], witness, .. } => write!(
                f,
                "overlap in `{choice}`: `{a}` and `{b}` are both possible at {witness}; check the \
                 guards, or allow overlaps by `expect`"
            )?,
            IllPosedness::NeverTaken { choice, transition } => write!(
                f,
                "`{transition}` of `{choice}` is never possible; check its guards and its next state"
            )?,
            IllPosedness::Stuck { modes, witness, .. } => {
                write!(f, "no input keeps the state in its domain at {witness}")?;
                for (choice, mode) in modes {
                    write!(f, ", with `{choice}` in the mode `{mode}`")?;
                }
                write!(
                    f,
                    "; widen the domain, exclude such states by a limit, or allow dead ends by `expect`"
                )?;
            }
        }
        write!(f, " [{}]", self.code())
    }
}
