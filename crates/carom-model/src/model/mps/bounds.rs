//! The BOUNDS section: what each kind of entry does, and the defaults.

use crate::error::Error;
use crate::model::text::ends::{self, FileBounds, Repeated};
use crate::model::text::read::Warning;
use crate::model::text::token::Token;
use crate::model::variable::VariableKind;
use crate::number::Exact;

/// The bounds of one column in a file.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct MpsBounds<'a> {
    ends: FileBounds<'a>,
    /// The kind of the column according to the entries.
    pub(super) kind: Option<VariableKind>,
    /// Whether the bounds are those of values other than 0.
    pub(super) semicontinuous: bool,
}

/// Whether a bound of this kind has a number; an error for unknown kinds.
pub(super) fn has_value(kind: &Token<'_>) -> Result<bool, Error> {
    match kind.text.to_ascii_uppercase().as_str() {
        "LO" | "UP" | "FX" | "LI" | "UI" | "SC" | "SI" => Ok(true),
        "FR" | "MI" | "PL" | "BV" => Ok(false),
        _ => Err(kind.error(format!(
            "`{}` is not a bound kind; expected LO, UP, FX, FR, MI, PL, BV, LI, UI, SC or SI",
            kind.text
        ))),
    }
}

impl<'a> MpsBounds<'a> {
    /// Applies one entry.
    pub(super) fn take(
        &mut self,
        kind: &Token<'a>,
        column: &Token<'a>,
        value: Option<&Token<'a>>,
        warnings: &mut Vec<Warning>,
    ) -> Result<(), Error> {
        let number = || match value {
            Some(token) => token.number().map(|number| (number, token)),
            None => Err(column.error(format!("bound kind `{}` needs a number", kind.text))),
        };
        let low = |(number, token)| ends::lower(number, token);
        let high = |(number, token)| ends::upper(number, token);
        let upper_case = kind.text.to_ascii_uppercase();
        let (lower, upper) = match upper_case.as_str() {
            "LO" | "LI" => (Some(low(number()?)?), None),
            "UP" | "UI" | "SC" | "SI" => (None, Some(high(number()?)?)),
            "FX" => (Some(low(number()?)?), Some(high(number()?)?)),
            "MI" => (Some(f64::NEG_INFINITY), None),
            "PL" => (None, Some(f64::INFINITY)),
            "BV" => (Some(0.0), Some(1.0)),
            _ => (Some(f64::NEG_INFINITY), Some(f64::INFINITY)),
        };
        // `BV` overrules other entries.
        let (before, binary) = (self.kind == Some(VariableKind::Binary), upper_case == "BV");
        let counts = if binary && !before { Repeated::Last } else { Repeated::First };
        self.ends.take(column, (lower, upper), counts, warnings);
        match upper_case.as_str() {
            "BV" => self.kind = Some(VariableKind::Binary),
            "SC" | "SI" => {
                self.semicontinuous = true;
                if upper_case == "SI" {
                    self.kind = self.kind.or(Some(VariableKind::Integer));
                }
            }
            "LI" | "UI" => self.kind = self.kind.or(Some(VariableKind::Integer)),
            _ => {}
        }
        Ok(())
    }

    /// The bounds of the column, defaults filled in.
    pub(super) fn resolve(
        &self,
        integer: bool,
        warnings: &mut Vec<Warning>,
    ) -> Result<(f64, f64), Error> {
        let Some(last) = self.ends.last else {
            return Ok((0.0, if integer { 1.0 } else { f64::INFINITY }));
        };
        let upper = self.ends.upper.unwrap_or(f64::INFINITY);
        let default = if upper < 0.0 { f64::NEG_INFINITY } else { 0.0 };
        let name = last.text;
        if upper < 0.0 && self.ends.lower.is_none() {
            warnings.push(last.warning(format!(
                "`{name}` has a negative upper bound and no lower one, so that is -inf; some \
                 solvers take 0"
            )));
        }
        let lower = self.ends.lower.unwrap_or(default);
        if lower > upper {
            let (low, high) = (Exact(lower), Exact(upper));
            return Err(last.error(format!("bounds of `{name}` are crossed: {low} > {high}")));
        }
        Ok((lower, upper))
    }

    /// The bounds that are given if they are crossed, and the last entry.
    pub(super) fn crossed(&self) -> Option<(Token<'a>, (f64, f64))> {
        let ends = (self.ends.lower?, self.ends.upper?);
        (ends.0 > ends.1).then_some((self.ends.last?, ends))
    }
}
