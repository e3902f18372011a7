//! The leaves of a search tree.

use crate::model::Variable;

/// A leaf of a search tree: a box over some of the integer variables, and the bound that was proved
/// for it.
#[doc(hidden)]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct LeafBox {
    /// Variables with their lower and upper bounds; a missing bound is infinite. Variables that are
    /// not listed have the bounds of the model.
    pub bounds: Vec<LeafBound>,
    /// The bound that was proved, in the model's own sense: no point in the box is better. It is
    /// valid only for the model that was solved.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_numbers"))]
    pub bound: f64,
}

impl LeafBox {
    /// A box; the fields say what each part means.
    pub fn new(bounds: Vec<LeafBound>, bound: f64) -> Self {
        LeafBox { bounds, bound }
    }
}

/// Bounds of one variable of a [`LeafBox`].
#[doc(hidden)]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct LeafBound {
    /// The variable.
    pub variable: Variable,
    /// Its lower bound, in the variable's unit.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_numbers"))]
    pub lower: f64,
    /// Its upper bound, in the variable's unit.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_numbers"))]
    pub upper: f64,
}

impl LeafBound {
    /// The bounds of a variable.
    pub fn new(variable: Variable, [lower, upper]: [f64; 2]) -> Self {
        LeafBound { variable, lower, upper }
    }
}
