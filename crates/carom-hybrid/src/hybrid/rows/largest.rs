//! The largest value of a linear function over a box and half-spaces, by a dual simplex method.
//!
//! The dictionary is dense (Chvátal, Linear Programming, 1983; the dual method with bounds of
//! variables: Koberstein, The dual simplex method, techniques for a fast and stable implementation,
//! 2005), because a step has few variables and rows. What it finds are only multipliers μ >= 0 of
//! the rows `a_k z + b_k <= 0`. The bound is `max (c - Σ μ_k a_k) z - Σ μ_k b_k` over the box in
//! intervals, which is right for any multipliers (weak duality), so that no rounding of the method
//! matters.

use super::bound::{NOISE, size};
use crate::hybrid::step::AffineForm;
use crate::interval::Interval;

/// Entries below this fraction of a row's largest are no pivots (no unit).
const PIVOT: f64 = 1e-9;

/// By how much a variable may be outside of its bounds, relative to its size (no unit).
const VIOLATION: f64 = 1e-9;

/// A proved upper bound of a form over the box and the rows, which are at most 0: the largest value
/// but for rounding, or the bound of the box if the method fails. Values within rounding of 0 are
/// 0.
pub(super) fn largest(form: &AffineForm, domain: &[Interval], rows: &[AffineForm]) -> f64 {
    let box_bound = form.over(domain).upper;
    let used: Vec<&AffineForm> = rows.iter().filter(|row| !row.is_constant()).collect();
    let Some(mut dictionary) = Dictionary::new(form, domain, &used) else { return box_bound };
    dictionary.improve();
    let multipliers = dictionary.multipliers();
    let mut rest: Vec<Interval> = form.factors.iter().map(|c| Interval::point(*c)).collect();
    let mut sum = Interval::point(form.constant);
    let mut magnitude = size(&form.factors, domain) + form.constant.abs();
    for (row, weight) in used.iter().zip(multipliers).filter(|(_, weight)| *weight > 0.0) {
        for (rest, a) in rest.iter_mut().zip(&row.factors).filter(|(_, a)| **a != 0.0) {
            *rest = *rest + Interval::point(-weight) * *a;
        }
        sum = sum + Interval::point(-weight) * row.constant;
        magnitude += weight * (size(&row.factors, domain) + row.constant.abs());
    }
    for (rest, range) in rest.iter().zip(domain) {
        let ends = [*range * rest.lower, *range * rest.upper];
        sum = sum + ends[0].hull(ends[1]);
    }
    let bound = if sum.upper.is_nan() { box_bound } else { sum.upper.min(box_bound) };
    if bound.abs() <= NOISE * magnitude { 0.0 } else { bound }
}

/// The range of a form over the box and the rows; over the box if the rows exclude all of it.
pub(super) fn range(form: &AffineForm, domain: &[Interval], rows: &[AffineForm]) -> Interval {
    // Not -0.
    let lower = 0.0 - largest(&form.scaled(-1.0), domain, rows);
    let range = Interval { lower, upper: largest(form, domain, rows) };
    if range.is_empty() { form.over(domain) } else { range }
}

/// Basic variables as functions of the others, and the function that is maximised.
///
/// Variables are those of the box, and then the slack of each row.
struct Dictionary {
    bounds: Vec<Interval>,
    /// The variable of each row.
    basic: Vec<usize>,
    /// The variable of each column.
    free: Vec<usize>,
    /// Whether a column's variable is at its upper bound.
    at_upper: Vec<bool>,
    /// `basic = constant - Σ entries * free`.
    entries: Vec<Vec<f64>>,
    constants: Vec<f64>,
    /// The coefficients of the function in the columns: not positive at lower bounds, not negative
    /// at upper ones.
    costs: Vec<f64>,
}

impl Dictionary {
    /// The slacks as basic variables; `None` if the box does not bound the function.
    fn new(form: &AffineForm, domain: &[Interval], rows: &[&AffineForm]) -> Option<Self> {
        let n = domain.len();
        let at_upper: Vec<bool> = form
            .factors
            .iter()
            .zip(domain)
            .map(|(c, range)| *c > 0.0 || *c == 0.0 && range.lower.is_infinite())
            .collect();
        let missing = |((c, range), up): ((&f64, &Interval), &bool)| {
            *c != 0.0 && (if *up { range.upper } else { range.lower }).is_infinite()
        };
        if form.factors.iter().zip(domain).zip(&at_upper).any(missing) {
            return None;
        }
        let slack = Interval { lower: 0.0, upper: f64::INFINITY };
        Some(Dictionary {
            bounds: domain.iter().copied().chain(rows.iter().map(|_| slack)).collect(),
            basic: (n..n + rows.len()).collect(),
            free: (0..n).collect(),
            at_upper,
            entries: rows.iter().map(|row| row.factors.clone()).collect(),
            constants: rows.iter().map(|row| -row.constant).collect(),
            costs: form.factors.clone(),
        })
    }

