//! Expressions: an operator comes before its arguments. They are computed as polynomials while they
//! are read, on a stack of their own, so that no depth of nesting can end the program.

use super::cursor::Cursor;
use super::operators::{Operator, not_taken, refused};
use super::polynomial::Polynomial;
use crate::error::Error;
use crate::model::ids::ModelTag;
use crate::model::nonlinear::Nonlinear;

/// The columns and defined variables to which expressions refer.
#[derive(Debug)]
pub(super) struct Known {
    /// The model that is to be.
    pub(super) tag: ModelTag,
    pub(super) columns: usize,
    /// Names of functions from outside, by number.
    pub(super) functions: Vec<Option<String>>,
    /// Defined variables, which are numbered behind the columns.
    pub(super) definitions: Vec<Option<Polynomial>>,
}

/// An operator whose arguments are being read.
struct OpenOperator {
    operator: Operator,
    place: usize,
    missing: usize,
    arguments: Vec<Polynomial>,
}

/// Reads an expression.
pub(super) fn read(cursor: &mut Cursor<'_>, known: &Known) -> Result<Polynomial, Error> {
    let mut open: Vec<OpenOperator> = Vec::new();
    loop {
        let place = cursor.place();
        let mut value = match cursor.letter() {
            Some(b'n') => Polynomial::constant(cursor.finite("a constant")?),
            Some(b's') => Polynomial::constant(cursor.short("a constant")? as f64),
            Some(b'l') => Polynomial::constant(cursor.integer("a constant")? as f64),
            Some(b'v') => variable(cursor, known)?,
            Some(b'o') => {
                let code = cursor.integer("the number of an operator")?;
                let operator = Operator::of(code).ok_or_else(|| refused(cursor, place, code))?;
                let missing = match operator.arity() {
                    Some(count) => count,
                    None => cursor.count("the number of summands")?,
                };
                if missing > 0 {
                    open.push(OpenOperator { operator, place, missing, arguments: Vec::new() });
                    continue;
                }
                Polynomial::default()
            }
            Some(b'f') => return Err(function(cursor, known, place)),
            Some(b'h') => {
                let help = "texts are arguments of functions from outside, which are not read: replace the \
                            function by a piecewise linear one";
                return Err(not_taken(cursor, place, "a text", help));
            }
            _ => {
                let what = "expected an expression: `o`, `n` or `v` and a number";
                return Err(cursor.error(place, what));
            }
        };
        // It is the last argument of as many operators as it completes.
        loop {
            let Some(mut last) = open.pop() else { return Ok(value.merged()) };
            last.arguments.push(value);
            last.missing -= 1;
            if last.missing > 0 {
                open.push(last);
                break;
            }
            value = last.value(cursor, known.tag)?;
        }
    }
}

/// A column or a defined variable.
fn variable(cursor: &mut Cursor<'_>, known: &Known) -> Result<Polynomial, Error> {
    let place = cursor.place();
    let end = known.columns + known.definitions.len();
    let index = cursor.below(end, "a variable")?;
    match index.checked_sub(known.columns) {
        None => Ok(Polynomial::column(index)),
        Some(at) => known.definitions[at].clone().ok_or_else(|| {
            cursor.error(place, format!("`v{index}` is used before the segment `V{index}`"))
        }),
    }
}

fn function(cursor: &mut Cursor<'_>, known: &Known, place: usize) -> Error {
    match cursor.below(known.functions.len(), "a function") {
        Err(error) => error,
        Ok(index) => {
            let name = known.functions[index].clone().unwrap_or_else(|| format!("f{index}"));
            let help = "functions from outside are not read: replace it by a piecewise linear one";
            not_taken(cursor, place, name, help)
        }
    }
}

