//! Rows that enclose a term over a box.
//!
//! Each row holds at all points of the graph over the box: coefficients are floats as they are, and
//! limits are rounded outward.

use super::term::{Shape, SmoothTerm, bounds};
use crate::elementary::Elementary;
use crate::interval::Interval;
use crate::presolve::Domain;

/// The row `lower <= sum a_j x_j <= upper`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct EnclosureRow {
    pub(crate) entries: Vec<(usize, f64)>,
    pub(crate) lower: f64,
    pub(crate) upper: f64,
    /// The multiples of the argument, or of the two factors, that are subtracted from the result,
    /// or from the product.
    pub(crate) slopes: [f64; 2],
}

impl EnclosureRow {
    /// By how much a point violates it.
    pub(crate) fn violation(&self, x: &[f64]) -> f64 {
        let sum: f64 = self.entries.iter().map(|&(j, a)| a * x[j]).sum();
        (self.lower - sum).max(sum - self.upper)
    }

    fn is_usable(&self) -> bool {
        let largest = self.entries.iter().fold(0.0_f64, |most, (_, a)| most.max(a.abs()));
        largest < 1e9 && (self.lower.abs() < 1e15 || self.upper.abs() < 1e15)
    }
}

/// The rows about a term over a domain, tight at the ends of the ranges and at a point if there is
/// one.
pub(crate) fn rows(term: &SmoothTerm, domain: &Domain, at: Option<&[f64]>) -> Vec<EnclosureRow> {
    let mut rows = Vec::with_capacity(6);
    match &term.shape {
        Shape::Elementary { function, of } => {
            let range = bounds(domain, *of);
            let [below, above] = term.sides();
            for is_below in [true, false] {
                if !if is_below { below } else { above } {
                    continue;
                }
                let middle = match at {
                    Some(x) => range.nearest(x[*of]),
                    None => middle(range),
                };
                for at in [middle, range.lower, range.upper] {
                    let line = (function, term.result, *of);
                    if at.is_finite()
                        && let Some(row) = line_row(line, range, at, is_below)
                        && !rows.contains(&row)
                    {
                        rows.push(row);
                    }
                }
            }
        }
        Shape::Bilinear([a, b]) => {
            let ranges = [bounds(domain, *a), bounds(domain, *b)];
            rows.extend(product_rows(term.result, [*a, *b], ranges, term.sides()));
        }
        Shape::Quotient([a, b]) => {
            // The numerator is the product of quotient and divisor.
            let ranges = [bounds(domain, term.result), bounds(domain, *b)];
            rows.extend(product_rows(*a, [term.result, *b], ranges, [true, true]));
        }
    }
    rows.retain(EnclosureRow::is_usable);
    rows
}

/// The row about an elementary term that a point violates most; `None` if it violates none by more
/// than a part of what it is off.
pub(crate) fn separate(term: &SmoothTerm, domain: &Domain, x: &[f64]) -> Option<EnclosureRow> {
    let Shape::Elementary { function, of } = &term.shape else { return None };
    let off = x[term.result] - term.value(x);
    if !off.is_finite() {
        return None;
    }
    let is_below = off < 0.0;
    if !term.sides()[usize::from(!is_below)] {
        return None;
    }
    let range = bounds(domain, *of);
    let row = line_row((function, term.result, *of), range, range.nearest(x[*of]), is_below)?;
    (row.is_usable() && row.violation(x) > 0.05 * off.abs()).then_some(row)
}

/// A point inside of a range.
fn middle(range: Interval) -> f64 {
    match (range.lower.is_finite(), range.upper.is_finite()) {
        (true, true) => 0.5 * range.lower + 0.5 * range.upper,
        (true, false) => range.lower + range.lower.abs().max(1.0),
        (false, true) => range.upper - range.upper.abs().max(1.0),
        (false, false) => 0.0,
    }
}

fn line_row(
    (function, result, of): (&Elementary, usize, usize),
    range: Interval,
    at: f64,
    is_below: bool,
) -> Option<EnclosureRow> {
    let line = function.line(range, at, is_below)?;
    let (lower, upper) =
        if is_below { (line.offset, f64::INFINITY) } else { (f64::NEG_INFINITY, line.offset) };
    let mut entries = vec![(result, 1.0)];
    if line.slope != 0.0 {
        entries.push((of, -line.slope));
    }
    entries.sort_by_key(|entry| entry.0);
    Some(EnclosureRow { entries, lower, upper, slopes: [line.slope, 0.0] })
}

/// The four rows about a product of columns `x` and `y` (McCormick 1976): with `x >= a` and
/// `y >= b`, `x y >= b x + a y - a b`, and so on.
fn product_rows(
    result: usize,
    [x, y]: [usize; 2],
    [xs, ys]: [Interval; 2],
    [below, above]: [bool; 2],
) -> impl Iterator<Item = EnclosureRow> {
    let corners = [
        (xs.lower, ys.lower, true),
        (xs.upper, ys.upper, true),
        (xs.lower, ys.upper, false),
        (xs.upper, ys.lower, false),
    ];
    corners.into_iter().filter_map(move |(a, b, is_below)| {
        let is_wanted = if is_below { below } else { above };
        if !is_wanted || !a.is_finite() || !b.is_finite() {
            return None;
        }
        let corner = Interval::point(a) * b;
        let (lower, upper) = match is_below {
            true => (-corner.upper, f64::INFINITY),
            false => (f64::NEG_INFINITY, -corner.lower),
        };
        let mut entries = vec![(result, 1.0), (x, -b), (y, -a)];
        merge_entries(&mut entries);
        Some(EnclosureRow { entries, lower, upper, slopes: [b, a] })
    })
}

/// Sorts entries by column and adds up those of one: it may be both factors, or result and factor.
pub(crate) fn merge_entries(entries: &mut Vec<(usize, f64)>) {
    entries.sort_by_key(|entry| entry.0);
    entries.dedup_by(|later, kept| {
        let is_same = later.0 == kept.0;
        kept.1 += if is_same { later.1 } else { 0.0 };
        is_same
    });
    entries.retain(|entry| entry.1 != 0.0);
}
