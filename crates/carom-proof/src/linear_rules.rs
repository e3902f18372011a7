//! The rules for linear rows: a bound from a row, and a combination of rows.

use crate::bounds::{Bounds, Side};
use crate::exact::{Dyadic, Number, Plain, Sum};
use crate::rows::Row;
use crate::text::{Refusal, Words, rejected};
use std::cmp::Ordering;

/// Sums that are used again and again; all are 0 between steps.
#[derive(Debug, Default)]
pub(crate) struct Sums {
    /// Of a column.
    pub(crate) column: Sum,
    /// Of a step.
    pub(crate) total: Sum,
}

/// That `row` and the bounds of its other columns imply a bound of `column`.
///
/// If the column were beyond the bound, its term would exceed what the side of the row leaves to it
/// when all other terms are as small as they can be. A value that is only integral is beyond the
/// bound from the next whole number on.
pub(crate) fn bound(
    row: &Row,
    (column, side, value): (usize, Side, f64),
    is_integral: bool,
    bounds: &Bounds,
    sums: &mut Sums,
) -> Result<(), Refusal> {
    let Some(coefficient) = row.coefficient(column) else {
        return rejected("the fact does not contain the column");
    };
    if is_integral && value.fract() != 0.0 {
        return rejected(format!("the column is integral, and {} is not whole", Plain(value)));
    }
    let is_upper = (side == Side::Upper) == (coefficient.sign() == Ordering::Greater);
    let limit = if is_upper { &row.upper } else { &row.lower };
    let Some(limit) = limit else {
        let which = if is_upper { "upper" } else { "lower" };
        return rejected(format!("the fact has no {which} side"));
    };
    // `excess` is how far the row is violated at the bound, or at the next whole number.
    let excess = &mut sums.total;
    excess.add(coefficient, value);
    if is_integral {
        let next = if side == Side::Upper { 1.0 } else { -1.0 };
        excess.add(coefficient, next);
    }
    for (other, coefficient) in row.entries().filter(|entry| entry.0 as usize != column) {
        let extreme = if is_upper {
            bounds.smallest(other, coefficient)
        } else {
            bounds.largest(other, coefficient)
        };
        if !extreme.is_finite() {
            return rejected(format!("column {other} of the fact has no bound"));
        }
        excess.add(coefficient, extreme);
    }
    excess.subtract(limit, 1.0);
    let mut excess = excess.take()?;
    if !is_upper {
        excess = excess.negated();
    }
    match excess.sign() {
        Ordering::Greater => Ok(()),
        Ordering::Equal if !is_integral => Ok(()),
        _ => rejected(format!(
            "the fact does not imply the bound {}: with {}, it holds with {} to spare",
            Plain(value),
            if is_integral { "the next whole number" } else { "the column at it" },
            excess.negated(),
        )),
    }
}

/// The number of facts, facts and their multipliers.
pub(crate) fn multipliers(
    words: &mut Words<'_>,
    facts: usize,
) -> Result<Vec<(usize, f64)>, Refusal> {
    let mut all = Vec::new();
    for _ in 0..words.count("the number of facts")? {
        let fact = words.index("fact", facts)?;
        all.push((fact, words.number("a multiplier")?));
    }
    Ok(all)
}

/// The sum of multiples of facts: a row with a lower side.
pub(crate) fn combination(
    facts: &[Row],
    multipliers: &[(usize, f64)],
    sums: &mut Sums,
) -> Result<Row, Refusal> {
    let mut terms = Vec::new();
    let mut missing = None;
    for &(fact, multiplier) in multipliers.iter().filter(|pair| pair.1 != 0.0) {
        let Some(row) = facts.get(fact) else { continue };
        terms.extend(row.entries().map(|(column, value)| (column, multiplier, value)));
        match if multiplier > 0.0 { &row.lower } else { &row.upper } {
            Some(side) => sums.total.add(multiplier, side),
            None => missing = Some((fact, multiplier)),
        }
    }
    let side = sums.total.take()?;
    if let Some((fact, multiplier)) = missing {
        let which = if multiplier > 0.0 { "lower" } else { "upper" };
        let multiplier = Plain(multiplier);
        return rejected(format!("fact {fact} has no {which} side, for multiplier {multiplier}"));
    }
    let mut row = Row::combination(&mut terms, &mut sums.column)?;
    row.lower = Some(side);
    Ok(row)
}

/// That no values within the bounds reach the lower side of a row.
pub(crate) fn contradiction(row: &Row, bounds: &Bounds, sums: &mut Sums) -> Result<(), Refusal> {
    let zero = Dyadic::zero();
    for (column, coefficient) in row.entries() {
        let extreme = bounds.largest(column, coefficient);
        if !extreme.is_finite() {
            let value = in_words(coefficient);
            return rejected(format!("column {column} remains, times {value}, and has no bound"));
        }
        sums.total.add(coefficient, extreme);
    }
    sums.total.subtract(row.lower.as_ref().unwrap_or(&zero), 1.0);
    let excess = sums.total.take()?;
    if row.lower.is_some() && excess.sign() == Ordering::Less {
        return Ok(());
    }
    rejected(format!("the combination is no contradiction: it holds with {excess} to spare"))
}

fn in_words(number: Number<'_>) -> String {
    match number {
        Number::Float(value) => Plain(value).to_string(),
        Number::Exact(value) => value.to_string(),
    }
}
