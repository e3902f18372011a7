//! Conditions on one binary variable.

use super::affine::Affine;
use super::ids::Variable;

/// A condition on a binary variable: it is on (1) or off (0).
///
/// In an expression it is 1 where it holds and 0 elsewhere.
///
/// ```
/// use carom::prelude::*;
///
/// let mut model = Model::new("m");
/// let pump = model.binary_family("pump", 2)?;
/// model.add("most", (pump[0].on() + pump[1].off()).le(1.0))?;
/// model.minimize(3.0 * pump[0].off() + 5.0 * pump[1])?;
/// assert!(model.to_string().contains("minimize -3 pump[0] + 5 pump[1] + 3\n"));
/// assert!(model.to_string().contains("most: pump[0] - pump[1] <= 0\n"));
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Literal {
    pub(crate) variable: Variable,
    pub(crate) on: bool,
}

impl Literal {
    /// The binary variable.
    #[inline]
    pub fn variable(self) -> Variable {
        self.variable
    }

    /// Whether the condition is "the variable is 1" (rather than 0).
    #[inline]
    pub fn is_on(self) -> bool {
        self.on
    }
}

impl From<Literal> for Affine {
    fn from(Literal { variable, on }: Literal) -> Self {
        let (constant, sign) = if on { (0.0, 1.0) } else { (1.0, -1.0) };
        let mut value = Affine::constant(constant);
        value.add_term(sign, variable);
        value
    }
}

impl From<&Literal> for Affine {
    fn from(literal: &Literal) -> Self {
        Affine::from(*literal)
    }
}

impl Variable {
    /// The condition "this binary is 1".
    #[inline]
    pub fn on(self) -> Literal {
        Literal { variable: self, on: true }
    }

    /// The condition "this binary is 0".
    #[inline]
    pub fn off(self) -> Literal {
        Literal { variable: self, on: false }
    }
}
