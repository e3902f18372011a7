//! Comparisons of nonlinear expressions.

use super::Nonlinear;
use crate::error::Error;
use crate::model::ids::Constraint;
use crate::model::name::Name;
use crate::model::statement::{SealedStatement, Statement};
use crate::model::store::Model;

/// A comparison of a nonlinear expression, not yet added to a model.
///
/// Made by [`le`](Nonlinear::le), [`ge`](Nonlinear::ge), [`equals`](Nonlinear::equals) and
/// [`within`](Nonlinear::within).
#[derive(Debug, Clone)]
#[must_use = "a row does nothing until it is given to `Model::add`"]
pub struct NonlinearRow {
    expression: Nonlinear,
    lower: f64,
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

impl SealedStatement for NonlinearRow {}
impl Statement for NonlinearRow {
    type Handle = Constraint;

    fn add_to(self, model: &mut Model, name: Name) -> Result<Constraint, Error> {
        let NonlinearRow { expression, lower, upper } = self;
        model.all_or_nothing(|model| {
            let affine = expression.define(model, &name)?;
            model.add(name, affine.within(lower, upper))
        })
    }
}
