//! Matrix form: `min 1/2 x'Px + q'x + r` over `l <= Ax <= u`, `lower <= x <= upper`, some columns
//! integral, and second-order cones over columns.
//!
//! A [`Program`] is what the solving tower works on. It is assembled from a model *without*
//! indicators (see [`reformulate`](crate::reformulate)); columns are the model's variables in the
//! order of creation, rows its constraints. Maximisation is turned into minimisation here and
//! nowhere else.

mod append;
mod assemble;
mod assemble_cones;
mod cone;
mod cone_tower;
mod steepness;

pub(crate) use append::Addition;
pub use cone::{Cone, ConeRole, ConeShape};
pub(crate) use cone::{LONGEST_TAIL, conic_columns};
pub(crate) use cone_tower::{FEW_LONG_CONES, LONG_TAIL};

use std::ops::Range;
use std::sync::OnceLock;

use faer::sparse::{SparseColMat, SparseRowMat};

use crate::solver::ProgramSize;
use crate::sum::Sum;

/// A mixed-integer convex quadratic program in matrix form, always a minimisation.
#[derive(Debug, Clone)]
pub struct Program {
    /// `P`, symmetric, both triangles stored; shape columns x columns.
    pub quadratic: SparseColMat<usize, f64>,
    /// `q`, one entry a column.
    pub linear: Vec<f64>,
    /// `r`.
    pub offset: f64,
    /// The part of the objective that all points of the model have in common, which the relative
    /// gap leaves out.
    pub constant: f64,
    /// `+1` when the model minimises, `-1` when it maximises: model objective = sign * value.
    pub sign: f64,
    /// `A` by rows; shape rows x columns.
    pub rows: SparseRowMat<usize, f64>,
    /// `A` by columns.
    pub columns: SparseColMat<usize, f64>,
    /// `l`, one entry a row, possibly `-inf`.
    pub row_lower: Vec<f64>,
    /// `u`, one entry a row, possibly `+inf`.
    pub row_upper: Vec<f64>,
    /// Lower bounds of the columns; whole numbers for integral ones.
    pub lower: Vec<f64>,
    /// Upper bounds of the columns; whole numbers for integral ones.
    pub upper: Vec<f64>,
    /// Which columns must take whole values.
    pub integral: Vec<bool>,
    /// The integral columns, in order.
    pub integers: Vec<usize>,
    /// Second-order cones. [`is_in_cone`](Program::is_in_cone) remembers them: set them by
    /// `set_cones`.
    pub cones: Vec<Cone>,
    /// Which columns are in cones; computed at the first request.
    pub(crate) conic: OnceLock<Vec<bool>>,
    /// The rows that cut off cones, if relaxations cut them off, and do not solve them as they are.
    /// A search finds further ones.
    pub cone_cuts: Option<Range<usize>>,
    /// Where each column stands in time: the step of its name, for members of families.
    pub step: Vec<Option<usize>>,
    /// How far columns without bounds may be out at points within the radius of proofs, as a
    /// multiple of it, at least 1 (no unit).
    pub(crate) spread: f64,
    /// By how much presolve has widened the limits of rows and the bounds of columns, in their
    /// units; empty if it has not. Rows and columns that were appended are not widened.
    pub(crate) widened: [Vec<f64>; 2],
    /// How steep the objective is; computed at the first request.
    pub(crate) steepness: OnceLock<Vec<f64>>,
    /// The program with squares in the objective in place of their cones; computed at the first
    /// request.
    pub(crate) squared: OnceLock<Option<Box<Program>>>,
}

impl Program {
    /// Number of columns.
    pub fn column_count(&self) -> usize {
        self.linear.len()
    }

    /// Number of rows.
    pub fn row_count(&self) -> usize {
        self.row_lower.len()
    }

    /// Its size.
    pub(crate) fn size(&self) -> ProgramSize {
        let mut size = ProgramSize::default();
        (size.rows, size.columns) = (self.row_count(), self.column_count());
        (size.integers, size.nonzeros) = (self.integers.len(), self.rows.compute_nnz());
        size.cones = self.cones.len();
        size
    }

