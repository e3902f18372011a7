//! MPS files: what each section means, what damaged files say, and exact round trips.

mod damaged;
mod fixed;
mod quadratic_rows;
mod random;
mod repeated;
mod sections;
mod written;

use carom::model::mps;
use carom::prelude::*;

fn read(text: &str) -> Model {
    mps::read(text).unwrap_or_else(|error| panic!("{error}\n{text}")).model
}

/// The warnings, and the model as text.
fn warned(text: &str) -> (Vec<String>, String) {
    let read = mps::read(text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    (read.warnings.iter().map(ToString::to_string).collect(), read.model.to_string())
}

fn error(text: &str) -> String {
    match mps::read(text) {
        Ok(read) => panic!("was read:\n{}", read.model),
        Err(error) => error.to_string(),
    }
}

/// A file with one objective row, rows of all kinds and the columns `x`, `y` (continuous) and `k`
/// (integer), followed by the given sections.
fn with(sections: &str) -> String {
    format!(
        "NAME small\nROWS\n N cost\n L most\n G least\n E same\nCOLUMNS\n x cost 1 most 1\n \
         x least 1\n y most 2 same 1\n M1 'MARKER' 'INTORG'\n k cost -1 least 3\n \
         M2 'MARKER' 'INTEND'\n{sections}ENDATA\n"
    )
}
