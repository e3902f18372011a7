//! Linear time-invariant steps `x⁺ = A x + B u + c`.

use faer::Mat;

use super::exponential::{RADIUS, exponential};
use super::matrix::Matrix;
use crate::error::{Error, ErrorKind, FINITE_POSITIVE, check_finite, check_length};
use crate::model::Affine;

/// A discrete linear time-invariant system `x⁺ = A x + B u + c`.
///
/// With `n` states and `m` inputs, `A` is n x n, `B` is n x m and `c` has n entries. Units and the
/// frame of the states are up to you.
///
/// ```
/// use carom::hybrid::LinearSystem;
///
/// let vehicle = LinearSystem::double_integrator(0.5)?;
/// // From 10 m at rest, half a second at -2 m/s².
/// assert_eq!(vehicle.step(&[10.0, 0.0], &[-2.0])?, [9.75, -1.0]);
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Stored", into = "Stored"))]
pub struct LinearSystem {
    a: Matrix,
    b: Matrix,
    c: Vec<f64>,
}

impl LinearSystem {
    /// The system with the given matrices.
    ///
    /// # Arguments
    ///
    /// * `a`: n x n, `b`: n x m, `c`: n entries, for n states and m inputs, `n >= 1`.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Shape`] and [`ErrorKind::Length`] if the shapes do not fit,
    /// [`ErrorKind::NotFinite`] for a NaN or infinite entry.
    pub fn new(
        a: impl Into<Matrix>,
        b: impl Into<Matrix>,
        c: impl Into<Vec<f64>>,
    ) -> Result<Self, Error> {
        let system = LinearSystem { a: a.into(), b: b.into(), c: c.into() };
        system.check()?;
        Ok(system)
    }

    /// A mass on a line: state `[x, v]` (m, m/s), input `[a]` (m/s²), acceleration held over the
    /// step; the paper's equations (3) and (4).
    ///
    /// # Arguments
    ///
    /// * `time_step`: Δt in s, finite and positive.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`] for a time step that is not finite and positive.
    pub fn double_integrator(time_step: f64) -> Result<Self, Error> {
        check_time_step(time_step)?;
        let (a, b) = ([[1.0, time_step], [0.0, 1.0]], [[0.5 * time_step * time_step], [time_step]]);
        LinearSystem::new(a, b, [0.0, 0.0])
    }

    /// The exact discretisation of `dx/dt = A x + B u + c` with the input held over each step.
    ///
    /// The first n rows of `exp(Δt [A B c; 0 0 0; 0 0 0])` are `[A_d B_d c_d]` (C. Van Loan,
    /// "Computing integrals involving the matrix exponential", IEEE Transactions on Automatic
    /// Control 23(3), 1978). Entries are exact to about 1e-14 of the matrix's norm.
    ///
    /// # Arguments
    ///
    /// * `a`: n x n (1/s), `b`: n x m, `c`: n entries, of the continuous system.
    /// * `time_step`: Δt in s, finite and positive.
    ///
    /// ```
    /// use carom::hybrid::LinearSystem;
    ///
    /// // dv/dt = -v + u, for one second.
    /// let drag = LinearSystem::zero_order_hold([[-1.0]], [[1.0]], [0.0], 1.0)?;
    /// let decay = (-1.0_f64).exp();
    /// assert!((drag.a()[(0, 0)] - decay).abs() < 1e-15);
    /// assert!((drag.b()[(0, 0)] - (1.0 - decay)).abs() < 1e-15);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As for [`LinearSystem::new`]; [`ErrorKind::OutOfRange`] for a time step that is not finite
    /// and positive, or so long that the discrete system overflows.
    #[doc(alias("ZOH", "discretize", "discretise"))]
    pub fn zero_order_hold(
        a: impl Into<Matrix>,
        b: impl Into<Matrix>,
        c: impl Into<Vec<f64>>,
        time_step: f64,
    ) -> Result<Self, Error> {
        check_time_step(time_step)?;
        let continuous = LinearSystem::new(a, b, c)?;
        let (n, m) = (continuous.states(), continuous.inputs());
        // Columns of inputs and constants do not grow the norm, so that flows with the same A have
        // the same discrete one, to the last digit. Powers of two scale exactly.
        let entry = |i: usize, j: usize| match j {
            j if j < n => continuous.a[(i, j)],
            j if j < n + m => continuous.b[(i, j - n)],
            _ => continuous.c[i],
        };
        let size = |j: usize| (0..n).map(|i| (time_step * entry(i, j)).abs()).sum::<f64>();
        let most = (0..n).map(size).fold(RADIUS, f64::max);
        let scale = |j: usize| match j < n || size(j) <= most {
            true => 1.0,
            false => 2.0_f64.powi((most / size(j)).log2().floor().max(-1000.0) as i32),
        };
        let scales: Vec<f64> = (0..=n + m).map(scale).collect();
        let augmented = Mat::from_fn(n + m + 1, n + m + 1, |i, j| match i < n {
            true => time_step * entry(i, j) * scales[j],
            false => 0.0,
        });
        let discrete = exponential(&augmented);
        let system = LinearSystem {
            a: Matrix::from_fn(n, n, |i, j| discrete[(i, j)]),
            b: Matrix::from_fn(n, m, |i, j| discrete[(i, n + j)] / scales[n + j]),
            c: (0..n).map(|i| discrete[(i, n + m)] / scales[n + m]).collect(),
        };
        system.check().map_err(|_| {
            Error::out_of_range_in_words(
                "the time step of the zero-order hold",
                time_step,
                ..,
                "short enough for the discrete system to stay finite",
            )
        })?;
        Ok(system)
    }

