//! Fixed columns.
//!
//! Takes columns with one value left; leaves the value in their place in rows and objective.
//! Columns of cones stay, but in no row and not in the objective.

use super::postsolve::{Restored, Undo};
use super::working_program::{OldColumn, WorkingProgram};

#[derive(Debug)]
struct FixedColumn {
    old: OldColumn,
    value: f64,
}

pub(super) fn apply(work: &mut WorkingProgram) -> usize {
    let fixed: Vec<usize> = work
        .live_columns()
        .into_iter()
        .filter(|&j| work.lower[j] == work.upper[j] && !work.given[j])
        .filter(|&j| !work.conic[j] || has_entries(work, j))
        .collect();
    work.each_column(fixed, |work, column| {
        fix(work, column, work.lower[column]);
        1
    })
}

/// Whether a column is in a row or in the objective.
fn has_entries(work: &WorkingProgram, column: usize) -> bool {
    let in_rows = !work.uses[column].is_empty();
    in_rows || work.linear[column] != 0.0 || !work.is_straight(column)
}

pub(super) fn fix(work: &mut WorkingProgram, column: usize, value: f64) {
    let old = work.remember(column);
    for &(row, a) in &old.entries {
        work.row_noise[row] += a.abs() * work.column_noise[column];
        work.shift_row(row, a * value);
    }
    work.blur_objective(column, value, work.column_noise[column]);
    work.add_to_objective(work.linear[column], value);
    for (k, p) in work.quadratic[column].clone() {
        if k == column {
            work.shift_objective(0.5 * p * value * value);
        } else {
            work.linear[k] += p * value;
        }
    }
    work.drop_column(column);
    work.column_alive[column] = work.conic[column];
    work.push(FixedColumn { old, value });
}

impl Undo for FixedColumn {
    fn primal(&self, x: &mut [f64]) {
        x[self.old.column] = self.value;
    }

    fn dual(&self, all: &mut Restored) {
        all.d[self.old.column] = self.old.gradient(&all.x, &all.y, None);
    }
}
