//! Indicators: "binary on (or off) implies a row", as first-class statements of a model.
//!
//! An indicator says what is meant. How it becomes rows (big-M) is decided later, in
//! [`reformulate`](crate::reformulate); whether a solution obeys it is checked as an implication,
//! never through its big-M rows, in [`solution`](crate::solution).

use super::ids::Variable;
use super::row::Row;

/// A condition on a binary variable: it is on (1) or off (0).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
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

    /// The implication "if this condition holds, then the row does".
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let mut model = Model::new("m");
    /// let hit = model.binary("hit")?;
    /// let x = model.continuous("x", -1.0, 10.0)?;
    /// model.add("contact", hit.on().implies(x.le(0.0)))?;
    /// model.add("flight", hit.off().implies(x.ge(0.0)))?;
    /// # Ok::<(), carom::Error>(())
    /// ```
    pub fn implies(self, row: Row) -> Implication {
        Implication { condition: self, row, big_m: BigM::Automatic }
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

/// Where the big-M of an indicator comes from. Values are in the unit of the indicator's row.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum BigM {
    /// Derived per side from the current bounds of the row's variables.
    #[default]
    Automatic,
    /// The user's value, refused when the current bounds do not prove it.
    Given(f64),
    /// The user's value, taken on trust; listed in the report and checked on every solution.
    Assumed(f64),
}

/// An implication that has not been added to a model yet; made by [`Literal::implies`].
#[derive(Debug, Clone, PartialEq)]
#[must_use = "an implication does nothing until it is given to `Model::add`"]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Implication {
    pub(crate) condition: Literal,
    pub(crate) row: Row,
    pub(crate) big_m: BigM,
}

impl Implication {
    /// Uses this big-M (in the row's unit, for each side that needs one) instead of the automatic
    /// one. Lowering refuses it when the bounds do not prove it.
    pub fn big_m(mut self, value: f64) -> Self {
        self.big_m = BigM::Given(value);
        self
    }

    /// Takes the given big-M on trust: it is listed in the report, and a solution whose
    /// implications fail is never accepted. Without a given value this changes nothing.
    ///
    /// An assumed M that is too small cuts off plans that exist; no certificate can see plans
    /// that were cut off.
    pub fn assume_valid(mut self) -> Self {
        if let BigM::Given(value) = self.big_m {
            self.big_m = BigM::Assumed(value);
        }
        self
    }
}
