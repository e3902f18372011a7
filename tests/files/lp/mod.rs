//! LP files: what each section means, what damaged files say, and exact round trips.

mod damaged;
mod functions;
mod quadratic_rows;
mod random;
mod repeated;
mod sections;
mod written;

use carom::model::lp;
use carom::prelude::*;

fn read(text: &str) -> Model {
    lp::read(text).unwrap_or_else(|error| panic!("{error}\n{text}")).model
}

/// The warnings, and the model as text.
fn warned(text: &str) -> (Vec<String>, String) {
    let read = lp::read(text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    (read.warnings.iter().map(ToString::to_string).collect(), read.model.to_string())
}

fn error(text: &str) -> String {
    match lp::read(text) {
        Ok(read) => panic!("was read:\n{}", read.model),
        Err(error) => error.to_string(),
    }
}
