//! The leaves of a search tree, and the report about a seed.

use crate::model::Variable;

/// A leaf of a search tree: a box over some of the integer variables, and the bound that was proved
/// for it.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct LeafBox {
    /// Variables with their lower and upper bounds; a missing bound is infinite. Variables that are
    /// not listed have the bounds of the model.
    pub bounds: Vec<LeafBound>,
    /// The bound that was proved, in the model's own sense: no point in the box is better. It is
    /// valid only for the model that was solved.
    #[cfg_attr(feature = "serde", serde(with = "crate::wire"))]
    pub bound: f64,
}

/// Bounds of one variable of a [`LeafBox`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
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

impl LeafBound {
    /// Bounds of a variable, in its unit; infinite where there is none.
    pub fn new(variable: Variable, lower: f64, upper: f64) -> Self {
        LeafBound { variable, lower, upper }
    }
}

impl LeafBox {
    /// A box and the objective bound that was proved in it.
    pub fn new(bounds: Vec<LeafBound>, bound: f64) -> Self {
        LeafBox { bounds, bound }
    }

    /// The same box over other variables. `to` maps each variable to its replacement, or to `None`
    /// to drop its bounds.
    pub fn mapped(&self, to: impl Fn(Variable) -> Option<Variable>) -> LeafBox {
        let map = |old: &LeafBound| Some(LeafBound { variable: to(old.variable)?, ..*old });
        LeafBox { bounds: self.bounds.iter().filter_map(map).collect(), bound: self.bound }
    }
}

/// The report on a [`TreeSeed`](crate::solver::TreeSeed) after a solve.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SeedReport {
    /// The outcome of the guess; `None` if there was none or the solver did not try it.
    pub guess: Option<GuessStatus>,
    /// The report on the boxes; `None` if there were none or the root was not split.
    pub leaves: Option<LeafReport>,
    /// Number of entries that were ignored because they name a variable of another model or a
    /// continuous one, or because their value is NaN.
    pub ignored: usize,
}

/// The outcome of a guess.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum GuessStatus {
    /// The solver found a verified point with all guessed values.
    Accepted,
    /// The solver found a verified point, but these variables had to change.
    Repaired {
        /// The variables.
        changed: Vec<Variable>,
    },
    /// The solver found no point from the guess.
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
    /// For each box, in the order given, whether part of the root lies in it.
    pub used: Vec<bool>,
    /// Parts of the root that lie in a box.
    pub inside: usize,
    /// Parts of the root that lie in no box and were added to cover it; 0 if the boxes cover the
    /// root and could be separated.
    pub added: usize,
}
