//! Far columns: columns whose values have their leading digits in common.
//!
//! Takes columns between bounds that are far from 0 and near to each other, or with a single bound
//! that is far away; leaves them measured from there.
//!
//! A term of 6e8 has seven digits behind the point, and what a relaxation computes from it has
//! fewer, so that neither a gap of a millionth nor a contradiction of 0.1 can be told. Measured
//! from its bound, the column has them all. Only shifts are made that change no limit of the
//! program by rounding. The bounds of a column without any are those that rows imply.

use super::postsolve::{ColumnMeaning, Restored, Undo};
use super::working_program::WorkingProgram;
use crate::sum::{exact_product, exact_sum};
use crate::tolerance;
use std::collections::BTreeMap;

/// The least distance from 0 of a far column, in its unit.
const FAR_COLUMN: f64 = 1e5;

/// A column that is measured from `shift`.
#[derive(Debug)]
struct FarColumn {
    column: usize,
    shift: f64,
}

pub(super) fn apply(work: &mut WorkingProgram, column: usize) -> usize {
    if work.is_held(column) || !work.is_straight(column) {
        return 0;
    }
    let Some(shift) = shift(work, column) else { return 0 };
    let bounds = [work.lower[column], work.upper[column]].map(|bound| less(bound, shift));
    let ([Some(lower), Some(upper)], true) = (bounds, is_exact(work, column, shift)) else {
        return 0;
    };
    for row in work.uses[column].clone() {
        let by = work.coefficient(row, column) * shift;
        work.row_lower[row] -= by;
        work.row_upper[row] -= by;
    }
    work.add_to_objective(work.linear[column], shift);
    if lower.is_infinite() || upper.is_infinite() {
        work.spread[column] += shift.abs() / tolerance::FREE_RADIUS;
    }
    (work.lower[column], work.upper[column]) = (lower, upper);
    work.push(FarColumn { column, shift });
    1
}

/// The whole number from which a column is to be measured; `None` for a column that is not far
/// from 0.
fn shift(work: &WorkingProgram, column: usize) -> Option<f64> {
    let (mut lower, mut upper) = (work.lower[column], work.upper[column]);
    if lower.is_infinite() && upper.is_infinite() {
        for &row in &work.uses[column] {
            let [least, most] = work.implied_bounds(row, column).0;
            (lower, upper) = (lower.max(least), upper.min(most));
        }
        if lower.is_infinite() || upper.is_infinite() {
            return None;
        }
    }
    let end = if lower.abs() <= upper.abs() { lower } else { upper };
    let width = upper - lower;
    // A far bound on one side alone may stand for none, where 0 is beyond it.
    let is_far = end.abs() >= FAR_COLUMN
        && (width <= end.abs() || width.is_infinite() && (lower > 0.0 || upper < 0.0));
    is_far.then(|| end.trunc())
}

/// Whether a shift changes the limits of all rows of a column without rounding.
fn is_exact(work: &WorkingProgram, column: usize, shift: f64) -> bool {
    work.column(column).all(|(row, a)| {
        let (product, rest) = exact_product(a, shift);
        let limits = [work.row_lower[row], work.row_upper[row]];
        rest == 0.0 && limits.into_iter().all(|limit| less(limit, product).is_some())
    })
}

/// `limit - by`, unless that is rounded.
fn less(limit: f64, by: f64) -> Option<f64> {
    if limit.is_infinite() {
        return Some(limit);
    }
    let (difference, rest) = exact_sum(limit, -by);
    (rest == 0.0).then_some(difference)
}

impl Undo for FarColumn {
    fn primal(&self, x: &mut [f64]) {
        x[self.column] += self.shift;
    }

    fn restate(&self, meanings: &mut [ColumnMeaning]) {
        meanings[self.column].put(1.0, self.shift);
    }

    fn carry(&self, known: &mut BTreeMap<usize, f64>) {
        known.entry(self.column).and_modify(|value| *value -= self.shift);
    }

    /// Multipliers do not depend on where a column is measured from.
    fn dual(&self, _all: &mut Restored) {}
}
