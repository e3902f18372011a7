//! Columns that equations determine one after the other.
//!
//! Takes equalities; leaves the continuous columns that they determine at their values, or within
//! the error of the values where this is larger than the rounding of a float. A matching of
//! equalities and columns tells which columns these are (Dulmage and Mendelsohn, Coverings of
//! bipartite graphs, Canadian Journal of Mathematics 10, 1958).
//!
//! The columns are computed before any rule looks at them, with more digits than a float has: rules
//! would leave each equation its rounding, which the next ones multiply.

use super::fixed_columns;
use super::postsolve::{Restored, Undo};
use super::working_program::{Infeasible, WorkingProgram};
use crate::presolve::determined::{ColumnKind, DeterminedColumns};

/// Rows that have determined columns.
#[derive(Debug)]
struct DeterminedRows {
    rows: Vec<usize>,
    columns: Vec<usize>,
    /// By row, the coefficients of the columns.
    coefficients: Vec<Vec<f64>>,
}

/// Fixes determined columns at their values, and refutes values that contradict bounds.
///
/// # Arguments
///
/// * `keeps_all`: whether rows and columns stay.
pub(super) fn apply(work: &mut WorkingProgram, keeps_all: bool) -> Result<(), Infeasible> {
    let kind = |j: usize| match work.lower[j] == work.upper[j] {
        _ if work.given[j] => ColumnKind::Other,
        true => ColumnKind::Known,
        false if work.integral[j] => ColumnKind::Other,
        false => ColumnKind::Unknown,
    };
    let equalities = (0..work.rows.len())
        .filter(|&row| work.is_equality(row))
        .map(|row| (row, work.rows[row].iter().copied(), work.row_lower[row]));
    let Some(determined) = DeterminedColumns::new(work.uses.len(), equalities, kind) else {
        return Ok(());
    };
    let values = determined.values(|j| work.lower[j]);
    if !keeps_all {
        fixed_columns::apply(work);
    }
    for block in determined.blocks() {
        let mut is_sharp = true;
        for &column in &block.columns {
            let ball = determined.value_of(&values, column);
            let (value, error) = (ball.value(), ball.error());
            work.intersect(column, [value - error, value + error], error)?;
            is_sharp &= ball.is_sharp();
        }
        if !is_sharp {
            continue;
        }
        let others = |row: &usize| work.rows[*row].iter().all(|(j, _)| block.columns.contains(j));
        let is_alone = block.rows.iter().all(others);
        if !keeps_all && is_alone {
            let of_row = |&row: &usize| {
                block.columns.iter().map(|&j| work.coefficient(row, j)).collect::<Vec<f64>>()
            };
            let coefficients = block.rows.iter().map(of_row).collect();
            let (rows, columns) = (block.rows.clone(), block.columns.clone());
            rows.iter().for_each(|&row| work.drop_row(row));
            work.push(DeterminedRows { rows, columns, coefficients });
        }
        for &column in &block.columns {
            let ball = determined.value_of(&values, column);
            (work.lower[column], work.upper[column]) = (ball.value(), ball.value());
            if !keeps_all && is_alone {
                work.column_noise[column] = ball.error();
                fixed_columns::fix(work, column, ball.value());
            }
        }
    }
    Ok(())
}

impl Undo for DeterminedRows {
    /// The columns were fixed by the rows, so the multipliers of the rows make their reduced costs
    /// 0.
    fn dual(&self, all: &mut Restored) {
        let mut matrix = self.coefficients.clone();
        let mut order: Vec<usize> = (0..self.rows.len()).collect();
        // `A'y = -d` by elimination: the columns of the matrix are its equations.
        let mut right: Vec<f64> = self.columns.iter().map(|&j| -all.d[j]).collect();
        for k in 0..order.len() {
            let size = |row: &usize| matrix[*row][k].abs();
            let best =
                (k..order.len()).max_by(|&a, &b| size(&order[a]).total_cmp(&size(&order[b])));
            order.swap(k, best.unwrap_or(k));
            let pivot = order[k];
            for column in k + 1..self.columns.len() {
                let factor = matrix[pivot][column] / matrix[pivot][k];
                for row in &mut matrix {
                    row[column] -= factor * row[k];
                }
                right[column] -= factor * right[k];
            }
        }
        for k in (0..order.len()).rev() {
            let later = order[k + 1..].iter().map(|&row| matrix[row][k] * all.y[self.rows[row]]);
            let sum: f64 = later.sum();
            all.y[self.rows[order[k]]] = (right[k] - sum) / matrix[order[k]][k];
        }
        self.columns.iter().for_each(|&j| all.d[j] = 0.0);
    }
}
