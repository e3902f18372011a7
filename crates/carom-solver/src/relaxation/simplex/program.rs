//! A linear program in scaled units, its rows as columns of their own.

use crate::presolve::{Compressed, Reduced};
use crate::relaxation::scaling::factors;
use crate::tolerance::largest_magnitude;

/// Bounds of this magnitude count as missing: a column at such a bound would drown the others in
/// its rounding. If the optimum is there, no claim holds, and other methods follow.
const NO_BOUND: f64 = 1e20;

/// `min c'x` over `A x - s = 0` and bounds of the columns `x` and of the rows' activities `s`,
/// which follow them.
#[derive(Debug)]
pub(super) struct LinearProgram {
    pub(super) columns: Compressed,
    pub(super) rows: Compressed,
    pub(super) cost: Vec<f64>,
    pub(super) lower: Vec<f64>,
    pub(super) upper: Vec<f64>,
    /// Units of the columns, inverse units of the rows, inverse unit of the objective.
    column_unit: Vec<f64>,
    row_unit: Vec<f64>,
    pub(super) objective_unit: f64,
    row_number: Vec<usize>,
}

impl LinearProgram {
    pub(super) fn of(program: &Reduced) -> Self {
        let (mut column_unit, mut row_unit) = factors(program);
        // Powers of two change no digit.
        let round = |unit: &mut f64| *unit = unit.log2().round().exp2();
        column_unit.iter_mut().chain(&mut row_unit).for_each(round);
        let (n, m) = (column_unit.len(), row_unit.len());
        let mut rows = Compressed::with_capacity(0, 0);
        for (i, unit) in row_unit.iter().enumerate() {
            let (index, value) = program.rows.vector(i);
            rows.push(index.iter().zip(value).map(|(&j, a)| (j, a * unit * column_unit[j])));
        }
        let mut cost: Vec<f64> =
            program.linear.iter().zip(&column_unit).map(|(q, unit)| q * unit).collect();
        let largest = largest_magnitude(&cost);
        let objective_unit = if largest > 0.0 { (-largest.log2().ceil()).exp2() } else { 1.0 };
        cost.iter_mut().for_each(|q| *q *= objective_unit);
        cost.resize(n + m, 0.0);
        let join = |of_columns: &[f64], of_rows: &[f64]| -> Vec<f64> {
            let columns = of_columns.iter().zip(&column_unit).map(|(v, unit)| v / unit);
            columns.chain(of_rows.iter().zip(&row_unit).map(|(v, unit)| v * unit)).collect()
        };
        let mut lower = join(&program.lower, &program.row_lower);
        let mut upper = join(&program.upper, &program.row_upper);
        lower.iter_mut().filter(|v| **v <= -NO_BOUND).for_each(|v| *v = f64::NEG_INFINITY);
        upper.iter_mut().filter(|v| **v >= NO_BOUND).for_each(|v| *v = f64::INFINITY);
        let columns = rows.transposed(n);
        LinearProgram {
            columns,
            rows,
            cost,
            lower,
            upper,
            column_unit,
            row_unit,
            objective_unit,
            row_number: (0..m).collect(),
        }
    }

    /// The number of columns proper, and that of rows.
    pub(super) fn size(&self) -> (usize, usize) {
        (self.column_unit.len(), self.row_unit.len())
    }

    /// The unit of a column proper.
    pub(super) fn column_unit(&self, j: usize) -> f64 {
        self.column_unit[j]
    }

    /// The inverse unit of a row.
    pub(super) fn row_unit(&self, i: usize) -> f64 {
        self.row_unit[i]
    }

    /// The rows and the entries of a column or of a row's activity.
    pub(super) fn column(&self, k: usize) -> (&[usize], &[f64]) {
        match k.checked_sub(self.column_unit.len()) {
            None => self.columns.vector(k),
            Some(i) => (&self.row_number[i..=i], &[-1.0]),
        }
    }

    /// Calls `f` with the entries of a column or of a row's activity.
    pub(super) fn each(&self, k: usize, mut f: impl FnMut(usize, f64)) {
        match k.checked_sub(self.column_unit.len()) {
            None => self.columns.entries(k).for_each(|(i, a)| f(i, a)),
            Some(i) => f(i, -1.0),
        }
    }

    /// The product of a column with a vector over the rows.
    pub(super) fn product(&self, k: usize, y: &[f64]) -> f64 {
        match k.checked_sub(self.column_unit.len()) {
            None => self.columns.entries(k).map(|(i, a)| a * y[i]).sum(),
            Some(i) => -y[i],
        }
    }

    /// A point in the units of the program.
    pub(super) fn point(&self, x: &[f64]) -> Vec<f64> {
        x.iter().zip(&self.column_unit).map(|(x, unit)| x * unit).collect()
    }

    /// The multipliers that [`multipliers`](Self::multipliers) gives as `y`.
    pub(super) fn scaled_multipliers(&self, y: &[f64]) -> Vec<f64> {
        y.iter().zip(&self.row_unit).map(|(y, unit)| -y * self.objective_unit / unit).collect()
    }

    /// Multipliers in the units of the program, of the sign that the proofs expect; `value` is the
    /// unit of the objective, 1 for certificates.
    pub(super) fn multipliers(&self, y: &[f64], value: f64) -> Vec<f64> {
        y.iter().zip(&self.row_unit).map(|(y, unit)| -y * unit / value).collect()
    }
}
