//! Dense Cholesky factors with their residuals.
//!
//! `L` is the sum of `H`, whose entries are whole multiples of one power of two, and a small rest
//! `K`. The squares of a row of `L` sum up to less than 4, so sums of products in `H H'` stay below
//! `2^53` units, and are exact in plain floats, in whatever order. What is left,
//! `A - H H' - D - D'` with `D = (H + K / 2) K'`, is ten millionths of it, and so is its rounding.

use faer::linalg::cholesky::llt::factor::LltError;
use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::linalg::solvers::Solve;
use faer::prelude::ReborrowMut;
use faer::{Accum, Mat, MatRef, Par, Side};

use super::scaled::{Factored, INVERSE_ITERATIONS, Scaled, is_covered};

/// Binary digits of `H` after the point: twice as many, and those of 4, are less than 53.
const FACTOR_DIGITS: i32 = 24;

/// Factorises a matrix; see `block::factor`.
pub(super) fn factor(matrix: &Scaled, room: &[f64]) -> Factored {
    let n = matrix.diagonal.len();
    let mut a = Mat::<f64>::zeros(n, n);
    for (j, &entry) in matrix.diagonal.iter().enumerate() {
        a[(j, j)] = entry;
    }
    for &(i, j, entry) in &matrix.pairs {
        (a[(i, j)], a[(j, i)]) = (entry, entry);
    }
    let factor = match a.llt(Side::Lower) {
        Ok(factor) => factor,
        Err(error) => return Factored::Weak(turned_back(&a, error)),
    };
    let lower = factor.L();
    let is_covered = {
        let missed = missed(&a, lower);
        is_covered(matrix, &missed, room)
    };
    if is_covered {
        return Factored::Covered;
    }
    let mut vector = Mat::from_fn(n, 1, |k, _| 1.0 + 0.5 * (k as f64).sin());
    for _ in 0..INVERSE_ITERATIONS {
        vector = factor.solve(&vector);
        let size = (0..n).fold(f64::MIN_POSITIVE, |m, k| m.max(vector[(k, 0)].abs()));
        (0..n).for_each(|k| vector[(k, 0)] /= size);
    }
    Factored::Weak((0..n).map(|k| vector[(k, 0)]).collect())
}

/// The sums of the magnitudes in each row of `A - L L'`.
fn missed(a: &Mat<f64>, lower: MatRef<'_, f64>) -> Vec<f64> {
    let n = a.nrows();
    let (unit, per_unit) = (2.0_f64.powi(-FACTOR_DIGITS), 2.0_f64.powi(FACTOR_DIGITS));
    let entry = |i: usize, j: usize| if i >= j { lower[(i, j)] } else { 0.0 };
    let high = Mat::from_fn(n, n, |i, j| (entry(i, j) * per_unit).round() * unit);
    let low = Mat::from_fn(n, n, |i, j| entry(i, j) - high[(i, j)]);
    let middle = Mat::from_fn(n, n, |i, j| high[(i, j)] + 0.5 * low[(i, j)]);
    use BlockStructure::{Rectangular, TriangularLower, TriangularUpper};
    let mut squares = Mat::<f64>::zeros(n, n);
    matmul(
        squares.rb_mut(),
        TriangularLower,
        Accum::Replace,
        high.as_ref(),
        TriangularLower,
        high.transpose(),
        TriangularUpper,
        1.0,
        Par::Seq,
    );
    drop(high);
    let mut mixed = Mat::<f64>::zeros(n, n);
    matmul(
        mixed.rb_mut(),
        Rectangular,
        Accum::Replace,
        middle.as_ref(),
        TriangularLower,
        low.transpose(),
        TriangularUpper,
        1.0,
        Par::Seq,
    );
    // Rounding of sums of `n` products: of entries whose magnitudes sum up to twice the root of
    // `n`, as their squares sum up to 4, and of up to half a unit; in both parts.
    let count = n as f64;
    let rounding = f64::EPSILON * (count + 8.0) * unit * count.sqrt();
    let mut missed = vec![count * rounding; n];
    for j in 0..n {
        for i in j..n {
            let rest = (a[(i, j)] - squares[(i, j)]) - (mixed[(i, j)] + mixed[(j, i)]);
            missed[i] += rest.abs();
            if i != j {
                missed[j] += rest.abs();
            }
        }
    }
    missed.iter_mut().for_each(|sum| *sum *= 1.0 + count * f64::EPSILON);
    missed
}

/// A vector that a matrix turns back whose factorisation failed.
fn turned_back(a: &Mat<f64>, error: LltError) -> Vec<f64> {
    let n = a.nrows();
    let LltError::NonPositivePivot { index } = error;
    let mut vector = vec![0.0; n];
    let mut k = index.min(n - 1);
    loop {
        vector.fill(0.0);
        vector[k] = 1.0;
        if k == 0 {
            return vector;
        }
        if let Ok(factor) = a.submatrix(0, 0, k, k).llt(Side::Lower) {
            let steps = factor.solve(Mat::from_fn(k, 1, |i, _| -a[(i, k)]));
            (0..k).for_each(|i| vector[i] = steps[(i, 0)]);
            return vector;
        }
        k -= 1;
    }
}
