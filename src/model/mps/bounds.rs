//! The BOUNDS section: what each kind of entry does, and the defaults.

use super::token::Token;
use crate::error::Error;

/// What a file says about the bounds of one column.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Bounds<'a> {
    lower: Option<f64>,
    upper: Option<f64>,
    /// The last entry, for messages.
    last: Option<Token<'a>>,
}

/// Whether a bound of this kind carries a number; an error for kinds that are not known.
pub(super) fn has_value(kind: &Token<'_>) -> Result<bool, Error> {
    match kind.text {
        "LO" | "UP" | "FX" | "LI" | "UI" => Ok(true),
        "FR" | "MI" | "PL" | "BV" => Ok(false),
        "SC" | "SI" => Err(kind.error(format!(
            "bound kind `{}` declares a semi-continuous column, which a model cannot hold; write \
             it with a binary and an indicator",
            kind.text
        ))),
        other => Err(kind.error(format!(
            "`{other}` is not a bound kind; expected LO, UP, FX, FR, MI, PL, BV, LI or UI"
        ))),
    }
}

impl<'a> Bounds<'a> {
    /// Takes one entry; `true` when it makes the column an integer one.
    pub(super) fn take(
        &mut self,
        kind: &Token<'a>,
        column: &Token<'a>,
        value: Option<&Token<'a>>,
    ) -> Result<bool, Error> {
        let number = || match value {
            Some(token) => token.number().map(|number| (number, *token)),
            None => Err(column.error(format!("bound kind `{}` needs a number", kind.text))),
        };
        let low = |(number, token): (f64, Token<'a>)| {
            if number < f64::INFINITY {
                Ok(number)
            } else {
                Err(token.error("a lower bound cannot be +infinity"))
            }
        };
        let high = |(number, token): (f64, Token<'a>)| {
            if number > f64::NEG_INFINITY {
                Ok(number)
            } else {
                Err(token.error("an upper bound cannot be -infinity"))
            }
        };
        let (lower, upper) = match kind.text {
            "LO" | "LI" => (Some(low(number()?)?), None),
            "UP" | "UI" => (None, Some(high(number()?)?)),
            "FX" => (Some(low(number()?)?), Some(high(number()?)?)),
            "MI" => (Some(f64::NEG_INFINITY), None),
            "PL" => (None, Some(f64::INFINITY)),
            "BV" => (Some(0.0), Some(1.0)),
            _ => (Some(f64::NEG_INFINITY), Some(f64::INFINITY)),
        };
        set(&mut self.lower, lower, "lower", column)?;
        set(&mut self.upper, upper, "upper", column)?;
        self.last = Some(*column);
        Ok(matches!(kind.text, "LI" | "UI" | "BV"))
    }

    /// The bounds of the column, defaults filled in.
    pub(super) fn resolve(&self, integer: bool) -> Result<(f64, f64), Error> {
        let Some(last) = self.last else {
            return Ok((0.0, if integer { 1.0 } else { f64::INFINITY }));
        };
        let upper = self.upper.unwrap_or(f64::INFINITY);
        let default = if upper < 0.0 { f64::NEG_INFINITY } else { 0.0 };
        let lower = self.lower.unwrap_or(default);
        if lower > upper {
            let name = last.text;
            return Err(last.error(format!("bounds of `{name}` are crossed: {lower} > {upper}")));
        }
        Ok((lower, upper))
    }
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
