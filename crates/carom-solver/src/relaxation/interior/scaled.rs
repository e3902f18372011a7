//! The program in even units: rows, columns and objective scaled, bounds and row limits as sides.

use super::scaled_cones::ScaledCones;
use crate::presolve::{Compressed, Reduced};
use crate::relaxation::conic_form::ConeRows;
use crate::relaxation::scaling::{MAX_SCALE, write_factors};

/// One finite limit of a column or of an inequality row: `sign * (value - limit) >= 0`.
#[derive(Debug, Clone, Copy)]
pub(super) struct OneSidedLimit {
    /// The column or the row.
    pub(super) of: usize,
    /// 1 for a lower limit, -1 for an upper one.
    pub(super) sign: f64,
    pub(super) limit: f64,
}

/// `min 1/2 x'Px + q'x` over rows and sides, with `x` in units of `column`, rows in units of `1 /
/// row`, and the objective in units of `1 / objective`.
#[derive(Debug, Default)]
pub(super) struct ScaledProgram {
    pub(super) column: Vec<f64>,
    pub(super) row: Vec<f64>,
    pub(super) objective: f64,
    pub(super) quadratic: Compressed,
    pub(super) linear: Vec<f64>,
    pub(super) rows: Compressed,
    /// Equality rows and their right sides.
    pub(super) equalities: Vec<(usize, f64)>,
    /// The sides of rows, then the sides of columns.
    pub(super) sides: Vec<OneSidedLimit>,
    /// The number of sides of rows.
    pub(super) row_sides: usize,
    pub(super) lower: Vec<f64>,
    pub(super) upper: Vec<f64>,
    pub(super) cones: ScaledCones,
    /// For the factors.
    room: Vec<f64>,
}

impl ScaledProgram {
    /// Becomes another program with the rows of cones, in the memory that it has.
    pub(super) fn load(&mut self, program: &Reduced, cones: &ConeRows) {
        let ScaledProgram {
            column,
            row,
            quadratic,
            linear,
            rows,
            equalities,
            sides,
            lower,
            upper,
            ..
        } = self;
        write_factors(program, column, row, &mut self.room);
        quadratic.copy_from(&program.quadratic);
        let mut largest = 0.0_f64;
        for j in 0..column.len() {
            for k in quadratic.start[j]..quadratic.start[j + 1] {
                quadratic.value[k] *= column[j] * column[quadratic.index[k]];
                largest = largest.max(quadratic.value[k].abs());
            }
        }
        linear.clear();
        linear.extend(program.linear.iter().zip(&*column).map(|(q, d)| q * d));
        let largest = linear.iter().fold(largest, |m, q| m.max(q.abs()));
        let objective =
            if largest > 0.0 { (1.0 / largest).clamp(1.0 / MAX_SCALE, MAX_SCALE) } else { 1.0 };
        quadratic.value.iter_mut().chain(linear).for_each(|v| *v *= objective);
        rows.copy_from(&program.rows);
        for (i, factor) in row.iter().enumerate() {
            for k in rows.start[i]..rows.start[i + 1] {
                rows.value[k] *= factor * column[rows.index[k]];
            }
        }
        equalities.clear();
        sides.clear();
        let add = |sides: &mut Vec<OneSidedLimit>, of, lower: f64, upper: f64| {
            for (sign, limit) in [(1.0, lower), (-1.0, upper)] {
                if limit.is_finite() {
                    sides.push(OneSidedLimit { of, sign, limit });
                }
            }
        };
        for (i, &factor) in row.iter().enumerate() {
            let (lower, upper) = (program.row_lower[i], program.row_upper[i]);
            if lower == upper {
                equalities.push((i, lower * factor));
            } else {
                add(sides, i, lower * factor, upper * factor);
            }
        }
        for (scaled, bounds) in [(&mut *lower, &program.lower), (&mut *upper, &program.upper)] {
            scaled.clear();
            scaled.extend(bounds.iter().zip(&*column).map(|(bound, d)| bound / d));
        }
        self.cones.load(cones, column);
        (self.objective, self.row_sides) = (objective, sides.len());
        (0..column.len()).for_each(|j| add(sides, j, lower[j], upper[j]));
    }

    /// The sides of rows, and those of columns.
    pub(super) fn split_sides(&self) -> (&[OneSidedLimit], &[OneSidedLimit]) {
        self.sides.split_at(self.row_sides)
    }

    /// `P x`.
    pub(super) fn curvature(&self, x: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for j in 0..x.len() {
            let (index, value) = self.quadratic.vector(j);
            for (&i, &p) in index.iter().zip(value) {
                out[i] += p * x[j];
                if i != j {
                    out[j] += p * x[i];
                }
            }
        }
    }

    /// `A x`.
    pub(super) fn activities(&self, x: &[f64], out: &mut [f64]) {
        for (i, activity) in out.iter_mut().enumerate() {
            let (index, value) = self.rows.vector(i);
            *activity = index.iter().zip(value).map(|(&j, a)| a * x[j]).sum();
        }
    }

    /// Adds `A'y` to `out`.
    pub(super) fn add_transposed(&self, y: &[f64], out: &mut [f64]) {
        for (i, &y) in y.iter().enumerate().filter(|(_, y)| **y != 0.0) {
            let (index, value) = self.rows.vector(i);
            index.iter().zip(value).for_each(|(&j, a)| out[j] += a * y);
        }
    }
}
