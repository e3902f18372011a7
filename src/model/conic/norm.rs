//! The length of a vector of affine expressions.

use super::conic_row::{ConicRow, StoredConic};
use crate::model::affine::Affine;

/// The Euclidean norm of a vector of affine expressions, in their unit; made by [`norm`].
#[derive(Debug, Clone, PartialEq)]
#[must_use = "a norm does nothing until it is compared"]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Norm {
    entries: Vec<Affine>,
}

/// The Euclidean norm of a vector.
pub fn norm<T: Into<Affine>>(entries: impl IntoIterator<Item = T>) -> Norm {
    Norm { entries: entries.into_iter().map(T::into).collect() }
}

impl Norm {
    /// The statement that the norm is at most an affine expression, which is then at least 0.
    pub fn le(&self, bound: impl Into<Affine>) -> ConicRow {
        ConicRow::new(StoredConic::Norm { entries: self.entries.clone(), bound: bound.into() })
    }
}
