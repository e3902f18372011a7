//! Rows of a system's handles: affine ones, and those of norms and squares.

use crate::error::Error;
use crate::model::{ConicRow, Literal, Model, Name, Row};

/// A row of a system's handles: a [`Row`], or the [`ConicRow`] of a norm or a square.
///
/// Methods take `impl Into<SystemRow>`, so both can be given as they are.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum SystemRow {
    /// An affine row.
    Row(Row),
    /// A row of a norm or of squares, which is a second-order cone.
    Conic(ConicRow),
}

impl SystemRow {
    /// Adds the row to a model, under a condition if there is one.
    pub(crate) fn add_to(
        self,
        model: &mut Model,
        name: impl Into<Name>,
        when: Option<Literal>,
    ) -> Result<(), Error> {
        match (self, when) {
            (SystemRow::Row(row), None) => model.add(name, row).map(drop),
            (SystemRow::Row(row), Some(when)) => model.add(name, when.implies(row)).map(drop),
            (SystemRow::Conic(row), None) => model.add(name, row).map(drop),
            (SystemRow::Conic(row), Some(when)) => model.add(name, when.implies(row)).map(drop),
        }
    }
}

impl From<Row> for SystemRow {
    fn from(row: Row) -> Self {
        SystemRow::Row(row)
    }
}

impl From<ConicRow> for SystemRow {
    fn from(row: ConicRow) -> Self {
        SystemRow::Conic(row)
    }
}