    /// The same system with one more input, which changes nothing.
    pub(crate) fn with_idle_input(&self) -> Self {
        let (n, m) = (self.states(), self.inputs());
        let b = Matrix::from_fn(n, m + 1, |i, j| if j < m { self.b[(i, j)] } else { 0.0 });
        LinearSystem { a: self.a.clone(), b, c: self.c.clone() }
    }

    /// The state matrix, n x n.
    pub fn a(&self) -> &Matrix {
        &self.a
    }

    /// The input matrix, n x m.
    pub fn b(&self) -> &Matrix {
        &self.b
    }

    /// The constant part, n entries.
    pub fn c(&self) -> &[f64] {
        &self.c
    }

    /// Number of states, n.
    pub fn states(&self) -> usize {
        self.a.nrows()
    }

    /// Number of inputs, m.
    pub fn inputs(&self) -> usize {
        self.b.ncols()
    }

    /// One step in numbers: `A x + B u + c`, in the units of the states.
    ///
    /// # Arguments
    ///
    /// * `state`: n entries, `input`: m entries.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Length`].
    pub fn step(&self, state: &[f64], input: &[f64]) -> Result<Vec<f64>, Error> {
        self.check_lengths(state.len(), input.len())?;
        Ok((0..self.states())
            .map(|i| {
                let from_state = (0..state.len()).map(|j| self.a[(i, j)] * state[j]).sum::<f64>();
                // An input that changes nothing may have no value.
                let inputs = (0..input.len()).filter(|&j| self.b[(i, j)] != 0.0);
                let from_input = inputs.map(|j| self.b[(i, j)] * input[j]).sum::<f64>();
                from_state + from_input + self.c[i]
            })
            .collect())
    }

    /// One step in expressions: `A x + B u + c`, in the units of the states. If `state` was itself
    /// predicted, they are predictions over several steps.
    #[doc(hidden)]
    pub fn predict<X, U>(&self, state: &[X], input: &[U]) -> Result<Vec<Affine>, Error>
    where
        for<'a> Affine: From<&'a X> + From<&'a U>,
    {
        self.check_lengths(state.len(), input.len())?;
        let state: Vec<Affine> = state.iter().map(Affine::from).collect();
        let input: Vec<Affine> = input.iter().map(Affine::from).collect();
        Ok((0..self.states())
            .map(|i| {
                let mut sum = Affine::constant(self.c[i]);
                let columns = (0..state.len()).map(|j| (self.a[(i, j)], &state[j]));
                let columns = columns.chain((0..input.len()).map(|j| (self.b[(i, j)], &input[j])));
                for (coefficient, expression) in columns.filter(|&(a, _)| a != 0.0) {
                    sum += coefficient * expression;
                }
                sum
            })
            .collect())
    }

    fn check(&self) -> Result<(), Error> {
        let n = self.a.nrows();
        let shape = |what, matrix: &Matrix, expected: String| {
            let (rows, columns) = (matrix.nrows(), matrix.ncols());
            Err(ErrorKind::Shape { what, rows, columns, expected }.into())
        };
        if n == 0 || self.a.ncols() != n {
            return shape("the state matrix A", &self.a, "square, at least 1x1".into());
        }
        if self.b.nrows() != n {
            return shape("the input matrix B", &self.b, format!("{n} rows"));
        }
        check_length("the constant part c", self.c.len(), n)?;
        let entries = |matrix: &Matrix| {
            let (rows, columns) = (matrix.nrows(), matrix.ncols());
            let index = (0..rows).flat_map(move |i| (0..columns).map(move |j| (i, j)));
            check_finite("the linear system", "an entry", index.map(|index| matrix[index]))
        };
        entries(&self.a)?;
        entries(&self.b)?;
        check_finite("the linear system", "an entry", self.c.iter().copied())
    }

    fn check_lengths(&self, state: usize, input: usize) -> Result<(), Error> {
        check_length("the state", state, self.states())?;
        check_length("the input", input, self.inputs())
    }
}

pub(super) fn check_time_step(time_step: f64) -> Result<(), Error> {
    if time_step.is_finite() && time_step > 0.0 {
        return Ok(());
    }
    Err(Error::out_of_range("the time step (s)", time_step, FINITE_POSITIVE))
}

/// The serialised form of a system: rows of numbers.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
struct Stored {
    a: Vec<Vec<f64>>,
    b: Vec<Vec<f64>>,
    c: Vec<f64>,
}

#[cfg(feature = "serde")]
impl From<LinearSystem> for Stored {
    fn from(system: LinearSystem) -> Self {
        Stored { a: system.a.to_rows(), b: system.b.to_rows(), c: system.c }
    }
}

#[cfg(feature = "serde")]
impl TryFrom<Stored> for LinearSystem {
    type Error = Error;

    fn try_from(stored: Stored) -> Result<Self, Error> {
        let (a, b) = (Matrix::from_rows(&stored.a)?, Matrix::from_rows(&stored.b)?);
        LinearSystem::new(a, b, stored.c)
    }
}
