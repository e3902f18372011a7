//! The section `Subject To`: rows, with two limits and with conditions.

use super::expression::Expression;
use super::lexer::TokenKind;
use super::read::LpFile;
use crate::error::Error;
use crate::model::text::row_condition::RowCondition;
use crate::model::text::token::Token;
use crate::number::Exact;

/// A row as the file has it.
#[derive(Debug)]
pub(super) struct LpRow<'a> {
    pub(super) label: Option<Token<'a>>,
    /// The position where it begins.
    pub(super) place: Token<'a>,
    pub(super) terms: Vec<(usize, f64)>,
    pub(super) products: Vec<(usize, usize, f64)>,
    pub(super) lower: f64,
    pub(super) upper: f64,
    pub(super) condition: Option<RowCondition<'a>>,
}

/// `lower <= expression <= upper`.
struct Comparison<'a> {
    expression: Expression<'a>,
    lower: f64,
    upper: f64,
}

impl<'a> LpFile<'a> {
    pub(super) fn read_rows(&mut self) -> Result<(), Error> {
        let mut last_line = None;
        while self.section().is_none() && self.kind() != TokenKind::End {
            if last_line == Some(self.token().line()) && !self.at_label() {
                return Err(self.unexpected(
                    "a new line or a label, as the row before is complete (its right-hand side is \
                     a number; variables stand on the left)",
                ));
            }
            let row = self.row()?;
            self.rows.push(row);
            last_line = self.last_line();
        }
        Ok(())
    }

    fn row(&mut self) -> Result<LpRow<'a>, Error> {
        let label = self.row_label();
        let place = self.token();
        let mut comparison = self.comparison()?;
        let mut condition = None;
        if self.kind() == TokenKind::Arrow {
            let Some((column, on)) = literal(&comparison) else {
                return Err(place.error("expected `z = 0` or `z = 1` as the condition before `->`"));
            };
            condition = Some(RowCondition { column, on, place });
            self.step();
            comparison = self.comparison()?;
        }
        let Comparison { expression, lower, upper } = comparison;
        let place = label.unwrap_or(place);
        if let Some(token) = expression.infinite() {
            return Err(token.error("infinity cannot be part of a sum"));
        }
        if let (Some((_, token)), false) = (expression.constant, !expression.has_variables()) {
            return Err(token.error(
                "a number beside variables is read differently by different solvers; move it to \
                 the other side",
            ));
        }
        if lower == f64::INFINITY || upper == f64::NEG_INFINITY {
            return Err(place.error("no point can satisfy this row"));
        }
        if lower > upper {
            return Err(place.error(format!(
                "the limits of this row are crossed: {} > {}",
                Exact(lower),
                Exact(upper)
            )));
        }
        let Expression { terms, products, .. } = expression;
        Ok(LpRow { label, place, terms, products, lower, upper, condition })
    }

    fn comparison(&mut self) -> Result<Comparison<'a>, Error> {
        let left = self.expression(false)?;
        let relation = self.relation()?;
        let mut limits = (f64::NEG_INFINITY, f64::INFINITY);
        if left.has_variables() || left.constant.is_none() {
            if self.at_name() || self.kind() == TokenKind::Open {
                return Err(self.unexpected("a number (bring variables to the left)"));
            }
            let (value, _) = self.value()?;
            limit(&mut limits, relation, left.moved(value));
            return Ok(Comparison { expression: left, lower: limits.0, upper: limits.1 });
        }
        // A number is on the left.
        let right = self.expression(false)?;
        if !right.has_variables() {
            let Some((value, token)) = right.constant else {
                return Err(self.unexpected("an expression"));
            };
            if let Some(infinite) = left.infinite().or(right.infinite()) {
                return Err(infinite.error("infinity cannot be compared to a number"));
            }
            limit(&mut limits, relation, left.moved(value));
            let expression = Expression { constant: Some((0.0, token)), ..Expression::default() };
            return Ok(Comparison { expression, lower: limits.0, upper: limits.1 });
        }
        let number = left.constant.map_or(0.0, |(value, _)| value);
        limit(&mut limits, flipped(relation), right.moved(number));
        if matches!(self.kind(), TokenKind::AtMost | TokenKind::AtLeast | TokenKind::Equal) {
            if self.kind() != relation || relation == TokenKind::Equal {
                return Err(self
                    .token()
                    .error("a row with two limits needs the same comparison twice, `<=` or `>=`"));
            }
            self.step();
            let (value, _) = self.value()?;
            limit(&mut limits, relation, right.moved(value));
        }
        Ok(Comparison { expression: right, lower: limits.0, upper: limits.1 })
    }

    /// Skips a comparison sign.
    pub(super) fn relation(&mut self) -> Result<TokenKind, Error> {
        match self.kind() {
            kind @ (TokenKind::AtMost | TokenKind::AtLeast | TokenKind::Equal) => {
                self.step();
                Ok(kind)
            }
            _ => Err(self.unexpected("`+`, `-`, `<=`, `>=` or `=`")),
        }
    }
}

/// Mirrors a comparison: `3 <= x` is `x >= 3`.
pub(super) fn flipped(relation: TokenKind) -> TokenKind {
    match relation {
        TokenKind::AtMost => TokenKind::AtLeast,
        TokenKind::AtLeast => TokenKind::AtMost,
        other => other,
    }
}

fn limit(limits: &mut (f64, f64), relation: TokenKind, value: f64) {
    if relation != TokenKind::AtLeast {
        limits.1 = value;
    }
    if relation != TokenKind::AtMost {
        limits.0 = value;
    }
}

/// The column and the value of `z = 0` or `z = 1`.
fn literal(comparison: &Comparison<'_>) -> Option<(usize, bool)> {
    let &[(column, coefficient)] = &comparison.expression.terms[..] else { return None };
    let (lower, upper) = (comparison.lower, comparison.upper);
    let plain = coefficient == 1.0
        && comparison.expression.products.is_empty()
        && comparison.expression.constant.is_none()
        && lower == upper;
    match lower {
        0.0 if plain => Some((column, false)),
        1.0 if plain => Some((column, true)),
        _ => None,
    }
}
