//! Postsolve: a stack of undos, the last reduction first.
//!
//! Takes a point of the presolved program with its multipliers; leaves those of the original.
//!
//! Multipliers follow one convention: the reduced cost of a column is `d = q + Px + A'y`; a
//! positive multiplier belongs to a row's upper limit, a negative one to its lower limit; a
//! positive reduced cost belongs to a lower bound, a negative one to an upper bound. They are those
//! of the continuous program with the integral columns fixed, so the reduced cost of an integral
//! column may have any sign.

use std::collections::BTreeMap;
use std::fmt::Debug;

use crate::error::{Error, check_length};
use crate::program::Program;

/// Undoes one reduction. Columns and rows have the numbers of the original program throughout.
pub(super) trait Undo: Debug + Send + Sync {
    /// Gives values to the columns that the reduction took out, if it took out any.
    fn primal(&self, _x: &mut [f64]) {}

    /// Derives values of other columns from known values of columns that the reduction took out.
    fn carry(&self, _known: &mut BTreeMap<usize, f64>) {}

    /// Follows columns that the reduction has put into other units, or turned around.
    fn restate(&self, _meanings: &mut [ColumnMeaning]) {}

    /// The column that an equality has replaced, and the row of that.
    fn replaced(&self) -> Option<(usize, usize)> {
        None
    }

    /// Gives multipliers to the rows, and reduced costs to the columns, that the reduction changed
    /// or took out. Values are those of the program before this reduction, not yet of the original.
    fn dual(&self, all: &mut Restored);
}

/// A point and its multipliers.
#[derive(Debug, Clone, PartialEq)]
pub struct Restored {
    /// Values of the columns.
    pub x: Vec<f64>,
    /// Multipliers of the rows: positive ones press on upper limits, negative ones on lower limits.
    pub y: Vec<f64>,
    /// Reduced costs `q + Px + A'y` of the columns: positive ones press on lower bounds, negative
    /// ones on upper bounds; those of integral columns may have any sign.
    pub d: Vec<f64>,
}

/// A presolved program and the way back.
#[derive(Debug)]
pub struct Presolved {
    /// The presolved program; its optimum is that of the original.
    pub program: Program,
    /// From its points to those of the original.
    pub postsolve: Postsolve,
    /// The largest error of the objective from rounding, in its unit: constants of 1e8 may cancel
    /// down to
    /// 1. A bound on the presolved program, less this error, is a bound on the original.
    pub rounding: f64,
}

impl Presolved {
    /// The original's point and multipliers from those of the presolved program.
    ///
    /// The pair satisfies the conditions of Karush, Kuhn and Tucker of the original with its
    /// integral columns fixed where the given one satisfies those of the presolved program.
    ///
    /// # Arguments
    ///
    /// * `x`: one value a column of the presolved program.
    /// * `y`: one multiplier a row; positive ones press on upper limits, negative ones on lower.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Length`](crate::error::ErrorKind::Length) when a length does not match.
    pub fn restore(&self, x: &[f64], y: &[f64]) -> Result<Restored, Error> {
        let program = &self.program;
        check_length("the point", x.len(), program.column_count())?;
        check_length("the multipliers", y.len(), program.row_count())?;
        let reduced_cost = |j: usize| {
            let dot = |(index, value): (&[usize], &[f64]), with: &[f64]| -> f64 {
                index.iter().zip(value).map(|(&k, a)| a * with[k]).sum()
            };
            program.linear[j] + dot(program.quadratic_column(j), x) + dot(program.column(j), y)
        };
        let d: Vec<f64> = (0..x.len()).map(reduced_cost).collect();
        Ok(self.postsolve.restore(x, y, &d))
    }
}

/// From points of a presolved program to points of the original.
#[derive(Debug)]
pub struct Postsolve {
    pub(super) undos: Vec<Box<dyn Undo>>,
    /// Original column of each presolved one.
    pub(super) columns: Vec<usize>,
    /// Original row of each presolved one.
    pub(super) rows: Vec<usize>,
    /// Numbers of columns and of rows, added ones included.
    pub(super) column_count: usize,
    pub(super) row_count: usize,
    /// The number of the original's rows; the others were added.
    pub(super) own_row_count: usize,
}

/// A column of the original program by one of the presolved program: `factor x + shift`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ColumnMeaning {
    pub(crate) factor: f64,
    pub(crate) shift: f64,
}

