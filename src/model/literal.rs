//! Conditions on one binary variable.

use super::ids::Variable;

/// A condition on a binary variable: it is on (1) or off (0).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Literal {
    pub(crate) variable: Variable,
    pub(crate) on: bool,
}

impl Literal {
    /// The binary variable.
    pub fn variable(self) -> Variable {
        self.variable
    }

    /// Whether the condition is "the variable is 1" (rather than 0).
    pub fn is_on(self) -> bool {
        self.on
    }
}

impl Variable {
    /// The condition "this binary is 1".
    pub fn on(self) -> Literal {
        Literal { variable: self, on: true }
    }

    /// The condition "this binary is 0".
    pub fn off(self) -> Literal {
        Literal { variable: self, on: false }
    }
}
