//! Columns that equal functions of other columns, as the header states them, and the rules for
//! them.
//!
//! A point has a value of each function: none at an argument outside its domain, and none of a
//! quotient whose divisor is 0.

use crate::bounds::Side;
use crate::checker::{Checker, side};
use crate::exact::{Dyadic, Number, Plain, Sum};
use crate::functions::{BuiltIn, FloatRange, holds_above, holds_below};
use crate::rows::Row;
use crate::text::{Refusal, Words, rejected, unreadable};
use std::cmp::Ordering;

/// A column that equals a function of others.
#[derive(Debug, Clone)]
pub(crate) struct FunctionTerm {
    pub(crate) result: u32,
    pub(crate) of: Formula,
}

/// Values of a column that a bound excludes: those beyond one on a side, and this one if it is
/// taken.
struct Limit {
    side: Side,
    beyond: f64,
    is_taken: bool,
}

/// The function of a term, and the columns of its arguments.
#[derive(Debug, Clone)]
pub(crate) enum Formula {
    Product(u32, u32),
    /// The first column divided by the second one.
    Quotient(u32, u32),
    BuiltIn(BuiltIn, u32),
    /// A function that the checker does not know: what is said of it is assumed.
    Unknown(String, u32),
}

impl FunctionTerm {
    /// Reads a line of the header.
    pub(crate) fn read(words: &mut Words<'_>, many: usize) -> Result<Self, Refusal> {
        let result = words.index("column", many)? as u32;
        let name = words.word("a function")?;
        let column = |words: &mut Words<'_>| -> Result<u32, Refusal> {
            Ok(words.index("column", many)? as u32)
        };
        let of = match name {
            "product" => Formula::Product(column(words)?, column(words)?),
            "quotient" => Formula::Quotient(column(words)?, column(words)?),
            "power" => {
                let exponent = words.number("the exponent")?;
                Formula::BuiltIn(BuiltIn::Power(exponent), column(words)?)
            }
            "own" => {
                let of = column(words)?;
                Formula::Unknown(words.name(), of)
            }
            _ => match BuiltIn::named(name) {
                Some(function) => Formula::BuiltIn(function, column(words)?),
                None => return unreadable(format!("there is no function `{name}`")),
            },
        };
        Ok(FunctionTerm { result, of })
    }

    /// All its columns: the result and the arguments.
    pub(crate) fn columns(&self) -> Vec<u32> {
        match self.of {
            Formula::Product(a, b) | Formula::Quotient(a, b) => vec![self.result, a, b],
            Formula::BuiltIn(_, a) | Formula::Unknown(_, a) => vec![self.result, a],
        }
    }

    /// The column that is the product of two others, and these.
    fn factors(&self) -> Option<(u32, [u32; 2])> {
        match self.of {
            Formula::Product(a, b) => Some((self.result, [a, b])),
            Formula::Quotient(a, b) => Some((a, [self.result, b])),
            _ => None,
        }
    }

    /// The value at a point in floats, if it is known: for the judgement of points.
    pub(crate) fn value_near(&self, at: impl Fn(u32) -> f64) -> Option<f64> {
        Some(match &self.of {
            Formula::Product(a, b) => at(*a) * at(*b),
            Formula::Quotient(a, b) => at(*a) / at(*b),
            Formula::BuiltIn(function, a) => function.value_near(at(*a)),
            Formula::Unknown(..) => return None,
        })
    }
}

impl Checker {
    /// A row of a term: the result (of a quotient, its numerator) less multiples of the arguments
    /// (of a quotient, of the result and the divisor) is on a side of a number, at all values
    /// between the present bounds.
    pub(crate) fn enclosure(&mut self, words: &mut Words<'_>) -> Result<(), Refusal> {
        let term = self.term(words)?;
        let (side, value) = (side(words)?, words.number("the value")?);
        let count = if term.factors().is_some() { 2 } else { 1 };
        let mut slopes = Vec::new();
        for _ in 0..count {
            slopes.push(words.number("a slope")?);
        }
        let (of, arguments) = match (term.factors(), &term.of) {
            (Some((of, factors)), _) => {
                let ranges = factors.map(|column| self.bounds.of(column as usize));
                let line = ([slopes[0], slopes[1]], value);
                if !product_holds(ranges, line, (side, false), &mut self.sums.total)? {
                    return rejected("the product is on the other side within the bounds");
                }
                (of, factors.to_vec())
            }
            (None, Formula::BuiltIn(function, column)) => {
                let range = self.range(*column);
                let line = (slopes[0], value);
                let holds = match side {
                    Side::Lower => holds_below(*function, range, line, false),
                    Side::Upper => holds_above(*function, range, line, false),
                };
                if !holds {
                    return rejected("the function is not proved to be on that side of the line");
                }
                (term.result, vec![*column])
            }
            (None, Formula::Unknown(name, column)) => {
                self.assume(name);
                (term.result, vec![*column])
            }
            (None, _) => return Ok(()),
        };
        let one = Number::Float(1.0);
        let mut terms = vec![(of, 1.0, one)];
        terms.extend(arguments.iter().zip(&slopes).map(|(column, slope)| (*column, -slope, one)));
        let mut row = Row::combination(&mut terms, &mut self.sums.column)?;
        let value = Some(Dyadic::from_f64(value));
        match side {
            Side::Lower => row.lower = value,
            Side::Upper => row.upper = value,
        }
        self.facts.push(row);
        Ok(())
    }

