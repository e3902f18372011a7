//! Units of columns and rows.
//!
//! Takes the program as it was stated; leaves continuous columns in units in which their largest
//! value is between 1 and 2, and rows times factors that bring their largest coefficient there.
//! Rules, cuts and methods compare numbers with each other and with absolute tolerances, and
//! recognise structure by equal coefficients: in units of its own, a program would lose both.
//!
//! The factors are powers of two, so that nothing is rounded, and a program in other units by
//! powers of two becomes the same program. The largest value of a column without bounds is that
//! which its rows leave it beside other columns (see [`sizes`]). Rows over integers alone get the
//! smallest whole coefficients, if there are any.
//!
//! A program whose coefficients become hardly more alike keeps its units, which mean something to
//! the user. Alike are coefficients whose logarithms are (Curtis and Reid, On the automatic scaling
//! of matrices for Gaussian elimination, IMA Journal of Applied Mathematics 10, 1972). In such a
//! program, only columns and rows of tiny numbers get other units: `x <= 1e-8` lies below
//! tolerances.

use super::postsolve::{ColumnMeaning, Restored, Undo};
use super::working_program::WorkingProgram;
use crate::tolerance::SMALL_UNIT;
use sizes::sizes;
use std::collections::BTreeMap;

mod sizes;

/// The least difference that other units make to the variance of the coefficients' binary
/// logarithms (no unit): big-Ms of 1000 beside ones are usual.
const LEAST_VARIANCE_GAIN: f64 = 9.0;

/// The largest factor, as a power of two: larger ones might leave the range of floats.
const MOST_POWER: i32 = 300;

/// The most binary digits of coefficients that are made whole.
const MOST_WHOLE_DIGITS: i32 = 40;

/// Columns and rows in other units.
#[derive(Debug)]
struct UnitFactors {
    /// Columns and what their values were multiplied by.
    columns: Vec<(usize, f64)>,
    /// Rows and what they were multiplied by.
    rows: Vec<(usize, f64)>,
}

/// Chooses the units of columns and rows. Columns whose value comes from outside keep theirs, and
/// with them all others do.
pub(super) fn apply(work: &mut WorkingProgram) {
    if work.given.iter().any(|&given| given) {
        return;
    }
    let (columns, rows) = match alike_factors(work) {
        Some([columns, rows]) => (scale_columns(work, columns), scale_rows(work, rows)),
        None => {
            let columns = (0..work.uses.len()).map(|j| tiny_column_factor(work, j)).collect();
            let columns = scale_columns(work, columns);
            let rows = (0..work.rows.len()).map(|row| tiny_row_factor(work, row)).collect();
            (columns, scale_rows(work, rows))
        }
    };
    push(work, columns, rows);
}

/// Multiplies one row, and notes that.
pub(super) fn scale_row(work: &mut WorkingProgram, row: usize, factor: f64) {
    multiply_row(work, row, factor);
    push(work, Vec::new(), vec![(row, factor)]);
}

/// Multiplies the values of one column, and notes that.
pub(super) fn scale_column(work: &mut WorkingProgram, column: usize, factor: f64) {
    multiply_column(work, column, factor);
    push(work, vec![(column, factor)], Vec::new());
}

/// Whether a number is a power of two, by which nothing is rounded.
pub(super) fn is_power(number: f64) -> bool {
    number > 0.0 && number.is_normal() && number.to_bits() & ((1 << 52) - 1) == 0
}

fn push(work: &mut WorkingProgram, columns: Vec<(usize, f64)>, rows: Vec<(usize, f64)>) {
    if !columns.is_empty() || !rows.is_empty() {
        work.push(UnitFactors { columns, rows });
    }
}

/// The factors of columns and of rows that make coefficients alike; `None` if these become hardly
/// more alike.
fn alike_factors(work: &WorkingProgram) -> Option<[Vec<f64>; 2]> {
    let before = variance(work, |_, _| 1.0);
    if before < LEAST_VARIANCE_GAIN || !work.cones.is_empty() {
        return None;
    }
    let sizes = sizes(work);
    let column = |(j, size): (usize, &Option<f64>)| match size {
        Some(size) if may_move(work, j) => factor_of(*size),
        _ => 1.0,
    };
    let columns: Vec<f64> = sizes.iter().enumerate().map(column).collect();
    let rows: Vec<f64> = (0..work.rows.len()).map(|row| row_factor(work, row, &columns)).collect();
    let after = variance(work, |row, j| rows[row] / columns[j]);
    (before - after >= LEAST_VARIANCE_GAIN).then_some([columns, rows])
}

/// The variance of the binary logarithms of coefficients times factors.
fn variance(work: &WorkingProgram, factor: impl Fn(usize, usize) -> f64) -> f64 {
    let (mut count, mut sum, mut squares) = (0.0, 0.0, 0.0);
    for (row, entries) in work.rows.iter().enumerate() {
        for &(j, a) in entries {
            let size = (a.abs() * factor(row, j)).log2();
            (count, sum, squares) = (count + 1.0, sum + size, squares + size * size);
        }
    }
    if count == 0.0 { 0.0 } else { squares / count - (sum / count).powi(2) }
}

/// Whether a column may get another unit.
fn may_move(work: &WorkingProgram, j: usize) -> bool {
    !work.integral[j] && !work.is_held(j)
}

