//! LP files: what each section means, what damaged files say, and exact round trips.

mod damaged;
mod random;
mod sections;
mod written;

use carom::model::lp;
use carom::prelude::*;

fn read(text: &str) -> Model {
    lp::read(text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn error(text: &str) -> String {
    match lp::read(text) {
        Ok(model) => panic!("was read:\n{model}"),
        Err(error) => error.to_string(),
    }
}