impl OpenOperator {
    /// The value of an operator whose arguments are all there.
    fn value(self, cursor: &Cursor<'_>, tag: ModelTag) -> Result<Polynomial, Error> {
        let (operator, place) = (self.operator, self.place);
        let mut arguments = self.arguments.into_iter();
        let mut next = || arguments.next().unwrap_or_default();
        match operator {
            Operator::Plus | Operator::Sum => {
                let first = next();
                Ok(arguments.fold(first, Polynomial::plus))
            }
            Operator::Minus => {
                let left = next();
                Ok(left.plus(next().scaled(-1.0)))
            }
            Operator::Negate => Ok(next().scaled(-1.0)),
            Operator::Times => {
                let (left, right) = (next(), next());
                Ok(left.times(right, tag))
            }
            Operator::Square => {
                let base = next();
                Ok(power(base.merged(), 2.0, tag))
            }
            Operator::Divide => {
                let (left, right) = (next(), next().merged());
                match right.as_constant() {
                    Some(by) if by != 0.0 => Ok(divided(left, by)),
                    Some(_) => Err(cursor.error(place, "the expression divides by 0")),
                    None => {
                        let (left, right) = (left.into_nonlinear(tag), right.into_nonlinear(tag));
                        Ok(Polynomial::of(left / right))
                    }
                }
            }
            Operator::Power => {
                let (base, exponent) = (next().merged(), next().merged());
                Ok(match (base.as_constant(), exponent.as_constant()) {
                    (Some(base), Some(exponent)) => Polynomial::constant(base.powf(exponent)),
                    (None, Some(exponent)) => power(base, exponent, tag),
                    (Some(base), None) if base > 0.0 => {
                        Polynomial::of((exponent.into_nonlinear(tag) * base.ln()).exp())
                    }
                    (Some(_), None) => {
                        let help = "a power with a base that is not positive has no value between \
                                    whole exponents";
                        return Err(not_taken(cursor, place, "^", help));
                    }
                    (None, None) => {
                        let (base, exponent) =
                            (base.into_nonlinear(tag), exponent.into_nonlinear(tag));
                        Polynomial::of((exponent * base.ln()).exp())
                    }
                })
            }
            Operator::Minimum | Operator::Maximum => {
                let sign = if operator == Operator::Maximum { 1.0 } else { -1.0 };
                let mut all = std::iter::from_fn(|| arguments.next());
                let first = all.next().unwrap_or_default().scaled(sign).into_nonlinear(tag);
                let most =
                    all.fold(first, |most, other| most.max(other.scaled(sign).into_nonlinear(tag)));
                Ok(Polynomial::of(most * sign))
            }
            Operator::Absolute => Ok(Polynomial::of(next().into_nonlinear(tag).abs())),
            Operator::DecimalLogarithm => {
                let scale = std::f64::consts::LOG10_E;
                Ok(Polynomial::of(next().into_nonlinear(tag).ln() * scale))
            }
            Operator::Atan2 => {
                let (y, x) = (next().into_nonlinear(tag), next().into_nonlinear(tag));
                Ok(Polynomial::of(y.atan2(x)))
            }
            Operator::Elementary(function) => {
                let of = next().merged();
                Ok(match of.as_constant() {
                    Some(x) => Polynomial::constant(function.value(x)),
                    None => {
                        let of = of.into_nonlinear(tag);
                        Polynomial::of(Nonlinear::elementary(function.clone(), of))
                    }
                })
            }
        }
    }
}

/// A power with a constant exponent.
fn power(base: Polynomial, exponent: f64, tag: ModelTag) -> Polynomial {
    match exponent {
        0.0 => Polynomial::constant(1.0),
        1.0 => base,
        2.0 if base.products.is_empty() && base.functions.is_zero() => {
            base.clone().times(base, tag)
        }
        _ => Polynomial::of(base.into_nonlinear(tag).pow(exponent)),
    }
}

/// Each coefficient is divided, which rounds once.
fn divided(mut left: Polynomial, by: f64) -> Polynomial {
    left.constant /= by;
    left.linear.iter_mut().for_each(|(_, a)| *a /= by);
    left.products.iter_mut().for_each(|(_, q)| *q /= by);
    left.functions = left.functions / by;
    left
}
