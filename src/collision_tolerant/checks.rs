//! Refusals of numbers, in the words of the crate.

use std::ops::RangeInclusive;

use crate::error::{Error, ErrorKind};
use crate::interval::Interval;

/// Refuses a number that is not finite.
pub(super) fn check_finite(name: &str, what: &'static str, value: f64) -> Result<(), Error> {
    match value.is_finite() {
        true => Ok(()),
        false => Err(ErrorKind::NotFinite { name: name.to_owned(), what, value }.into()),
    }
}

/// Refuses a range whose ends are not finite, or crossed.
pub(super) fn check_range(name: &str, range: Interval) -> Result<(), Error> {
    check_finite(name, "the lower limit", range.lower)?;
    check_finite(name, "the upper limit", range.upper)?;
    check_order(name, range)
}

pub(super) fn check_order(name: &str, Interval { lower, upper }: Interval) -> Result<(), Error> {
    match lower <= upper {
        true => Ok(()),
        false => Err(ErrorKind::CrossedBounds { name: name.to_owned(), lower, upper }.into()),
    }
}

pub(super) fn out_of_range(
    what: &str,
    value: f64,
    limits: RangeInclusive<f64>,
    range: &str,
) -> Error {
    let (what, range) = (what.to_owned(), range.to_owned());
    let (lower, upper) = (Some(*limits.start()), Some(*limits.end()));
    ErrorKind::OutOfRange { what, value, lower, upper, range }.into()
}
