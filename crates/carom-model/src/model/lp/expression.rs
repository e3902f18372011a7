//! Expressions: terms, constants, and products in brackets.

use super::lexer::TokenKind;
use super::read::{LpFile, is_infinity};
use crate::error::Error;
use crate::model::text::token::{Token, or_infinite};

/// An expression as the file has it: nothing is merged, and zeros are kept.
#[derive(Debug, Default)]
pub(super) struct Expression<'a> {
    pub(super) terms: Vec<(usize, f64)>,
    /// The sum of the constants, if any, and the last of them.
    pub(super) constant: Option<(f64, Token<'a>)>,
    pub(super) products: Vec<(usize, usize, f64)>,
}

impl<'a> Expression<'a> {
    /// The constant, if it is not finite.
    pub(super) fn infinite(&self) -> Option<Token<'a>> {
        self.constant.filter(|(value, _)| !value.is_finite()).map(|(_, token)| token)
    }

    /// Whether there is a variable in it.
    pub(super) fn has_variables(&self) -> bool {
        !self.terms.is_empty() || !self.products.is_empty()
    }

    /// A number without the constant, for moving it to the other side.
    pub(super) fn moved(&self, value: f64) -> f64 {
        match self.constant {
            Some((constant, _)) => or_infinite(value - constant),
            None => value,
        }
    }

    fn add_constant(&mut self, value: f64, token: Token<'a>) -> Result<(), Error> {
        let sum = match self.constant {
            None => value,
            Some((sum, _)) if value.is_finite() && sum.is_finite() => or_infinite(sum + value),
            Some(_) => return Err(token.error("infinity cannot be part of a sum")),
        };
        self.constant = Some((sum, token));
        Ok(())
    }
}

impl<'a> LpFile<'a> {
    /// The longest expression that begins here, possibly empty.
    pub(super) fn expression(&mut self, in_objective: bool) -> Result<Expression<'a>, Error> {
        let mut expression = Expression::default();
        let mut first = true;
        loop {
            let signed = self.sign();
            if signed.is_none() && !first {
                return Ok(expression);
            }
            let sign = signed.unwrap_or(1.0);
            first = false;
            let token = self.token();
            match self.kind() {
                TokenKind::Number => {
                    self.step();
                    self.check_decimal_point(token)?;
                    if self.at_name() {
                        let coefficient = sign * token.finite()?;
                        expression.terms.push((self.column()?, coefficient));
                    } else if self.kind() == TokenKind::Open {
                        return Err(token.error("no factor can stand before `[`"));
                    } else {
                        expression.add_constant(sign * token.number()?, token)?;
                    }
                }
                TokenKind::Word if self.at_name() => expression.terms.push((self.column()?, sign)),
                TokenKind::Word if is_infinity(token.text) && !self.at_label() => {
                    self.step();
                    expression.add_constant(sign * f64::INFINITY, token)?;
                }
                TokenKind::Open => self.products(sign, &mut expression, in_objective)?,
                _ if signed.is_some() => return Err(self.unexpected("a number or a name")),
                _ => return Ok(expression),
            }
        }
    }

    /// `[ ... ]` with products and squares, and the `/ 2` after it.
    fn products(
        &mut self,
        sign: f64,
        expression: &mut Expression<'a>,
        in_objective: bool,
    ) -> Result<(), Error> {
        self.step();
        let start = expression.products.len();
        let mut places = Vec::new();
        while !self.accept(TokenKind::Close) {
            let signed = self.sign();
            if signed.is_none() && !places.is_empty() {
                return Err(self.unexpected("`+`, `-` or `]`"));
            }
            let place = self.token();
            let mut coefficient = sign * signed.unwrap_or(1.0);
            if self.kind() == TokenKind::Number {
                let number = self.step();
                self.check_decimal_point(number)?;
                coefficient *= number.raw()?;
                self.accept(TokenKind::Times);
            }
            let first = self.factor()?;
            let second = if self.accept(TokenKind::Power) {
                let exponent = self.token();
                if self.kind() != TokenKind::Number || self.step().raw()? != 2.0 {
                    return Err(exponent.error("the exponent can only be 2"));
                }
                first
            } else if self.accept(TokenKind::Times) {
                self.factor()?
            } else {
                return Err(self.unexpected("`^2` or `*` and a name"));
            };
            expression.products.push((first, second, coefficient));
            places.push(place);
        }
        let mut divisor = 1.0;
        if self.accept(TokenKind::Over) {
            let token = self.token();
            if self.kind() != TokenKind::Number || self.step().raw()? != 2.0 {
                return Err(token.error("only `/ 2` can stand behind `]`"));
            }
            if !in_objective {
                self.warnings.push(token.warning(
                    "taken as half of what stands in `[ ]`; some solvers refuse `/ 2` in rows",
                ));
            }
            divisor = 2.0;
        }
        for ((.., coefficient), place) in expression.products[start..].iter_mut().zip(places) {
            *coefficient /= divisor;
            if or_infinite(*coefficient).is_infinite() {
                return Err(place.error(format!(
                    "{coefficient:e} counts as infinite (1e20 and beyond do); a finite number is \
                     needed here"
                )));
            }
        }
        Ok(())
    }

    fn factor(&mut self) -> Result<usize, Error> {
        if self.at_name() { self.column() } else { Err(self.unexpected("the name of a variable")) }
    }
}
