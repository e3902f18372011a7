#![doc = include_str!("../../../docs/mps.md")]

mod bounds;
mod build;
pub(crate) mod decimal;
mod fixed;
mod limits;
mod names;
mod products;
mod read;
mod section;
mod sets;
mod write;

use super::store::Model;
use super::text::read::Read;
use super::text::token::in_characters;
use crate::error::{Error, ErrorKind};

/// Reads a model from the text of an MPS file, with a warning for everything that the file repeats
/// or omits.
///
/// # Errors
///
/// [`ErrorKind::Parse`] with the line and column of anything damaged, unknown or contradictory;
/// [`ErrorKind::NotConvex`] for a quadratic objective that is not convex in its direction.
///
/// # Complexity
///
/// Linear in the length of the text, but for the convexity check of a quadratic objective.
pub fn read(text: &str) -> Result<Read, Error> {
    let model = |text: &str| -> Result<Read, Error> {
        let mut read = build::model(read::MpsFile::scan(text)?)?;
        in_characters(text, &mut read.warnings);
        Ok(read)
    };
    model(text).or_else(|error: Error| match fixed::without_blanks(text) {
        Some(text) if matches!(error.kind(), ErrorKind::Parse { .. }) => model(&text),
        _ => Err(error),
    })
}

/// Writes a model as free MPS.
///
/// # Errors
///
/// [`ErrorKind::InvalidName`] if the model's name contains a line break or another control
/// character; [`ErrorKind::NotInFile`] for logic, compound conditions, disjunctions and functions,
/// which the lowered model no longer has.
///
/// # Complexity
///
/// Linear in the size of the model.
pub fn write(model: &Model) -> Result<String, Error> {
    write::text(model)
}
