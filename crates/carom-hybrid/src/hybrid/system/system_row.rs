//! Rows of a system's handles: affine ones, those of norms and squares, and nonlinear ones.

use crate::error::Error;
use crate::model::{ConicRow, Literal, Model, Name, NonlinearRow, Row};

/// A row of a system's handles: a [`Row`], the [`ConicRow`] of a norm or a square, or a
/// [`NonlinearRow`].
///
/// Methods take `impl Into<SystemRow>`, so all can be given as they are.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum SystemRow {
    /// An affine row.
    Row(Row),
    /// A row of a norm or of squares, which is a second-order cone.
    Conic(ConicRow),
    /// A row of a nonlinear expression.
    Nonlinear(NonlinearRow),
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
            (SystemRow::Nonlinear(row), None) => model.add(name, row).map(drop),
            (SystemRow::Nonlinear(row), Some(when)) => model.add(name, when.implies(row)).map(drop),
        }
    }
}

impl From<Row> for SystemRow {
    fn from(row: Row) -> Self {
        SystemRow::Row(row)
    }
}

impl From<NonlinearRow> for SystemRow {
    fn from(row: NonlinearRow) -> Self {
        SystemRow::Nonlinear(row)
    }
}

impl From<ConicRow> for SystemRow {
    fn from(row: ConicRow) -> Self {
        SystemRow::Conic(row)
    }
}
