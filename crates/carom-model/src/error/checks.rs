//! Checks of arguments that many callers share.

use std::fmt;

use super::{Error, ErrorKind};

/// Refuses a list of a wrong length; `what` is its name, as a noun phrase.
pub fn check_length(what: &'static str, found: usize, expected: usize) -> Result<(), Error> {
    if found == expected {
        return Ok(());
    }
    Err(ErrorKind::Length { what, found, expected }.into())
}

/// Refuses NaN and infinities; `name` is whose numbers they are, `what` is one of them.
pub fn check_finite(
    name: impl fmt::Display,
    what: &'static str,
    numbers: impl IntoIterator<Item = f64>,
) -> Result<(), Error> {
    match numbers.into_iter().find(|value| !value.is_finite()) {
        Some(value) => Err(ErrorKind::NotFinite { name: name.to_string(), what, value }.into()),
        None => Ok(()),
    }
}
