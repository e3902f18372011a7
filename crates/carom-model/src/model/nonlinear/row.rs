//! Comparisons of nonlinear expressions.

use super::Nonlinear;
use crate::error::Error;
use crate::model::affine::Affine;
use crate::model::ids::{Constraint, Indicator, Variable};
use crate::model::indicator::{Implication, Implications};
use crate::model::name::Name;
use crate::model::row::Row;
use crate::model::statement::{SealedStatement, Statement};
use crate::model::store::Model;

/// A comparison of a nonlinear expression, not yet added to a model.
///
/// Made by [`le`](Nonlinear::le), [`ge`](Nonlinear::ge), [`equals`](Nonlinear::equals) and
/// [`within`](Nonlinear::within).
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[must_use = "a row does nothing until it is given to `Model::add`"]
pub struct NonlinearRow {
    expression: Nonlinear,
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_numbers"))]
    lower: f64,
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_numbers"))]
    upper: f64,
}

impl Nonlinear {
    /// The row `self <= right`.
    pub fn le(&self, right: impl Into<Nonlinear>) -> NonlinearRow {
        NonlinearRow { expression: self - right.into(), lower: f64::NEG_INFINITY, upper: 0.0 }
    }

    /// The row `self >= right`.
    pub fn ge(&self, right: impl Into<Nonlinear>) -> NonlinearRow {
        NonlinearRow { expression: self - right.into(), lower: 0.0, upper: f64::INFINITY }
    }

    /// The row `self = right`.
    pub fn equals(&self, right: impl Into<Nonlinear>) -> NonlinearRow {
        NonlinearRow { expression: self - right.into(), lower: 0.0, upper: 0.0 }
    }

    /// The row `lower <= self <= upper`; one limit may be infinite.
    pub fn within(&self, lower: f64, upper: f64) -> NonlinearRow {
        NonlinearRow { expression: self.clone(), lower, upper }
    }
}

impl NonlinearRow {
    /// The expression that is compared.
    pub fn expression(&self) -> &Nonlinear {
        &self.expression
    }

    /// The lower limit, in the unit of the expression.
    pub fn lower(&self) -> f64 {
        self.lower
    }

    /// The upper limit, in the unit of the expression.
    pub fn upper(&self) -> f64 {
        self.upper
    }

    /// The row with other expressions in the places of its affine ones.
    #[doc(hidden)]
    pub fn try_map(
        &self,
        entry: &mut dyn FnMut(&Affine) -> Result<Affine, Error>,
    ) -> Result<NonlinearRow, Error> {
        Ok(NonlinearRow { expression: self.expression.try_map(entry)?, ..*self })
    }

    /// By how much an expression's value keeps the limits; negative if it does not.
    #[doc(hidden)]
    pub fn slack(&self, value: impl Fn(Variable) -> f64) -> f64 {
        let value = self.expression.evaluate(value);
        (value - self.lower).min(self.upper - value)
    }

    /// The row with its variables named.
    #[doc(hidden)]
    pub fn text(&self, name: &dyn Fn(Variable) -> String) -> String {
        let left = self.expression.text(name);
        match (self.lower.is_finite(), self.upper.is_finite()) {
            (true, true) if self.lower == self.upper => format!("{left} = {}", self.lower),
            (true, true) => format!("{} <= {left} <= {}", self.lower, self.upper),
            (true, false) => format!("{left} >= {}", self.lower),
            _ => format!("{left} <= {}", self.upper),
        }
    }

    /// The row over the variables of a model, which are added under a name.
    pub(in crate::model) fn define(self, model: &mut Model, name: &Name) -> Result<Row, Error> {
        Ok(self.expression.define(model, name)?.within(self.lower, self.upper))
    }
}

impl SealedStatement for NonlinearRow {}
impl Statement for NonlinearRow {
    type Handle = Constraint;

    fn add_to(self, model: &mut Model, name: Name) -> Result<Constraint, Error> {
        model.all_or_nothing(|model| {
            let row = self.define(model, &name)?;
            model.add(name, row)
        })
    }
}

impl SealedStatement for Implication<NonlinearRow> {}
impl Statement for Implication<NonlinearRow> {
    type Handle = Indicator;

    fn add_to(self, model: &mut Model, name: Name) -> Result<Indicator, Error> {
        let Implication { condition, row, big_m } = self;
        model.all_or_nothing(|model| {
            let row = row.define(model, &name)?;
            model.add(name, Implication { condition, row, big_m })
        })
    }
}

impl SealedStatement for Implications<NonlinearRow> {}
impl Statement for Implications<NonlinearRow> {
    type Handle = Vec<Indicator>;

    fn add_to(self, model: &mut Model, name: Name) -> Result<Vec<Indicator>, Error> {
        let Implications { condition, rows } = self;
        model.all_or_nothing(|model| {
            let rows = rows.into_iter().map(|row| row.define(model, &name));
            let rows = rows.collect::<Result<_, _>>()?;
            model.add(name, Implications { condition, rows })
        })
    }
}
