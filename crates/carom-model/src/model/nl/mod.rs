#![doc = include_str!("../../../docs/nl.md")]

mod build;
mod cursor;
mod expression;
mod functions;
mod header;
mod operators;
mod order;
mod polynomial;
mod read;
mod sol;
mod write;

pub use sol::SolFile;

use super::store::Model;
use super::text::read::Read;
use crate::error::Error;

/// Reads a model from the bytes of an NL file, as text or in its binary form.
///
/// # Errors
///
/// [`ErrorKind::Parse`](crate::error::ErrorKind::Parse) with the line and column of anything
/// damaged, unknown or contradictory; [`ErrorKind::Operator`](crate::error::ErrorKind::Operator)
/// with the place of an operator that is not taken, such as `floor`, of a logical or
/// complementarity constraint.
///
/// # Complexity
///
/// Linear in the length of the file, but for products of sums, sorting, and the convexity check of
/// a quadratic objective.
pub fn read(file: impl AsRef<[u8]>) -> Result<Read, Error> {
    let (file, cursor) = read::NlFile::scan(file.as_ref())?;
    build::model(file, &cursor)
}

/// Writes a model as the text of an NL file. Names are lost, and columns have the order that the
/// format needs, in which [`SolFile::values_of`] finds the variables again.
///
/// # Errors
///
/// [`ErrorKind::InvalidName`](crate::error::ErrorKind::InvalidName) if the model's name contains a
/// line break or another control character;
/// [`ErrorKind::NotInFile`](crate::error::ErrorKind::NotInFile) for indicators, logic,
/// disjunctions, piecewise-affine functions and functions of one's own, semi-continuous variables
/// and variables in several ordered sets.
///
/// # Complexity
///
/// `O(n log n)` in the size of the model.
pub fn write(model: &Model) -> Result<String, Error> {
    write::text(model)
}
