//! The bounds of a column while a file is read. A second, different value is an error.

use super::token::Token;
use crate::error::Error;

/// The bounds that a file gives for a column.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Ends<'a> {
    pub(crate) lower: Option<f64>,
    pub(crate) upper: Option<f64>,
    /// The last entry, for messages.
    pub(crate) last: Option<Token<'a>>,
}

impl<'a> Ends<'a> {
    /// Sets the bounds that an entry gives. A value other than the one before is an error.
    pub(crate) fn take(
        &mut self,
        column: &Token<'a>,
        lower: Option<f64>,
        upper: Option<f64>,
    ) -> Result<(), Error> {
        set(&mut self.lower, lower, "lower", column)?;
        set(&mut self.upper, upper, "upper", column)?;
        self.last = Some(*column);
        Ok(())
    }
}

/// A number that can be a lower bound.
pub(crate) fn lower(value: f64, token: &Token<'_>) -> Result<f64, Error> {
    if value < f64::INFINITY {
        return Ok(value);
    }
    Err(token.error("a lower bound cannot be +infinity"))
}

/// A number that can be an upper bound.
pub(crate) fn upper(value: f64, token: &Token<'_>) -> Result<f64, Error> {
    if value > f64::NEG_INFINITY {
        return Ok(value);
    }
    Err(token.error("an upper bound cannot be -infinity"))
}

fn set(
    end: &mut Option<f64>,
    value: Option<f64>,
    which: &str,
    column: &Token<'_>,
) -> Result<(), Error> {
    if let (Some(old), Some(new)) = (*end, value)
        && old != new
    {
        let name = column.text;
        return Err(column.error(format!(
            "the {which} bound of `{name}` was {old} before and is {new} now; keep one of them"
        )));
    }
    *end = value.or(*end);
    Ok(())
}
