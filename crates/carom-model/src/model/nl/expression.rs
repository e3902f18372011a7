//! Expressions: an operator comes before its arguments. They are computed as polynomials while they
//! are read, on a stack of their own, so that no depth of nesting can end the program.

use super::cursor::Cursor;
use super::operators::{Operator, not_taken, refused};
use super::polynomial::Polynomial;
use crate::error::Error;

/// The columns and defined variables to which expressions refer.
#[derive(Debug)]
pub(super) struct Known {
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

const TOO_MANY_DEGREES: &str = "expressions have to be affine or quadratic: replace the product by a column and \
                                rows, or by a piecewise linear function";

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
            value = last.value(cursor)?;
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
    fn value(self, cursor: &Cursor<'_>) -> Result<Polynomial, Error> {
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
                let product = left.times(right);
                product.ok_or_else(|| not_taken(cursor, place, "*", TOO_MANY_DEGREES))
            }
            Operator::Square => square(next(), cursor, place),
            Operator::Divide => {
                let (left, right) = (next(), next().merged());
                match right.as_constant() {
                    Some(by) if by != 0.0 => Ok(divided(left, by)),
                    Some(_) => Err(cursor.error(place, "the expression divides by 0")),
                    None => Err(not_taken(
                        cursor,
                        place,
                        "/",
                        "it divides by a variable: multiply the row by it, where its sign is known",
                    )),
                }
            }
            Operator::Power => {
                let (base, exponent) = (next().merged(), next().merged());
                match (base.as_constant(), exponent.as_constant()) {
                    (_, Some(0.0)) => Ok(Polynomial::constant(1.0)),
                    (_, Some(1.0)) => Ok(base),
                    (Some(base), Some(exponent)) => Ok(Polynomial::constant(base.powf(exponent))),
                    (None, Some(2.0)) => square(base, cursor, place),
                    _ => Err(not_taken(
                        cursor,
                        place,
                        "^",
                        "of powers, squares are taken: replace it by a piecewise linear function",
                    )),
                }
            }
        }
    }
}

fn square(base: Polynomial, cursor: &Cursor<'_>, place: usize) -> Result<Polynomial, Error> {
    let square = base.clone().times(base);
    square.ok_or_else(|| not_taken(cursor, place, "^", TOO_MANY_DEGREES))
}

/// Each coefficient is divided, which rounds once.
fn divided(mut left: Polynomial, by: f64) -> Polynomial {
    left.constant /= by;
    left.linear.iter_mut().for_each(|(_, a)| *a /= by);
    left.products.iter_mut().for_each(|(_, q)| *q /= by);
    left
}
