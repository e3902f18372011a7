//! Vectors and matrices of the crate `nalgebra`, to and from those of this crate.

use ::nalgebra::{Const, DMatrix, DVector, Dim, RawStorage, SMatrix};

use super::{Matrix, Region};
use crate::error::{Error, ErrorKind};

/// Matrices and vectors of the crate `nalgebra`, of fixed or dynamic size, owned or views, with the
/// feature `nalgebra`. A vector becomes a column.
///
/// So functions that take a matrix take them as they are. Where a function takes numbers, it takes
/// `vector.as_slice()`, and a region of one state is a vector.
///
/// ```
/// use carom::hybrid::{LinearSystem, Lqr, Region};
/// use nalgebra::{DMatrix, Matrix1, Matrix2, Vector2};
///
/// let (a, b) = (Matrix2::new(1.0, 0.1, 0.0, 1.0), Vector2::new(0.005, 0.1));
/// let vehicle = LinearSystem::new(a, b, Vector2::zeros().as_slice())?;
/// let lqr = Lqr::new(&vehicle, Matrix2::identity(), Matrix1::new(0.5))?;
///
/// // And back: a step of the closed loop, by nalgebra's own arithmetic.
/// let x = Vector2::new(1.0, 0.0);
/// let u = DMatrix::from(&lqr.gain) * x;
/// let next = a * x + b * u[0];
/// let same = vehicle.step(x.as_slice(), u.as_slice())?;
/// assert!((next - Vector2::from_vec(same)).norm() < 1e-12);
///
/// let cost: Matrix2<f64> = (&lqr.cost).try_into()?; // an error if it were not 2 x 2
/// assert!((cost - cost.transpose()).norm() < 1e-9);
/// assert!(Region::from(x).contains(&[1.0, 0.0], 0.0)?);
/// # Ok::<(), carom::Error>(())
/// ```
impl<R: Dim, C: Dim, S: RawStorage<f64, R, C>> From<::nalgebra::Matrix<f64, R, C, S>> for Matrix {
    fn from(matrix: ::nalgebra::Matrix<f64, R, C, S>) -> Self {
        Matrix::from(&matrix)
    }
}

/// As of a matrix itself.
impl<R: Dim, C: Dim, S: RawStorage<f64, R, C>> From<&::nalgebra::Matrix<f64, R, C, S>> for Matrix {
    fn from(matrix: &::nalgebra::Matrix<f64, R, C, S>) -> Self {
        Matrix::from_fn(matrix.nrows(), matrix.ncols(), |i, j| matrix[(i, j)])
    }
}

/// With the feature `nalgebra`.
impl From<&Matrix> for DMatrix<f64> {
    fn from(matrix: &Matrix) -> Self {
        DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |i, j| matrix[(i, j)])
    }
}

/// With the feature `nalgebra`.
impl From<Matrix> for DMatrix<f64> {
    fn from(matrix: Matrix) -> Self {
        DMatrix::from(&matrix)
    }
}

/// With the feature `nalgebra`; for vectors too. [`ErrorKind::Shape`] for another shape.
impl<const R: usize, const C: usize> TryFrom<&Matrix> for SMatrix<f64, R, C> {
    type Error = Error;

    fn try_from(matrix: &Matrix) -> Result<Self, Error> {
        check_shape(matrix, R, C)?;
        Ok(SMatrix::from_fn(|i, j| matrix[(i, j)]))
    }
}

/// With the feature `nalgebra`; for vectors too. [`ErrorKind::Shape`] for another shape.
impl<const R: usize, const C: usize> TryFrom<Matrix> for SMatrix<f64, R, C> {
    type Error = Error;

    fn try_from(matrix: Matrix) -> Result<Self, Error> {
        (&matrix).try_into()
    }
}

/// With the feature `nalgebra`. [`ErrorKind::Shape`] for a matrix that is not one column.
impl TryFrom<&Matrix> for DVector<f64> {
    type Error = Error;

    fn try_from(matrix: &Matrix) -> Result<Self, Error> {
        check_shape(matrix, matrix.nrows(), 1)?;
        Ok(DVector::from_fn(matrix.nrows(), |i, _| matrix[(i, 0)]))
    }
}

/// With the feature `nalgebra`. [`ErrorKind::Shape`] for a matrix that is not one column.
impl TryFrom<Matrix> for DVector<f64> {
    type Error = Error;

    fn try_from(matrix: Matrix) -> Result<Self, Error> {
        (&matrix).try_into()
    }
}

/// One state, as [`Region::point`], with the feature `nalgebra`.
impl<R: Dim, S: RawStorage<f64, R, Const<1>>> From<::nalgebra::Matrix<f64, R, Const<1>, S>>
    for Region
{
    fn from(state: ::nalgebra::Matrix<f64, R, Const<1>, S>) -> Self {
        Region::from(&state)
    }
}

/// One state, as [`Region::point`], with the feature `nalgebra`.
impl<R: Dim, S: RawStorage<f64, R, Const<1>>> From<&::nalgebra::Matrix<f64, R, Const<1>, S>>
    for Region
{
    fn from(state: &::nalgebra::Matrix<f64, R, Const<1>, S>) -> Self {
        Region::point(state.iter().copied().collect::<Vec<f64>>())
    }
}

fn check_shape(matrix: &Matrix, rows: usize, columns: usize) -> Result<(), Error> {
    if (matrix.nrows(), matrix.ncols()) == (rows, columns) {
        return Ok(());
    }
    Err(ErrorKind::Shape {
        what: "a matrix for nalgebra",
        rows: matrix.nrows(),
        columns: matrix.ncols(),
        expected: format!("{rows} x {columns}"),
    }
    .into())
}
