//! Checks of the numbers that a model is given.

use super::name::Name;
use crate::error::{Error, ErrorKind};

/// Checks a pair of row limits; magnitudes from [`tolerance::INFINITE`](crate::tolerance::INFINITE)
/// on become infinite.
pub(crate) fn limits(lower: f64, upper: f64, name: &Name) -> Result<(f64, f64), Error> {
    let (lower, upper) = bounds(lower, upper, name)?;
    if lower.is_infinite() && upper.is_infinite() {
        return Err(ErrorKind::UnlimitedRow { name: name.to_string() }.into());
    }
    Ok((lower, upper))
}

/// Checks a pair of bounds; one or both may be infinite.
pub(crate) fn bounds(lower: f64, upper: f64, name: &Name) -> Result<(f64, f64), Error> {
    let not_finite =
        |what, value| Err(ErrorKind::NotFinite { name: name.to_string(), what, value }.into());
    if lower.is_nan() || lower >= crate::tolerance::INFINITE {
        return not_finite("the lower limit", lower);
    }
    if upper.is_nan() || upper <= -crate::tolerance::INFINITE {
        return not_finite("the upper limit", upper);
    }
    if lower > upper {
        return Err(ErrorKind::CrossedBounds { name: name.to_string(), lower, upper }.into());
    }
    let lower = if lower <= -crate::tolerance::INFINITE { f64::NEG_INFINITY } else { lower };
    let upper = if upper >= crate::tolerance::INFINITE { f64::INFINITY } else { upper };
    Ok((lower, upper))
}

/// Refuses NaN, infinities and magnitudes that are treated as infinite.
pub(crate) fn finite(value: f64, what: &'static str, name: &Name) -> Result<(), Error> {
    if value.abs() < crate::tolerance::INFINITE {
        Ok(())
    } else {
        Err(ErrorKind::NotFinite { name: name.to_string(), what, value }.into())
    }
}