    /// Column indices and coefficients of a row.
    pub fn row(&self, row: usize) -> (&[usize], &[f64]) {
        let range = self.rows.symbolic().row_range(row);
        (&self.rows.symbolic().col_idx()[range.clone()], &self.rows.val()[range])
    }

    /// The terms of a row, without zeros.
    pub(crate) fn row_terms(&self, row: usize) -> Vec<(usize, f64)> {
        let (columns, values) = self.row(row);
        let terms = columns.iter().copied().zip(values.iter().copied());
        terms.filter(|(_, a)| *a != 0.0).collect()
    }

    /// Whether a column is in a cone, so that more than its rows and its cost speak of it.
    #[inline]
    pub fn is_in_cone(&self, column: usize) -> bool {
        if self.cones.is_empty() {
            return false;
        }
        let conic = self.conic.get_or_init(|| conic_columns(&self.cones, self.column_count()));
        // Columns that were appended since are in none.
        conic.get(column).copied().unwrap_or(false)
    }

    /// Replaces the cones.
    pub(crate) fn set_cones(&mut self, cones: Vec<Cone>) {
        (self.cones, self.conic, self.squared) = (cones, OnceLock::new(), OnceLock::new());
    }

    /// The sum of a row's terms at a point.
    pub(crate) fn activity(&self, row: usize, x: &[f64]) -> f64 {
        let (columns, values) = self.row(row);
        columns.iter().zip(values).map(|(&j, a)| a * x[j]).sum()
    }

    /// Row indices and coefficients of a column.
    pub fn column(&self, column: usize) -> (&[usize], &[f64]) {
        let range = self.columns.symbolic().col_range(column);
        (&self.columns.symbolic().row_idx()[range.clone()], &self.columns.val()[range])
    }

    /// Row indices and values of a column of `P`.
    pub fn quadratic_column(&self, column: usize) -> (&[usize], &[f64]) {
        let range = self.quadratic.symbolic().col_range(column);
        (&self.quadratic.symbolic().row_idx()[range.clone()], &self.quadratic.val()[range])
    }

    /// An entry of `P`; 0 where there is none.
    pub(crate) fn quadratic_entry(&self, row: usize, column: usize) -> f64 {
        let (rows, values) = self.quadratic_column(column);
        rows.iter().position(|&i| i == row).map_or(0.0, |k| values[k])
    }

    /// Rows, columns and values of `P`.
    pub(crate) fn quadratic_entries(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        self.quadratic.triplet_iter().map(|entry| (entry.row, entry.col, *entry.val))
    }

    /// Whether the objective is constant, so that any feasible point is optimal.
    pub fn is_feasibility_problem(&self) -> bool {
        self.linear.iter().all(|&q| q == 0.0) && self.quadratic.compute_nnz() == 0
    }

    /// Replaces the objective by 0.
    pub fn make_feasibility_problem(&mut self) {
        let n = self.column_count();
        // An empty list of entries cannot fail.
        if let Ok(zero) = SparseColMat::try_new_from_triplets(n, n, &[]) {
            self.quadratic = zero;
        }
        self.linear = vec![0.0; n];
        (self.offset, self.constant) = (0.0, 0.0);
        self.steepness = OnceLock::new();
    }

    /// Value of the (minimised) objective at a point.
    pub fn objective(&self, x: &[f64]) -> f64 {
        let mut sum = Sum::new(self.offset);
        for (j, &xj) in x.iter().enumerate() {
            sum.add_product(self.linear[j], xj);
            let (rows, entries) = self.quadratic_column(j);
            // The matrix is symmetric.
            for (&i, &p) in rows.iter().zip(entries).take_while(|(i, _)| **i <= j) {
                sum.add_product_of_three(x[i], xj, if i < j { p } else { 0.5 * p });
            }
        }
        sum.value()
    }

    /// Gradient of the (minimised) objective at a point.
    pub(crate) fn gradient(&self, x: &[f64]) -> Vec<f64> {
        let mut gradient = self.linear.clone();
        for (j, &xj) in x.iter().enumerate() {
            let (rows, entries) = self.quadratic_column(j);
            rows.iter().zip(entries).for_each(|(&i, p)| gradient[i] += p * xj);
        }
        gradient
    }
}