    /// A bound of a column of a term: beyond it, no values between the present bounds are those of
    /// the function.
    pub(crate) fn inverse(&mut self, words: &mut Words<'_>) -> Result<(), Refusal> {
        let term = self.term(words)?;
        let columns = term.columns();
        let place = words.index("place in the term", columns.len())?;
        let (side, value) = (side(words)?, words.number("the bound")?);
        let Some(&column) = columns.get(place) else { return Ok(()) };
        if !self.bounds.is_tighter(column as usize, side, value) {
            return Ok(());
        }
        // A column that takes whole numbers is beyond a value from the next one on.
        let is_integral = self.is_integral(column as usize);
        let beyond = match (is_integral, side) {
            (false, _) => value,
            (true, _) if value.fract() != 0.0 => {
                return rejected(format!(
                    "the column is integral, and {} is not whole",
                    Plain(value)
                ));
            }
            (true, Side::Lower) => value - 1.0,
            (true, Side::Upper) => value + 1.0,
        };
        let limit = Limit { side, beyond, is_taken: is_integral };
        let is_proved = match (&term.of, term.factors()) {
            (Formula::Unknown(name, _), _) => {
                self.assume(name);
                true
            }
            (Formula::BuiltIn(function, of), _) => {
                self.is_beyond(*function, (term.result, *of), place, &limit)
            }
            (_, Some((product, factors))) if product == column && factors != [product; 2] => {
                self.misses_product(factors, &limit)?
            }
            (_, Some((product, factors))) => {
                let other = if factors[0] == column { factors[1] } else { factors[0] };
                // A divisor is not 0.
                let divides = matches!(term.of, Formula::Quotient(_, by) if by == other);
                self.misses_factor((product, other, divides), &limit)?
            }
            _ => false,
        };
        if !is_proved {
            let name = self.name(column as usize);
            return rejected(format!(
                "the function does not bound column {name} by {}",
                Plain(value)
            ));
        }
        self.tighten(column as usize, side, value);
        Ok(())
    }

    fn term(&self, words: &mut Words<'_>) -> Result<FunctionTerm, Refusal> {
        let index = words.index("term", self.program.terms.len())?;
        match self.program.terms.get(index) {
            Some(term) => Ok(term.clone()),
            None => rejected(format!("there is no term {index}")),
        }
    }

    fn assume(&mut self, name: &str) {
        *self.assumed.entry(name.to_string()).or_insert(0) += 1;
    }

    fn range(&self, column: u32) -> FloatRange {
        let (lower, upper) = self.bounds.of(column as usize);
        FloatRange::new(lower, upper)
    }

    /// Whether a built-in function of values between the bounds is never its result if that, or the
    /// argument, is beyond a value.
    fn is_beyond(
        &self,
        function: BuiltIn,
        (result, of): (u32, u32),
        place: usize,
        limit: &Limit,
    ) -> bool {
        let Limit { side, beyond, is_taken } = *limit;
        let (value, x) = (self.range(result), self.range(of));
        if place == 0 {
            return match side {
                Side::Lower => holds_below(function, x, (0.0, beyond), is_taken),
                Side::Upper => holds_above(function, x, (0.0, beyond), is_taken),
            };
        }
        let domain = function.domain();
        let (rest, is_outside) = match side {
            Side::Lower => {
                let rest = FloatRange { upper: x.upper.min(beyond), ..x };
                (rest, beyond < domain.lower || (beyond == domain.lower && !is_taken))
            }
            Side::Upper => {
                let rest = FloatRange { lower: x.lower.max(beyond), ..x };
                (rest, beyond > domain.upper || (beyond == domain.upper && !is_taken))
            }
        };
        is_outside
            || holds_below(function, rest, (0.0, value.upper), true)
            || holds_above(function, rest, (0.0, value.lower), true)
    }

