//! The matrix exponential, for exact discretisation.
//!
//! Scaling and squaring around a Taylor polynomial: `exp(M) = (exp(M / 2^s))^(2^s)`, with `s`
//! chosen so that the scaled matrix has 1-norm at most 1/2. There the remainder of a polynomial of
//! degree 18 is below 1e-22, and no matrix is inverted. See C. Moler and C. Van Loan, "Nineteen
//! dubious ways to compute the exponential of a matrix, twenty-five years later", SIAM Review
//! 45(1), 2003, method 3.

use faer::Mat;

/// Degree of the Taylor polynomial.
const DEGREE: u32 = 18;

/// 1-norm up to which the polynomial is used unscaled.
pub(super) const RADIUS: f64 = 0.5;

/// `exp(matrix)` of a square, finite matrix; entries may overflow to infinity.
pub(crate) fn exponential(matrix: &Mat<f64>) -> Mat<f64> {
    let size = matrix.nrows();
    let mut squarings = 0u32;
    let mut factor = 1.0;
    let norm = one_norm(matrix);
    while norm * factor > RADIUS {
        factor *= 0.5;
        squarings += 1;
    }
    let scaled = Mat::from_fn(size, size, |i, j| matrix[(i, j)] * factor);

    // Horner's scheme: I + X (I + X/2 (I + X/3 (...))).
    let mut result = Mat::<f64>::identity(size, size);
    for degree in (1..=DEGREE).rev() {
        let product = &scaled * &result;
        let entry = |i, j| f64::from(u8::from(i == j)) + product[(i, j)] / f64::from(degree);
        result = Mat::from_fn(size, size, entry);
    }
    for _ in 0..squarings {
        result = &result * &result;
    }
    result
}

/// The largest sum of magnitudes in a column.
fn one_norm(matrix: &Mat<f64>) -> f64 {
    let column = |j| (0..matrix.nrows()).map(|i| f64::abs(matrix[(i, j)])).sum::<f64>();
    (0..matrix.ncols()).map(column).fold(0.0, f64::max)
}
