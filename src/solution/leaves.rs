//! What is left of a tree, and what became of what was handed over.

use crate::model::Variable;

/// An end of a search tree: a box over some of the integer variables, and the bound that was proved
/// for it.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LeafBox {
    /// Variables with their lower and upper bounds; those that are not named have the model's.
    /// Infinite where there is no bound.
    pub bounds: Vec<LeafBound>,
    /// The bound that was proved, in the model's own sense: no point in the box is better. It holds
    /// for the model that was solved and for no other.
    #[cfg_attr(feature = "serde", serde(with = "crate::wire"))]
    pub bound: f64,
}

/// Bounds of one variable of a [`LeafBox`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LeafBound {
    /// The variable.
    pub variable: Variable,
    /// Its lower bound, in the variable's unit.
    #[cfg_attr(feature = "serde", serde(with = "crate::wire"))]
    pub lower: f64,
    /// Its upper bound, in the variable's unit.
    #[cfg_attr(feature = "serde", serde(with = "crate::wire"))]
    pub upper: f64,
}

impl LeafBox {
    /// The box over other variables: `to` says which one takes the place of a variable, and drops
    /// its bounds where it says `None`.
    pub fn mapped(&self, to: impl Fn(Variable) -> Option<Variable>) -> LeafBox {
        let map = |old: &LeafBound| Some(LeafBound { variable: to(old.variable)?, ..*old });
        LeafBox { bounds: self.bounds.iter().filter_map(map).collect(), bound: self.bound }
    }
}

/// What became of a [`TreeSeed`](crate::solver::TreeSeed).
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SeedReport {
    /// What became of the guess, if there was one and it was tried.
    pub guess: Option<GuessStatus>,
    /// What became of the boxes, if there were any and the root was split.
    pub leaves: Option<LeafReport>,
    /// How many entries named variables of another model, continuous ones, or values that are no
    /// numbers; they were passed over.
    pub ignored: usize,
}

/// What became of a guess.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum GuessStatus {
    /// A verified point with all guessed values was found.
    Accepted,
    /// A verified point was found, but these variables had to take other values.
    Repaired {
        /// The variables.
        changed: Vec<Variable>,
    },
    /// No point was found from it.
    Rejected {
        /// Why, in words.
        reason: String,
    },
}

/// How the root was divided along the boxes of a seed. The parts always cover the root.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LeafReport {
    /// By box, in the order given: whether a part of the root lies in it.
    pub used: Vec<bool>,
    /// Parts of the root that lie in a box.
    pub inside: usize,
    /// Parts of the root that lie in none, added to cover it; 0 when the boxes cover the root and
    /// were not too entangled to be told apart.
    pub added: usize,
}
