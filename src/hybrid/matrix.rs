//! Types that can be given as a matrix.

use faer::Mat;

/// A matrix of numbers: `faer`'s, or an array of rows.
///
/// ```
/// use carom::hybrid::{IntoMatrix, LinearSystem};
///
/// assert_eq!([[1.0, 2.0], [3.0, 4.0]].into_matrix()[(1, 0)], 3.0);
/// // A system of two states without inputs.
/// let decay = LinearSystem::new([[0.9, 0.0], [0.1, 0.8]], [[]; 2], [0.0, 0.0])?;
/// assert_eq!((decay.states(), decay.inputs()), (2, 0));
/// # Ok::<(), carom::Error>(())
/// ```
pub trait IntoMatrix {
    /// The matrix, row by row.
    fn into_matrix(self) -> Mat<f64>;
}

impl IntoMatrix for Mat<f64> {
    fn into_matrix(self) -> Mat<f64> {
        self
    }
}

impl IntoMatrix for &Mat<f64> {
    fn into_matrix(self) -> Mat<f64> {
        self.clone()
    }
}

impl<const M: usize, const N: usize> IntoMatrix for [[f64; N]; M] {
    fn into_matrix(self) -> Mat<f64> {
        Mat::from_fn(M, N, |i, j| self[i][j])
    }
}

impl<const M: usize, const N: usize> IntoMatrix for &[[f64; N]; M] {
    fn into_matrix(self) -> Mat<f64> {
        (*self).into_matrix()
    }
}
