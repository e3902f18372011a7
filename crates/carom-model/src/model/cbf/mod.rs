#![doc = include_str!("../../../docs/cbf.md")]

mod build;
mod cone_kind;
mod cones;
mod read;
mod rows;
mod write;

use super::store::Model;
use super::text::read::Read;
use super::text::token::in_characters;
use crate::error::Error;

/// Reads a model from the text of a CBF file, with a warning for everything that the file omits.
///
/// # Errors
///
/// [`ErrorKind::Parse`](crate::error::ErrorKind::Parse) with the line and column of anything
/// damaged, unknown or contradictory, and of cones that are no second-order cones.
///
/// # Complexity
///
/// Linear in the length of the text, but for sorting its entries.
pub fn read(text: &str) -> Result<Read, Error> {
    let mut read = build::model(read::CbfFile::scan(text)?, text.len())?;
    in_characters(text, &mut read.warnings);
    Ok(read)
}

/// Writes a model as a CBF file of version 1. Names are lost.
///
/// # Errors
///
/// [`ErrorKind::InvalidName`](crate::error::ErrorKind::InvalidName) if the model's name contains a
/// line break or another control character;
/// [`ErrorKind::NotInFile`](crate::error::ErrorKind::NotInFile) for indicators, logic,
/// disjunctions, functions, ordered sets and semi-continuous variables, which the lowered model no
/// longer has; [`ErrorKind::NotConvex`](crate::error::ErrorKind::NotConvex) for a quadratic
/// objective that is no cone.
///
/// # Complexity
///
/// Linear in the size of the model.
pub fn write(model: &Model) -> Result<String, Error> {
    write::text(model)
}