    /// Pivots until the basic variables are within their bounds, or for some time: the multipliers
    /// are of use in any case.
    fn improve(&mut self) {
        for _ in 0..10 + 4 * self.bounds.len() {
            let Some((row, rises)) = self.leaving() else { return };
            let Some(column) = self.entering(row, rises) else { return };
            self.pivot(row, column, rises);
        }
    }

    /// The value of a column's variable: one of its bounds, or 0 if it has none.
    fn value(&self, column: usize) -> f64 {
        let Interval { lower, upper } = self.bounds[self.free[column]];
        let value = if self.at_upper[column] { upper } else { lower };
        if value.is_finite() { value } else { 0.0 }
    }

    /// The basic variable that is farthest outside of its bounds, and whether it has to rise.
    fn leaving(&self) -> Option<(usize, bool)> {
        let values: Vec<f64> = (0..self.free.len()).map(|column| self.value(column)).collect();
        let mut farthest: Option<(f64, usize, bool)> = None;
        for (row, entries) in self.entries.iter().enumerate() {
            let (mut value, mut size) = (self.constants[row], self.constants[row].abs());
            for (entry, at) in entries.iter().zip(&values) {
                value -= entry * at;
                size += (entry * at).abs();
            }
            let Interval { lower, upper } = self.bounds[self.basic[row]];
            let (miss, rises) =
                if value < lower { (lower - value, true) } else { (value - upper, false) };
            let share = miss / size.max(f64::MIN_POSITIVE);
            if share > VIOLATION && farthest.is_none_or(|(most, ..)| share > most) {
                farthest = Some((share, row, rises));
            }
        }
        farthest.map(|(_, row, rises)| (row, rises))
    }

    /// The column whose cost becomes 0 first; `None` if no point satisfies the row.
    fn entering(&self, row: usize, rises: bool) -> Option<usize> {
        let entries = &self.entries[row];
        let least = PIVOT * entries.iter().fold(0.0_f64, |most, entry| most.max(entry.abs()));
        let mut best: Option<(f64, f64, usize)> = None;
        for (column, &entry) in entries.iter().enumerate().filter(|(_, a)| a.abs() > least) {
            let Interval { lower, upper } = self.bounds[self.free[column]];
            let is_free = lower.is_infinite() && upper.is_infinite();
            let helps = (entry < 0.0) == (rises != self.at_upper[column]);
            if lower == upper || !(helps || is_free) {
                continue;
            }
            let ratio = (self.costs[column] / entry).abs();
            let is_first = |(least, size, _): (f64, f64, usize)| {
                ratio < least || ratio == least && entry.abs() > size
            };
            if best.is_none_or(is_first) {
                best = Some((ratio, entry.abs(), column));
            }
        }
        best.map(|(.., column)| column)
    }

    fn pivot(&mut self, row: usize, column: usize, rises: bool) {
        let pivot = self.entries[row][column];
        let mut own = std::mem::take(&mut self.entries[row]);
        own.iter_mut().for_each(|entry| *entry /= pivot);
        own[column] = 1.0 / pivot;
        let constant = self.constants[row] / pivot;
        for (other, entries) in self.entries.iter_mut().enumerate().filter(|(r, _)| *r != row) {
            let factor = std::mem::replace(&mut entries[column], 0.0);
            if factor != 0.0 {
                entries.iter_mut().zip(&own).for_each(|(entry, a)| *entry -= factor * a);
                self.constants[other] -= factor * constant;
            }
        }
        let cost = std::mem::replace(&mut self.costs[column], 0.0);
        self.costs.iter_mut().zip(&own).for_each(|(own_cost, a)| *own_cost -= cost * a);
        self.entries[row] = own;
        self.constants[row] = constant;
        std::mem::swap(&mut self.basic[row], &mut self.free[column]);
        self.at_upper[column] = !rises;
    }

    /// The multipliers of the rows.
    fn multipliers(&self) -> Vec<f64> {
        let n = self.free.len();
        let mut multipliers = vec![0.0; self.basic.len()];
        for (variable, cost) in self.free.iter().zip(&self.costs).filter(|(v, _)| **v >= n) {
            multipliers[variable - n] = (-cost).max(0.0);
        }
        multipliers
    }
}
