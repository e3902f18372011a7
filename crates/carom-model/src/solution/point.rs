//! Values of all variables of one model.

use std::cell::Cell;

use crate::error::{Error, ErrorKind, check_length};
use crate::model::{Affine, Literal, Model, ModelTag, Quadratic, Selected, Variable};

/// One value per variable of a model, read through handles.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Point {
    tag: ModelTag,
    values: Vec<f64>,
}

impl Point {
    /// A point from one value per variable, in the order of creation.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Length`] when the number of values is not the number of variables.
    #[inline]
    pub fn new(model: &Model, values: Vec<f64>) -> Result<Self, Error> {
        check_length("the point", values.len(), model.variable_count())?;
        Ok(Point { tag: model.tag(), values })
    }

    /// Whether a binary, or a condition, is on: whether its value is above 1/2.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`] for a handle of another model.
    #[inline]
    pub fn is_on(&self, of: impl Evaluate) -> Result<bool, Error> {
        Ok(self.value(of)? > 0.5)
    }

    /// Value of a variable or an expression.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`] for a handle of another model.
    #[inline]
    pub fn value(&self, of: impl Evaluate) -> Result<f64, Error> {
        of.evaluate_at(self)
    }

    /// Which term of a disjunction is selected, counted from 0; `None` unless exactly one is.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`] for a disjunction of another model.
    pub fn selected(&self, of: &Selected) -> Result<Option<usize>, Error> {
        let mut selected = Vec::new();
        for (k, selector) in of.selectors.iter().enumerate() {
            if self.value(selector)?.round() == 1.0 {
                selected.push(k);
            }
        }
        Ok(if let [only] = selected[..] { Some(only) } else { None })
    }

    /// The values, in the order in which the variables were created.
    #[inline]
    pub fn as_slice(&self) -> &[f64] {
        &self.values
    }

    fn read(&self, variable: Variable) -> Result<f64, Error> {
        if variable.tag != self.tag || variable.index() >= self.values.len() {
            let (kind, index) = ("variable", variable.index());
            let (place, name) = ("a solution".to_owned(), None);
            return Err(ErrorKind::ForeignHandle { kind, index, place, name }.into());
        }
        Ok(self.values[variable.index()])
    }
}

/// Something that has a value at a [`Point`]: a variable, a condition or an expression.
pub trait Evaluate {
    /// The value at the point.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`] for a handle of another model.
    fn evaluate_at(&self, point: &Point) -> Result<f64, Error>;
}

impl Evaluate for Variable {
    fn evaluate_at(&self, point: &Point) -> Result<f64, Error> {
        point.read(*self)
    }
}

/// 1 if the condition holds, 0 otherwise.
impl Evaluate for Literal {
    fn evaluate_at(&self, point: &Point) -> Result<f64, Error> {
        let value = point.read(self.variable())?;
        Ok(if self.is_on() { value } else { 1.0 - value })
    }
}

impl Evaluate for Affine {
    fn evaluate_at(&self, point: &Point) -> Result<f64, Error> {
        reading(point, |value| self.evaluate(value))
    }
}

impl Evaluate for Quadratic {
    fn evaluate_at(&self, point: &Point) -> Result<f64, Error> {
        reading(point, |value| self.evaluate(value))
    }
}

/// The value of an expression, or the first error from reading its variables.
fn reading(
    point: &Point,
    evaluate: impl FnOnce(&dyn Fn(Variable) -> f64) -> f64,
) -> Result<f64, Error> {
    let failed = Cell::new(None);
    let value = evaluate(&|variable| {
        point.read(variable).unwrap_or_else(|error| {
            failed.set(Some(failed.take().unwrap_or(error)));
            f64::NAN
        })
    });
    failed.into_inner().map_or(Ok(value), Err)
}

impl<T: Evaluate + ?Sized> Evaluate for &T {
    fn evaluate_at(&self, point: &Point) -> Result<f64, Error> {
        (**self).evaluate_at(point)
    }
}
