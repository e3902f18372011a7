//! Units of columns and rows in which the entries of a program are near 1.

use crate::presolve::{Reduced, refill};

/// The number of rounds. Each divides every row and column by the root of its largest entry.
const SCALING_ROUNDS: usize = 3;

/// The largest factor by which a column, a row or the objective is scaled.
pub(super) const MAX_SCALE: f64 = 1e6;

/// Factors of columns and rows that bring the largest entry of each near 1.
pub(super) fn factors(program: &Reduced) -> (Vec<f64>, Vec<f64>) {
    let (mut column, mut row) = (Vec::new(), Vec::new());
    write_factors(program, &mut column, &mut row, &mut Vec::new());
    (column, row)
}

/// As [`factors`], in the memory of given vectors; `room` is work space.
pub(super) fn write_factors(
    program: &Reduced,
    column: &mut Vec<f64>,
    row: &mut Vec<f64>,
    room: &mut Vec<f64>,
) {
    let (n, m) = (program.columns.len(), program.rows.len());
    refill(column, n, 1.0);
    refill(row, m, 1.0);
    for _ in 0..SCALING_ROUNDS {
        refill(room, n + m, 0.0);
        let (of_column, of_row) = room.split_at_mut(n);
        for i in 0..m {
            let (index, value) = program.rows.vector(i);
            for (&j, a) in index.iter().zip(value) {
                let size = (a * row[i] * column[j]).abs();
                of_row[i] = of_row[i].max(size);
                of_column[j] = of_column[j].max(size);
            }
        }
        let adjust = |factor: &mut f64, largest: f64| {
            if largest > 0.0 {
                *factor = (*factor / largest.sqrt()).clamp(1.0 / MAX_SCALE, MAX_SCALE);
            }
        };
        column.iter_mut().zip(&*of_column).for_each(|(f, l)| adjust(f, *l));
        row.iter_mut().zip(&*of_row).for_each(|(f, l)| adjust(f, *l));
    }
}
