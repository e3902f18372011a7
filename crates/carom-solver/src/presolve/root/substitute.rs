//! Substitution of a column by an equality.
//!
//! Takes a column and an equality; leaves the program without the column, and with a row for its
//! bounds in the place of the equality if the caller asks for one.
//!
//! From `a_j x_j + rest = b` follows `x_j = b / a_j - rest / a_j`, which is substituted in every
//! other row and the objective. The row for the bounds of the column is
//! `b / a_j - upper <= rest / a_j <= b / a_j - lower`, in the unit of the column, so that its
//! tolerance is that of the bounds.

use std::collections::BTreeMap;

use super::postsolve::{Restored, Undo};
use super::working_program::{OldColumn, Sparse, WorkingProgram};
use crate::presolve::parameters::LARGEST_WHOLE;
use crate::sum::{Sum, exact_product};
use crate::tolerance;

/// A difference of entries below this, relative to them, is 0.
const CANCELLATION: f64 = 1e-13;

/// A difference of entries below this, relative to them, is mostly rounding: that of `8192 x` and
/// `8192.0002 x`, for example. A substitution that leaves one, other than 0, is refused.
const MIN_DIFFERENCE: f64 = 1e-6;

/// The largest quotient of a coefficient and the pivot: entries of other rows must not grow.
const MAX_PIVOT_RATIO: f64 = 1e3;

#[derive(Debug)]
struct Substituted {
    old: OldColumn,
    integral: bool,
    row: usize,
    coefficient: f64,
    constant: f64,
    /// `x_j = constant - terms`.
    terms: Sparse,
    /// Whether the row was kept for the bounds.
    kept: bool,
    bounds: [f64; 2],
}

/// The largest rounding of a constant that replaces part of a column, in the column's unit: more
/// would show in the objective.
const MAX_CONSTANT_ROUNDING: f64 = 1e-9;

/// Whether a column can be expressed by a row without numbers growing or losing their digits.
pub(super) fn is_stable(work: &WorkingProgram, column: usize, row: usize) -> bool {
    let pivot = work.coefficient(row, column).abs();
    let in_row = work.rows[row].iter().all(|(_, a)| a.abs() <= MAX_PIVOT_RATIO * pivot);
    let constant = work.row_lower[row] / pivot;
    !work.is_held(column)
        && in_row
        && f64::EPSILON * constant.abs() <= MAX_CONSTANT_ROUNDING
        && work.column(column).all(|(_, a)| a.abs() <= MAX_PIVOT_RATIO * pivot)
        && work.uses[column].iter().all(|&i| i == row || is_sharp(work, column, row, i))
}

/// Whether the entries of another row keep their digits when a row replaces a column there.
fn is_sharp(work: &WorkingProgram, column: usize, row: usize, other: usize) -> bool {
    let factor = work.coefficient(other, column) / work.coefficient(row, column);
    let entries = work.rows[row].iter().filter(|(j, _)| *j != column);
    entries.into_iter().all(|&(j, a)| {
        let (own, new) = (work.coefficient(other, j), factor * a);
        let (left, size) = ((own - new).abs(), own.abs().max(new.abs()));
        left <= CANCELLATION * size || left >= MIN_DIFFERENCE * size
    })
}

/// Substitutes a column by an equality; `keep` leaves a row for its bounds.
pub(super) fn substitute(work: &mut WorkingProgram, column: usize, row: usize, keep: bool) {
    let old = work.remember(column);
    let coefficient = work.coefficient(row, column);
    let constant = work.row_lower[row] / coefficient;
    let mut terms = work.rows[row].clone();
    terms.retain(|&(j, _)| j != column);
    terms.iter_mut().for_each(|(_, a)| *a /= coefficient);

    // The rounding of the constant, and that of the quotients times the values of their columns.
    // Values of continuous columns are rounded themselves.
    let is_exact = |quotient: f64, of: f64| exact_product(quotient, coefficient) == (of, 0.0);
    let mut rounded = terms.clone();
    rounded.retain(|&(j, a)| !(work.integral[j] && is_exact(a, work.coefficient(row, j))));
    let mut size = if rounded.is_empty() { 0.0 } else { work.range(rounded.iter()).scale };
    if !is_exact(constant, work.row_lower[row]) {
        size += constant.abs();
    }
    let noise = work.row_noise[row] / coefficient.abs() + f64::EPSILON * size;
    // Arithmetic on whole numbers is exact.
    let is_whole = |value: f64| value == value.round() && value.abs() <= LARGEST_WHOLE;
    let whole = work.integral[column]
        && is_whole(constant)
        && terms.iter().all(|&(j, a)| work.integral[j] && is_whole(a));
    let noise = if whole { 0.0 } else { noise };
    for &(other, factor) in old.entries.iter().filter(|(other, _)| *other != row) {
        work.row_noise[other] += factor.abs() * noise;
        let mut rest = work.rows[other].clone();
        rest.retain(|&(j, _)| j != column);
        let entries = minus(&rest, factor, &terms);
        work.set_row(other, entries);
        work.shift_row(other, factor * constant);
    }
    work.blur_objective(column, constant, noise);
    substitute_objective(work, column, constant, &terms);

    let (lower, upper) = (work.lower[column], work.upper[column]);
    let kept = keep && (lower.is_finite() || upper.is_finite());
    if kept {
        work.set_row(row, terms.clone());
        (work.row_lower[row], work.row_upper[row]) = (constant - upper, constant - lower);
        work.row_noise[row] = noise + work.column_noise[column];
        work.add_rounding(row, 0.0);
    } else {
        work.drop_row(row);
    }
    work.drop_column(column);
    let integral = work.integral[column];
    let bounds = [lower, upper];
    work.push(Substituted { old, integral, row, coefficient, constant, terms, kept, bounds });
}

