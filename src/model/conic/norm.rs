//! The length of a vector of affine expressions.

use super::conic_row::{ConicRow, Refused};
use super::stored_conic::StoredConic;
use crate::model::affine::Affine;

/// The Euclidean norm of a vector of affine expressions, in their unit; made by [`norm`].
#[derive(Debug, Clone, PartialEq)]
#[must_use = "a norm does nothing until it is compared"]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Norm {
    entries: Vec<Affine>,
}

/// The Euclidean norm of a vector of affine expressions.
///
/// ```
/// use carom::model::norm;
/// use carom::prelude::*;
///
/// let mut model = Model::new("disc");
/// let v = model.continuous_family("v", 2, -5.0, 5.0)?;
/// model.add("speed", norm([v[0], v[1]]).le(3.0))?;
/// assert!(model.to_string().contains("speed: |(v[0], v[1])| <= 3\n"));
/// # Ok::<(), carom::Error>(())
/// ```
pub fn norm<T: Into<Affine>>(entries: impl IntoIterator<Item = T>) -> Norm {
    Norm { entries: entries.into_iter().map(T::into).collect() }
}

impl Norm {
    /// The statement that the norm is at most an affine expression, which is then at least 0.
    pub fn le(&self, bound: impl Into<Affine>) -> ConicRow {
        ConicRow::new(StoredConic::Norm { entries: self.entries.clone(), bound: bound.into() })
    }

    /// No model accepts this, because it is not convex; the error of [`Model::add`](crate::model::Model::add)
    /// says what to write instead.
    pub fn ge(&self, bound: impl Into<Affine>) -> ConicRow {
        self.le(bound).refused(Refused::NormAtLeast)
    }

    /// No model accepts this, because it is not convex; the error of [`Model::add`](crate::model::Model::add)
    /// says what to write instead.
    pub fn equals(&self, value: impl Into<Affine>) -> ConicRow {
        self.le(value).refused(Refused::NormEquals)
    }
}
