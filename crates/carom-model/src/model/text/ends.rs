//! The bounds of a column while a file is read.

use super::read::Warning;
use super::token::Token;
use crate::error::Error;
use crate::number::Exact;

/// Which of two different values of a bound counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Repeated {
    First,
    Last,
}

/// The bounds that a file gives for a column.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct FileBounds<'a> {
    pub(crate) lower: Option<f64>,
    pub(crate) upper: Option<f64>,
    /// The last entry, for messages.
    pub(crate) last: Option<Token<'a>>,
}

impl<'a> FileBounds<'a> {
    /// Sets the bounds that an entry gives, with a warning for a value other than the one before.
    pub(crate) fn take(
        &mut self,
        column: &Token<'a>,
        (lower, upper): (Option<f64>, Option<f64>),
        counts: Repeated,
        warnings: &mut Vec<Warning>,
    ) {
        for (end, value, which) in
            [(&mut self.lower, lower, "lower"), (&mut self.upper, upper, "upper")]
        {
            if let (Some(old), Some(new)) = (*end, value)
                && old != new
            {
                let (name, first) = (column.text, counts == Repeated::First);
                let (old, new) = (Exact(old), Exact(new));
                let counts = if first { "first" } else { "last" };
                warnings.push(column.warning(format!(
                    "the {which} bound of `{name}` was {old} before and is {new} now; the {counts} \
                     one counts"
                )));
                if first {
                    continue;
                }
            }
            *end = value.or(*end);
        }
        self.last = Some(*column);
    }

    /// Both bounds, with these where none is given.
    pub(crate) fn or(&self, lower: f64, upper: f64) -> (f64, f64) {
        (self.lower.unwrap_or(lower), self.upper.unwrap_or(upper))
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

/// The message about a semi-continuous variable with crossed bounds: only 0 is left, as most
/// solvers take it.
pub(crate) fn only_zero(name: &str, (lower, upper): (f64, f64)) -> String {
    let (low, high) = (Exact(lower), Exact(upper));
    let doubt = if upper < 0.0 { "; some solvers take the program as infeasible" } else { "" };
    format!(
        "the bounds of the semi-continuous `{name}` are crossed, {low} > {high}, so it is 0{doubt}"
    )
}

/// The message about a semi-continuous variable with negative values.
pub(crate) fn negative(name: &str, (lower, upper): (f64, f64)) -> String {
    let (low, high) = (Exact(lower), Exact(upper));
    format!(
        "`{name}` is 0 or between {low} and {high}; some solvers refuse negative values of \
         semi-continuous variables"
    )
}