/// `row - factor * terms`.
fn minus(row: &Sparse, factor: f64, terms: &Sparse) -> Sparse {
    let mut sum = Vec::with_capacity(row.len() + terms.len());
    let (mut p, mut q) = (0, 0);
    while p < row.len() || q < terms.len() {
        let first = row.get(p).map_or(usize::MAX, |e| e.0);
        let second = terms.get(q).map_or(usize::MAX, |e| e.0);
        let own = if first <= second { row[p].1 } else { 0.0 };
        let new = if second <= first { -factor * terms[q].1 } else { 0.0 };
        p += usize::from(first <= second);
        q += usize::from(second <= first);
        let value = own + new;
        if value.abs() > CANCELLATION * own.abs().max(new.abs()) {
            sum.push((first.min(second), value));
        }
    }
    sum
}

fn substitute_objective(work: &mut WorkingProgram, column: usize, constant: f64, terms: &Sparse) {
    let linear = work.linear[column];
    work.add_to_objective(linear, constant);
    for &(k, a) in terms {
        work.linear[k] -= linear * a;
    }
    let curvature: Vec<(usize, f64)> =
        work.quadratic[column].iter().map(|(&k, &p)| (k, p)).collect();
    let mut add = |i: usize, k: usize, p: f64| {
        let entry = work.quadratic[i].entry(k).or_insert(0.0);
        let size = entry.abs().max(p.abs());
        *entry += p;
        if entry.abs() <= CANCELLATION * size {
            work.quadratic[i].remove(&k);
        }
    };
    for &(m, p) in &curvature {
        if m == column {
            for &(k, a) in terms {
                for &(l, b) in terms {
                    add(k, l, p * a * b);
                }
            }
        } else {
            for &(k, a) in terms {
                add(k, m, -a * p);
                add(m, k, -a * p);
            }
        }
    }
    for (m, p) in curvature {
        if m == column {
            work.shift_objective(0.5 * p * constant * constant);
            for &(k, a) in terms {
                work.linear[k] -= p * constant * a;
            }
        } else {
            work.linear[m] += constant * p;
        }
    }
}

impl Undo for Substituted {
    fn primal(&self, x: &mut [f64]) {
        let (mut sum, mut size) = (Sum::new(self.constant), self.constant.abs());
        for &(k, a) in &self.terms {
            sum.add_product(-a, x[k]);
            size += (a * x[k]).abs();
        }
        let value = sum.value();
        // Rounding of large terms belongs to the row, which allows for it, and not to the bound.
        let inside = value.max(self.bounds[0]).min(self.bounds[1]);
        let rounded = (value - inside).abs() <= tolerance::ROUNDING * size;
        let value = if rounded { inside } else { value };
        x[self.old.column] = if self.integral { value.round() } else { value };
    }

    fn carry(&self, known: &mut BTreeMap<usize, f64>) {
        if let ([(other, a)], Some(&value)) = (&self.terms[..], known.get(&self.old.column)) {
            known.entry(*other).or_insert((self.constant - value) / a);
        }
    }

    fn replaced(&self) -> Option<(usize, usize)> {
        Some((self.old.column, self.row))
    }

    /// The multiplier of the equality makes the reduced cost of its column what the kept row says,
    /// or 0. An equality over integral columns needs none, because their reduced costs may have any
    /// sign.
    fn dual(&self, all: &mut Restored) {
        let pressed = if self.kept { all.y[self.row] } else { 0.0 };
        let gradient = self.old.gradient(&all.x, &all.y, Some(self.row));
        if self.integral {
            all.y[self.row] = 0.0;
            all.d[self.old.column] = gradient;
            self.terms.iter().for_each(|&(k, a)| all.d[k] += a * (gradient - pressed));
        } else {
            all.y[self.row] = (pressed - gradient) / self.coefficient;
            all.d[self.old.column] = pressed;
        }
    }
}
