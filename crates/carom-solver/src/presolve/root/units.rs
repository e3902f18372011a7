//! Units of columns and rows of tiny numbers.
//!
//! Takes columns with tiny bounds, and rows whose terms are tiny within the bounds; leaves them
//! times powers of two that bring bounds and terms near 1. Tolerances of rules and methods are
//! absolute, and `x <= 1e-8` lies below them.
//!
//! Ordinary numbers stay as they are. Multiplying by a power of two rounds nothing.

use super::postsolve::{Restored, Undo};
use super::working_program::WorkingProgram;
use crate::tolerance::SMALL_UNIT;
use std::collections::BTreeMap;

/// A column in another unit: its value is that of the program times `factor`.
#[derive(Debug)]
struct ColumnUnit {
    column: usize,
    factor: f64,
}

/// A row that was multiplied by `factor`.
#[derive(Debug)]
struct RowUnit {
    row: usize,
    factor: f64,
}

/// The power of two that brings a small magnitude near 1; `None` for other magnitudes.
fn factor_of(size: f64) -> Option<f64> {
    let factor = (-size.log2().floor()).min(1000.0).exp2();
    (size > 0.0 && size < SMALL_UNIT && factor.is_finite()).then_some(factor)
}

/// Chooses the units of columns and rows. Columns whose value comes from outside keep theirs, and
/// with them all others do.
pub(super) fn apply(work: &mut WorkingProgram) {
    if work.given.iter().any(|&given| given) {
        return;
    }
    for column in 0..work.uses.len() {
        let (lower, upper) = (work.lower[column], work.upper[column]);
        let is_free = !work.integral[column] && !work.is_held(column) && lower < upper;
        if let Some(factor) = factor_of(lower.abs().max(upper.abs())).filter(|_| is_free) {
            scale_column(work, column, factor);
        }
    }
    for row in 0..work.rows.len() {
        let reach = |&(j, a): &(usize, f64)| a.abs() * work.lower[j].abs().max(work.upper[j].abs());
        let terms: f64 = work.rows[row].iter().map(reach).sum();
        let limit = work.limit_size(row);
        if let Some(factor) = factor_of(terms + limit) {
            scale_row(work, row, factor);
        }
    }
}

/// Multiplies a row.
pub(super) fn scale_row(work: &mut WorkingProgram, row: usize, factor: f64) {
    work.rows[row].iter_mut().for_each(|(_, a)| *a *= factor);
    work.row_lower[row] *= factor;
    work.row_upper[row] *= factor;
    work.row_noise[row] *= factor;
    work.push(RowUnit { row, factor });
}

fn scale_column(work: &mut WorkingProgram, column: usize, factor: f64) {
    for k in 0..work.uses[column].len() {
        let row = work.uses[column][k];
        if let Ok(at) = work.rows[row].binary_search_by_key(&column, |&(j, _)| j) {
            work.rows[row][at].1 /= factor;
        }
    }
    work.lower[column] *= factor;
    work.upper[column] *= factor;
    work.linear[column] /= factor;
    let mut products = std::mem::take(&mut work.quadratic[column]);
    for (&other, product) in &mut products {
        *product /= if other == column { factor * factor } else { factor };
        if other != column
            && let Some(mirrored) = work.quadratic[other].get_mut(&column)
        {
            *mirrored = *product;
        }
    }
    work.quadratic[column] = products;
    work.push(ColumnUnit { column, factor });
}

impl Undo for ColumnUnit {
    fn primal(&self, x: &mut [f64]) {
        x[self.column] /= self.factor;
    }

    fn carry(&self, known: &mut BTreeMap<usize, f64>) {
        known.entry(self.column).and_modify(|value| *value *= self.factor);
    }

    fn dual(&self, all: &mut Restored) {
        all.d[self.column] *= self.factor;
    }
}

impl Undo for RowUnit {
    fn dual(&self, all: &mut Restored) {
        all.y[self.row] *= self.factor;
    }
}
