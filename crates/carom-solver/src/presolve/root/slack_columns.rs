//! Slack columns.
//!
//! Takes a continuous column in a single row; leaves the row with other limits, without the column
//! (Andersen and Andersen, Presolving in linear programming, Mathematical Programming 71, 1995).
//!
//! In an equality they are substituted, including their cost. Without a cost they widen the limits
//! of any row. With a cost and no other restriction, they make a limit of their row active, so that
//! the row becomes an equality.

use super::postsolve::{Restored, Undo};
use super::substitute::{is_stable, substitute};
use super::working_program::WorkingProgram;
use crate::activity::{implied_ends, term_ends};
use crate::tolerance::finite_size;

/// A column without a cost that widened a row.
#[derive(Debug)]
struct RowSlack {
    column: usize,
    row: usize,
    coefficient: f64,
    bounds: [f64; 2],
    limits: [f64; 2],
    rest: Vec<(usize, f64)>,
}

pub(super) fn apply(work: &mut WorkingProgram, column: usize) -> usize {
    let [row] = work.uses[column][..] else { return 0 };
    if work.is_held(column)
        || work.integral[column]
        || !work.is_straight(column)
        || work.rows[row].len() < 2
    {
        return 0;
    }
    if work.linear[column] != 0.0 && !work.is_equality(row) {
        bind(work, column, row);
    }
    if work.is_equality(row) {
        if is_stable(work, column, row) {
            substitute(work, column, row, true);
            return 1;
        }
    } else if work.linear[column] == 0.0 {
        widen(work, column, row);
        return 1;
    }
    0
}

/// Makes a row an equality if a column's cost moves the column up to a limit of the row, and no
/// bound stops it before.
fn bind(work: &mut WorkingProgram, column: usize, row: usize) {
    let (a, cost) = (work.coefficient(row, column), work.linear[column]);
    let bound = if cost > 0.0 { work.lower[column] } else { work.upper[column] };
    // Falling along `-cost`, the activity moves by `-cost * a`.
    let limit = if cost * a > 0.0 { work.row_lower[row] } else { work.row_upper[row] };
    if bound.is_infinite() && limit.is_finite() {
        (work.row_lower[row], work.row_upper[row]) = (limit, limit);
    }
}

fn widen(work: &mut WorkingProgram, column: usize, row: usize) {
    let coefficient = work.coefficient(row, column);
    let bounds = [work.lower[column], work.upper[column]];
    let limits = [work.row_lower[row], work.row_upper[row]];
    let [least, most] = term_ends(coefficient, bounds);
    work.row_lower[row] -= most;
    work.row_upper[row] -= least;
    work.row_noise[row] += coefficient.abs() * work.column_noise[column];
    work.add_rounding(row, finite_size(least).max(finite_size(most)));
    work.drop_column(column);
    let rest = work.rows[row].clone();
    work.push(RowSlack { column, row, coefficient, bounds, limits, rest });
}

impl Undo for RowSlack {
    /// The value nearest to 0 with which the row and the bounds hold.
    fn primal(&self, x: &mut [f64]) {
        let rest: f64 = self.rest.iter().map(|&(k, a)| a * x[k]).sum();
        let limits = self.limits.map(|limit| limit - rest);
        let [least, most] = implied_ends(self.coefficient, limits);
        let value = 0.0_f64.max(least).min(most);
        x[self.column] = value.max(self.bounds[0]).min(self.bounds[1]);
    }

    fn dual(&self, all: &mut Restored) {
        all.d[self.column] = self.coefficient * all.y[self.row];
    }
}