    /// Whether no product of factors between their bounds is beyond a value.
    fn misses_product(&mut self, factors: [u32; 2], limit: &Limit) -> Result<bool, Refusal> {
        let ranges = factors.map(|column| self.bounds.of(column as usize));
        let Limit { side, beyond, is_taken } = *limit;
        product_holds(ranges, ([0.0; 2], beyond), (side, is_taken), &mut self.sums.total)
    }

    /// Whether a factor that is beyond a value makes products that are beyond their bounds: the
    /// other factor has one sign, so that the product moves on with the factor.
    fn misses_factor(
        &mut self,
        (product, other, divides): (u32, u32, bool),
        limit: &Limit,
    ) -> Result<bool, Refusal> {
        let Limit { side, beyond, is_taken } = *limit;
        let ends = self.bounds.of(other as usize);
        let (lower, upper) = self.bounds.of(product as usize);
        let is_positive = ends.0 >= 0.0;
        if !(is_positive || ends.1 <= 0.0) {
            return Ok(false);
        }
        let is_upper = (side == Side::Upper) == is_positive;
        let limit = if is_upper { upper } else { lower };
        if !limit.is_finite() {
            return Ok(false);
        }
        let sum = &mut self.sums.total;
        for end in [ends.0, ends.1] {
            let sign = if end.is_finite() {
                sum.add(beyond, end);
                sum.subtract(limit, 1.0);
                sum.take_sign()?
            } else {
                // The value times large numbers, which the limit is nothing beside.
                match (beyond == 0.0, (beyond > 0.0) == (end > 0.0)) {
                    (true, _) => compare(0.0, limit),
                    (false, true) => Ordering::Greater,
                    (false, false) => Ordering::Less,
                }
            };
            // A factor that may be 0 leaves the product 0, however large the other is.
            let is_beyond = match sign {
                Ordering::Equal => !is_taken && (divides || end != 0.0),
                own => own == if is_upper { Ordering::Greater } else { Ordering::Less },
            };
            if !is_beyond {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

/// Whether `x y - a x - b y` is on a side of a value, or strictly so, for all x and y between
/// bounds.
///
/// For each y it is linear in x, and the reverse, so that it is least at a corner. An end that is
/// infinite stands for a direction, in which it must not fall.
fn product_holds(
    [xs, ys]: [(f64, f64); 2],
    ([a, b], value): ([f64; 2], f64),
    (side, is_strict): (Side, bool),
    sum: &mut Sum,
) -> Result<bool, Refusal> {
    if xs.0 > xs.1 || ys.0 > ys.1 {
        return Ok(true);
    }
    let wanted = |sign: Ordering| match side {
        Side::Lower => sign != Ordering::Less,
        Side::Upper => sign != Ordering::Greater,
    };
    // A constant product needs no ends of the other factor.
    let has_end = |ends: (f64, f64)| ends.0.is_finite() || ends.1.is_finite();
    if !has_end(xs) || !has_end(ys) {
        return Ok(false);
    }
    for x in [xs.0, xs.1] {
        for y in [ys.0, ys.1] {
            let sign = match (x.is_finite(), y.is_finite()) {
                (true, true) => {
                    sum.add(x, y);
                    sum.subtract(a, x);
                    sum.subtract(b, y);
                    sum.subtract(value, 1.0);
                    let sign = sum.take_sign()?;
                    if is_strict && sign == Ordering::Equal {
                        return Ok(false);
                    }
                    sign
                }
                // The growth along x is y - a, and along y it is x - b.
                (false, true) => direction(x, compare(y, a)),
                (true, false) => direction(y, compare(x, b)),
                (false, false) => direction(x, compare(y, 0.0)),
            };
            if !wanted(sign) {
                return Ok(false);
            }
        }
    }
    Ok(true)
}

fn compare(a: f64, b: f64) -> Ordering {
    a.partial_cmp(&b).unwrap_or(Ordering::Equal)
}

/// The sign of a growth in the direction of an infinite end.
fn direction(end: f64, growth: Ordering) -> Ordering {
    if end > 0.0 { growth } else { growth.reverse() }
}
