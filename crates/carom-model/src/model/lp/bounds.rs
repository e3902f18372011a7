//! The section `Bounds`.

use super::lexer::TokenKind;
use super::read::{LpFile, is_infinity};
use super::rows::flipped;
use crate::error::Error;
use crate::model::text::ends::{Repeated, lower, upper};
use crate::model::text::token::Token;

impl<'a> LpFile<'a> {
    pub(super) fn read_bounds(&mut self) -> Result<(), Error> {
        while self.section().is_none() && self.kind() != TokenKind::End {
            self.bound()?;
        }
        Ok(())
    }

    /// `1 <= x <= 2`, one half of it, `x = 1` or `x free`.
    fn bound(&mut self) -> Result<(), Error> {
        let signs = matches!(self.kind(), TokenKind::Plus | TokenKind::Minus | TokenKind::Number);
        let left = if signs || is_infinity(self.token().text) {
            let value = self.value()?;
            Some((flipped(self.relation()?), value))
        } else {
            None
        };
        if !self.at_name() {
            return Err(self.unexpected("the name of a variable"));
        }
        let name = self.token();
        let column = self.known_column()?;
        if let Some((relation, value)) = left {
            self.set(column, &name, relation, value)?;
        }
        match self.kind() {
            TokenKind::AtMost | TokenKind::AtLeast | TokenKind::Equal => {
                let place = self.token();
                let relation = self.relation()?;
                if left.is_some_and(|(left, _)| left != flipped(relation) || left == relation) {
                    return Err(
                        place.error("two bounds need the same comparison twice, `<=` or `>=`")
                    );
                }
                let value = self.value()?;
                self.set(column, &name, relation, value)
            }
            TokenKind::Word if left.is_none() && self.token().text.eq_ignore_ascii_case("free") => {
                if self.columns[column].ends.upper.is_some_and(f64::is_finite) {
                    let text = name.text;
                    return Err(name.error(format!(
                        "`{text}` has an upper bound, and solvers disagree what `free` means then; \
                         keep one of them"
                    )));
                }
                self.step();
                self.take(column, &name, (Some(f64::NEG_INFINITY), Some(f64::INFINITY)));
                Ok(())
            }
            _ if left.is_none() => Err(self.unexpected("`<=`, `>=`, `=` or `free`")),
            _ => Ok(()),
        }
    }

    /// Applies `x <= value`, `x >= value` or `x = value`.
    fn set(
        &mut self,
        column: usize,
        name: &Token<'a>,
        relation: TokenKind,
        (value, token): (f64, Token<'a>),
    ) -> Result<(), Error> {
        let low = match relation {
            TokenKind::AtMost => None,
            _ => Some(lower(value, &token)?),
        };
        let high = match relation {
            TokenKind::AtLeast => None,
            _ => Some(upper(value, &token)?),
        };
        self.take(column, name, (low, high));
        Ok(())
    }

    fn take(&mut self, column: usize, name: &Token<'a>, ends: (Option<f64>, Option<f64>)) {
        self.columns[column].ends.take(name, ends, Repeated::Last, &mut self.warnings);
    }
}
