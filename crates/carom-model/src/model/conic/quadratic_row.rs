//! Comparisons of quadratic expressions.

use super::conic_row::{ConicRow, Refused};
use super::stored_conic::StoredConic;
use crate::model::quadratic::Quadratic;

impl Quadratic {
    /// The row `self <= right`. A model accepts it if it is a second-order cone.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let mut model = Model::new("cones");
    /// let x = model.continuous("x", 0.0, 5.0)?;
    /// let y = model.continuous("y", 0.0, 5.0)?;
    /// let z = model.continuous("z", -5.0, 5.0)?;
    /// model.add("disc", ((x - 1.0).square() + (y - 1.0).square()).le(4.0))?;
    /// model.add("below", z.square().le(x * y))?;
    /// model.maximize(x + y + z)?;
    /// # Ok::<(), carom::Error>(())
    /// ```
    pub fn le(&self, right: impl Into<Quadratic>) -> ConicRow {
        let expression = (self - right.into()).compacted();
        ConicRow::new(StoredConic::Quadratic { expression })
    }

    /// The row `self >= right`. A model accepts it if it is a second-order cone.
    pub fn ge(&self, right: impl Into<Quadratic>) -> ConicRow {
        right.into().le(self)
    }

    /// No model accepts this, because it is not convex; the error of
    /// [`Model::add`](crate::model::Model::add) says what to write instead.
    pub fn equals(&self, right: impl Into<Quadratic>) -> ConicRow {
        self.le(right).refused(Refused::QuadraticEquals)
    }

    /// The row `lower <= self <= upper`. One limit must be infinite, because no quadratic
    /// expression is convex and concave.
    pub fn within(&self, lower: f64, upper: f64) -> ConicRow {
        match (lower == f64::NEG_INFINITY, upper == f64::INFINITY) {
            (true, _) => self.le(upper),
            (false, true) => self.ge(lower),
            (false, false) => self.le(upper).refused(Refused::QuadraticWithin),
        }
    }
}
