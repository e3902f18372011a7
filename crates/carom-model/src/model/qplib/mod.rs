#![doc = include_str!("../../../docs/qplib.md")]

mod build;
mod read;

use super::text::read::Read;
use super::text::token::in_characters;
use crate::error::Error;

/// Reads a model from the text of a QPLIB file.
///
/// # Errors
///
/// [`ErrorKind::Parse`](crate::error::ErrorKind::Parse) with the line and column of anything
/// damaged, unknown or contradictory, and of quadratic rows with two limits;
/// [`ErrorKind::NotConvex`](crate::error::ErrorKind::NotConvex) for an objective that is not convex
/// in its direction.
///
/// # Complexity
///
/// Linear in the length of the text, but for sorting its entries, and the convexity check of a
/// quadratic objective.
pub fn read(text: &str) -> Result<Read, Error> {
    let mut read = build::model(read::QplibFile::scan(text)?)?;
    in_characters(text, &mut read.warnings);
    Ok(read)
}