/// The power of two that brings a magnitude between 1 and 2.
fn factor_of(size: f64) -> f64 {
    match size > 0.0 && size.is_finite() {
        true => power(-exponent(size)),
        false => 1.0,
    }
}

fn power(exponent: i32) -> f64 {
    f64::from(exponent.clamp(-MOST_POWER, MOST_POWER)).exp2()
}

/// The exponent of the largest power of two that a magnitude reaches.
fn exponent(size: f64) -> i32 {
    size.log2().floor() as i32
}

/// The factor of a row whose columns have these factors.
fn row_factor(work: &WorkingProgram, row: usize, columns: &[f64]) -> f64 {
    let entries = &work.rows[row];
    let largest = entries.iter().map(|&(j, a)| a.abs() / columns[j]).fold(0.0, f64::max);
    if largest == 0.0 {
        return 1.0;
    }
    if entries.iter().all(|&(j, _)| work.integral[j]) {
        let limits = [work.row_lower[row], work.row_upper[row]];
        let finite = limits.into_iter().filter(|limit| limit.is_finite());
        let numbers = entries.iter().map(|e| e.1).chain(finite);
        let last = numbers.filter(|a| *a != 0.0).map(last_place).min().unwrap_or(0);
        if exponent(largest) - last < MOST_WHOLE_DIGITS {
            return power(-last);
        }
    }
    factor_of(largest)
}

/// The exponent of the last binary digit of a number other than 0 that is not 0.
fn last_place(a: f64) -> i32 {
    let digits = (a.to_bits() & ((1 << 52) - 1)) | (1 << 52);
    exponent(a.abs()) - 52 + digits.trailing_zeros() as i32
}

/// The factor of a column with tiny bounds; 1 for others.
fn tiny_column_factor(work: &WorkingProgram, j: usize) -> f64 {
    let (lower, upper) = (work.lower[j], work.upper[j]);
    let size = lower.abs().max(upper.abs());
    if may_move(work, j) && lower < upper && size < SMALL_UNIT { factor_of(size) } else { 1.0 }
}

/// The factor of a row whose terms are tiny within the bounds; 1 for others.
fn tiny_row_factor(work: &WorkingProgram, row: usize) -> f64 {
    let reach = |&(j, a): &(usize, f64)| a.abs() * work.lower[j].abs().max(work.upper[j].abs());
    let terms: f64 = work.rows[row].iter().map(reach).sum();
    let size = terms + work.limit_size(row);
    if size < SMALL_UNIT { factor_of(size) } else { 1.0 }
}

/// Multiplies rows. Returns those that change, with their factors.
fn scale_rows(work: &mut WorkingProgram, factors: Vec<f64>) -> Vec<(usize, f64)> {
    let changed = changes(factors);
    changed.iter().for_each(|&(row, factor)| multiply_row(work, row, factor));
    changed
}

fn changes(factors: Vec<f64>) -> Vec<(usize, f64)> {
    factors.into_iter().enumerate().filter(|(_, factor)| *factor != 1.0).collect()
}

fn multiply_row(work: &mut WorkingProgram, row: usize, factor: f64) {
    work.rows[row].iter_mut().for_each(|(_, a)| *a *= factor);
    work.row_lower[row] *= factor;
    work.row_upper[row] *= factor;
    work.row_noise[row] *= factor;
}

/// Multiplies the values of columns. Returns those that change, with their factors.
fn scale_columns(work: &mut WorkingProgram, factors: Vec<f64>) -> Vec<(usize, f64)> {
    let changed = changes(factors);
    changed.iter().for_each(|&(column, factor)| multiply_column(work, column, factor));
    changed
}

fn multiply_column(work: &mut WorkingProgram, column: usize, factor: f64) {
    for k in 0..work.uses[column].len() {
        let row = work.uses[column][k];
        if let Ok(at) = work.rows[row].binary_search_by_key(&column, |&(j, _)| j) {
            work.rows[row][at].1 /= factor;
        }
    }
    work.lower[column] *= factor;
    work.upper[column] *= factor;
    work.column_noise[column] *= factor;
    work.linear[column] /= factor;
    work.spread[column] *= factor.max(1.0);
    let mut products = std::mem::take(&mut work.quadratic[column]);
    for (&other, product) in &mut products {
        *product /= if other == column { factor * factor } else { factor };
        if other != column {
            work.quadratic[other].insert(column, *product);
        }
    }
    work.quadratic[column] = products;
}

impl Undo for UnitFactors {
    fn primal(&self, x: &mut [f64]) {
        self.columns.iter().for_each(|&(j, factor)| x[j] /= factor);
    }

    fn restate(&self, meanings: &mut [ColumnMeaning]) {
        self.columns.iter().for_each(|&(j, factor)| meanings[j].put(1.0 / factor, 0.0));
    }

    fn carry(&self, known: &mut BTreeMap<usize, f64>) {
        for &(j, factor) in &self.columns {
            known.entry(j).and_modify(|value| *value *= factor);
        }
    }

    fn dual(&self, all: &mut Restored) {
        self.columns.iter().for_each(|&(j, factor)| all.d[j] *= factor);
        self.rows.iter().for_each(|&(row, factor)| all.y[row] *= factor);
    }
}
