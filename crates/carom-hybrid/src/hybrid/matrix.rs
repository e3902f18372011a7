//! Dense matrices.

use std::ops::Index;

use faer::Mat;

use crate::error::{Error, ErrorKind};

/// A dense matrix of numbers, read by `matrix[(row, column)]`. Functions that take a matrix take
/// arrays of rows too, and, with the feature `nalgebra`, the matrices of that crate.
///
/// ```
/// use carom::hybrid::{LinearSystem, Matrix};
///
/// let turn = Matrix::from([[0.0, -1.0], [1.0, 0.0]]);
/// assert_eq!((turn[(0, 1)], turn.nrows()), (-1.0, 2));
/// // Rows that are known only when the program runs.
/// let rows = vec![vec![0.9, 0.0], vec![0.1, 0.8]];
/// let decay = LinearSystem::new(Matrix::from_rows(&rows)?, [[]; 2], [0.0, 0.0])?;
/// assert_eq!((decay.states(), decay.inputs()), (2, 0));
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Matrix(Mat<f64>);

impl Matrix {
    /// The matrix of some rows and columns with an entry for each pair of them.
    pub fn from_fn(rows: usize, columns: usize, entry: impl FnMut(usize, usize) -> f64) -> Self {
        Matrix(Mat::from_fn(rows, columns, entry))
    }

    /// The matrix of a list of rows.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Shape`] for rows of different lengths.
    pub fn from_rows<R: AsRef<[f64]>>(rows: &[R]) -> Result<Self, Error> {
        let columns = rows.first().map_or(0, |row| row.as_ref().len());
        match rows.iter().map(|row| row.as_ref().len()).find(|length| *length != columns) {
            Some(length) => Err(ErrorKind::Shape {
                what: "a row of a matrix",
                rows: 1,
                columns: length,
                expected: format!("{columns} columns in every row"),
            }
            .into()),
            None => Ok(Matrix::from_fn(rows.len(), columns, |i, j| rows[i].as_ref()[j])),
        }
    }

    /// The matrix of zeros.
    pub fn zeros(rows: usize, columns: usize) -> Self {
        Matrix(Mat::zeros(rows, columns))
    }

    /// The matrix with ones on its diagonal.
    pub fn identity(size: usize) -> Self {
        Matrix(Mat::identity(size, size))
    }

    /// The number of rows.
    pub fn nrows(&self) -> usize {
        self.0.nrows()
    }

    /// The number of columns.
    pub fn ncols(&self) -> usize {
        self.0.ncols()
    }

    /// The rows as lists.
    pub fn to_rows(&self) -> Vec<Vec<f64>> {
        (0..self.nrows()).map(|i| (0..self.ncols()).map(|j| self[(i, j)]).collect()).collect()
    }

    /// The matrix as the library for linear algebra has it.
    pub(crate) fn faer(&self) -> &Mat<f64> {
        &self.0
    }
}

/// A matrix that is given in any of the forms, as the library for linear algebra has it.
pub(crate) fn faer(matrix: impl Into<Matrix>) -> Mat<f64> {
    matrix.into().0
}

impl Index<(usize, usize)> for Matrix {
    type Output = f64;

    fn index(&self, index: (usize, usize)) -> &f64 {
        &self.0[index]
    }
}

impl<const M: usize, const N: usize> From<[[f64; N]; M]> for Matrix {
    fn from(rows: [[f64; N]; M]) -> Self {
        Matrix::from_fn(M, N, |i, j| rows[i][j])
    }
}

impl<const M: usize, const N: usize> From<&[[f64; N]; M]> for Matrix {
    fn from(rows: &[[f64; N]; M]) -> Self {
        (*rows).into()
    }
}

impl From<&Matrix> for Matrix {
    fn from(matrix: &Matrix) -> Self {
        matrix.clone()
    }
}

#[doc(hidden)]
impl From<Mat<f64>> for Matrix {
    fn from(matrix: Mat<f64>) -> Self {
        Matrix(matrix)
    }
}

#[doc(hidden)]
impl From<&Mat<f64>> for Matrix {
    fn from(matrix: &Mat<f64>) -> Self {
        Matrix(matrix.clone())
    }
}
