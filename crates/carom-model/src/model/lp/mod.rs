#![doc = include_str!("../../../docs/lp.md")]

mod bounds;
mod build;
mod constant;
mod defined;
mod dialect;
mod expression;
mod function;
mod functions;
mod lexer;
pub(crate) mod names;
mod read;
mod rows;
mod section;
mod sets;
mod write;

use super::store::Model;
use super::text::read::Read;
use super::text::token::in_characters;
use crate::error::Error;

/// Reads a model from the text of an LP file, with a warning for everything that the file repeats
/// or omits.
///
/// # Errors
///
/// [`ErrorKind::Parse`](crate::error::ErrorKind::Parse) with the line and column of anything
/// damaged, unknown or contradictory; [`ErrorKind::NotConvex`](crate::error::ErrorKind::NotConvex)
/// for a quadratic objective that is not convex in its direction.
///
/// # Complexity
///
/// Linear in the length of the text (but for sorting the terms of each row), and the convexity
/// check of a quadratic objective.
pub fn read(text: &str) -> Result<Read, Error> {
    let file = read::LpFile::scan(text).map_err(|error| dialect::hint(text).unwrap_or(error))?;
    let mut read = build::model(file)?;
    in_characters(text, &mut read.warnings);
    Ok(read)
}

/// Writes a model as an LP file.
///
/// # Errors
///
/// [`ErrorKind::InvalidName`](crate::error::ErrorKind::InvalidName) when the model's name contains
/// a line break or another control character;
/// [`ErrorKind::NotInFile`](crate::error::ErrorKind::NotInFile) for logic, compound conditions,
/// disjunctions and functions, which the lowered model has no more.
///
/// # Complexity
///
/// Linear in the size of the model.
pub fn write(model: &Model) -> Result<String, Error> {
    write::text(model)
}