impl ColumnMeaning {
    /// That of a column as it was.
    pub(crate) const SAME: ColumnMeaning = ColumnMeaning { factor: 1.0, shift: 0.0 };

    /// Puts `factor x + shift` in the place of the column.
    pub(super) fn put(&mut self, factor: f64, shift: f64) {
        self.shift += self.factor * shift;
        self.factor *= factor;
    }

    /// The original's value behind one of the column.
    pub(crate) fn value(self, x: f64) -> f64 {
        self.factor * x + self.shift
    }

    /// A term in the column as one in the original, and its constant.
    pub(crate) fn term(self, a: f64) -> (f64, f64) {
        (a / self.factor, -a * self.shift / self.factor)
    }
}

/// Where columns and rows of a presolved program come from.
#[derive(Debug, Clone)]
pub(crate) struct Origins {
    /// By column and by row, those of the original.
    pub(crate) columns: Vec<usize>,
    pub(crate) rows: Vec<usize>,
    /// By column, what it says of the original's.
    pub(crate) meanings: Vec<ColumnMeaning>,
    /// By column that an equality has replaced, the row of that.
    pub(crate) equations: BTreeMap<usize, usize>,
}

impl Origins {
    /// Those of a program that is its own original.
    pub(crate) fn of(program: &Program) -> Self {
        Origins {
            columns: (0..program.column_count()).collect(),
            rows: (0..program.row_count()).collect(),
            meanings: vec![ColumnMeaning::SAME; program.column_count()],
            equations: BTreeMap::new(),
        }
    }
}

impl Postsolve {
    /// The original column of each presolved one.
    pub fn columns(&self) -> &[usize] {
        &self.columns
    }

    /// The original row of each presolved one.
    pub fn rows(&self) -> &[usize] {
        &self.rows
    }

    /// Where columns and rows come from.
    pub(crate) fn origins(&self) -> Origins {
        let mut meanings = vec![ColumnMeaning::SAME; self.column_count];
        self.undos.iter().for_each(|undo| undo.restate(&mut meanings));
        Origins {
            meanings: self.columns.iter().map(|&j| meanings[j]).collect(),
            columns: self.columns.clone(),
            rows: self.rows.clone(),
            equations: self.undos.iter().filter_map(|undo| undo.replaced()).collect(),
        }
    }

    /// The original's point; missing values count as 0, and values too many are ignored.
    pub fn point(&self, x: &[f64]) -> Vec<f64> {
        let mut full = scatter(self.column_count, &self.columns, x);
        self.undos.iter().rev().for_each(|undo| undo.primal(&mut full));
        full
    }

    /// Values of columns of the original as values of presolved ones, in their order. Those of
    /// columns that were taken out go to the column that they decide, behind the others, or are
    /// left out; of several values of a column the first one counts.
    pub fn carry(&self, values: &[(usize, f64)]) -> Vec<(usize, f64)> {
        let mut known: BTreeMap<usize, f64> = BTreeMap::new();
        for &(column, value) in values {
            known.entry(column).or_insert(value);
        }
        self.undos.iter().for_each(|undo| undo.carry(&mut known));
        let place = |column: usize| self.columns.binary_search(&column).ok();
        let mut carried = Vec::with_capacity(known.len());
        for &(column, _) in values {
            carried.extend(known.remove(&column).and_then(|value| Some((place(column)?, value))));
        }
        carried.extend(known.into_iter().filter_map(|(column, v)| Some((place(column)?, v))));
        carried
    }

    /// The original's point with its multipliers, from values, multipliers and reduced costs.
    fn restore(&self, x: &[f64], y: &[f64], d: &[f64]) -> Restored {
        let mut all = Restored {
            x: scatter(self.column_count, &self.columns, x),
            y: scatter(self.row_count, &self.rows, y),
            d: scatter(self.column_count, &self.columns, d),
        };
        for undo in self.undos.iter().rev() {
            undo.primal(&mut all.x);
            undo.dual(&mut all);
        }
        all.y.truncate(self.own_row_count);
        all
    }
}

fn scatter(length: usize, positions: &[usize], values: &[f64]) -> Vec<f64> {
    let mut full = vec![0.0; length];
    positions.iter().zip(values).for_each(|(&k, &v)| full[k] = v);
    full
}
