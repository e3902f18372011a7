//! Linear-quadratic regulators: the discrete algebraic Riccati equation.
//!
//! The structure-preserving doubling algorithm squares the number of steps in each iteration
//! (E. K.-W. Chu, H.-Y. Fan, W.-W. Lin, C.-S. Wang, "Structure-preserving algorithms for periodic
//! discrete-time algebraic Riccati equations", International Journal of Control 77(8), 2004). Its
//! result is accepted only with a small residual and a stable closed loop.

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};

use crate::error::{Error, ErrorKind, TerminalError, check_finite};
use crate::hybrid::linear::LinearSystem;
use crate::hybrid::matrix::{Matrix, faer};

/// The most doublings; 60 of them are 2^60 steps.
const DOUBLINGS: usize = 60;

/// The largest accepted residual of the Riccati equation, relative to the cost matrix.
const RESIDUAL: f64 = 1e-8;

/// Singular values below this fraction of the largest count as 0 in the tests of
/// stabilisability and detectability.
const RANK: f64 = 1e-9;

/// Eigenvalues count as decaying below one minus this.
const DECAY: f64 = 1e-9;

/// The linear-quadratic regulator of a linear system: the feedback `u = K x` with the least
/// `Σ x'Qx + u'Ru` over infinitely many steps, and that least cost `x'Px`.
///
/// Around an equilibrium `(x_e, u_e)` of a system with constant part, it is
/// `u = u_e + K (x - x_e)`.
///
/// ```
/// use carom::hybrid::{LinearSystem, Lqr};
///
/// let vehicle = LinearSystem::double_integrator(0.1)?;
/// let lqr = Lqr::new(&vehicle, [[1.0, 0.0], [0.0, 0.1]], [[0.5]])?;
/// assert!(lqr.gain[(0, 0)] < 0.0 && lqr.spectral_radius < 1.0);
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Lqr {
    /// K, m x n.
    pub gain: Matrix,
    /// P, n x n, symmetric and positive semidefinite: the cost to go from `x` is `x'Px`.
    pub cost: Matrix,
    /// The largest magnitude of an eigenvalue of `A + B K`, below 1.
    pub spectral_radius: f64,
    /// The residual of the Riccati equation relative to `P`.
    pub residual: f64,
}

impl Lqr {
    /// Solves the discrete algebraic Riccati equation and verifies the result.
    ///
    /// # Arguments
    ///
    /// * `system`: its constant part is ignored.
    /// * `q`: n x n, symmetric positive semidefinite; `r`: m x m, symmetric positive definite. Both
    ///   in cost per unit of the states or inputs squared, and without a factor 1/2.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Shape`] and [`ErrorKind::NotFinite`]; a [`TerminalError`] for weights that are
    /// not as above, for a system that is not stabilisable, for a cost that does not see a mode
    /// that does not decay, and for a result that fails its verification.
    pub fn new(
        system: &LinearSystem,
        q: impl Into<Matrix>,
        r: impl Into<Matrix>,
    ) -> Result<Self, Error> {
        let (n, m) = (system.states(), system.inputs());
        let (q, r) = (faer(q), faer(r));
        check_weight("the weight Q", &q, n)?;
        // An array without rows cannot say that it has no columns.
        let r = if m == 0 && r.nrows() == 0 { Mat::zeros(0, 0) } else { r };
        check_weight("the weight R", &r, m)?;
        check_definite("Q", &q, false)?;
        check_definite("R", &r, true)?;
        let (a, b) = (system.a().faer(), system.b().faer());
        check_eigenvalues(a, b, &q)?;

        let cost = doubling(a, b, &q, &r).ok_or(TerminalError::NotSolved { residual: f64::NAN })?;
        let gain = gain(a, b, &r, &cost);
        let closed = a + b * &gain;
        // The right side of the equation in its symmetric form (Joseph's).
        let right = &q + closed.transpose() * &cost * &closed + gain.transpose() * &r * &gain;
        let residual = largest(&(&right - &cost)) / largest(&cost).max(f64::MIN_POSITIVE);
        let residual = if largest(&cost) == 0.0 { largest(&right) } else { residual };
        let spectral_radius = spectral_radius(&closed);
        // A comparison with NaN is false.
        if !(residual <= RESIDUAL && spectral_radius < 1.0) {
            return Err(TerminalError::NotSolved { residual }.into());
        }
        Ok(Lqr { gain: gain.into(), cost: cost.into(), spectral_radius, residual })
    }
}

fn check_weight(what: &'static str, weight: &Mat<f64>, size: usize) -> Result<(), Error> {
    let (rows, columns) = (weight.nrows(), weight.ncols());
    if (rows, columns) != (size, size) {
        let expected = format!("{size}x{size}");
        return Err(ErrorKind::Shape { what, rows, columns, expected }.into());
    }
    let index = (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j)));
    check_finite(what, "an entry", index.map(|index| weight[index]))
}

fn check_definite(name: &'static str, weight: &Mat<f64>, strictly: bool) -> Result<(), Error> {
    if weight.nrows() == 0 {
        return Ok(());
    }
    let size = largest(weight);
    if largest(&(weight - weight.transpose())) > 1e-12 * size {
        return Err(TerminalError::NotSymmetric { weight: name }.into());
    }
    let smallest = match weight.self_adjoint_eigenvalues(Side::Lower) {
        Ok(values) => values.into_iter().fold(f64::INFINITY, f64::min),
        Err(_) => f64::NAN,
    };
    let holds = if strictly { smallest > 1e-14 * size } else { smallest >= -1e-12 * size };
    if holds {
        return Ok(());
    }
    Err(TerminalError::Indefinite { weight: name, eigenvalue: smallest }.into())
}

/// The test of Popov, Belevitch and Hautus for each eigenvalue that does not decay.
fn check_eigenvalues(a: &Mat<f64>, b: &Mat<f64>, q: &Mat<f64>) -> Result<(), Error> {
    let Ok(eigenvalues) = a.eigenvalues() else {
        return Err(TerminalError::NotSolved { residual: f64::NAN }.into());
    };
    for value in eigenvalues {
        let magnitude = value.re.hypot(value.im);
        if magnitude < 1.0 - DECAY {
            continue;
        }
        if !has_full_rank(&a.transpose().to_owned(), &b.transpose().to_owned(), value.re, value.im)
        {
            return Err(TerminalError::NotStabilisable { magnitude }.into());
        }
        if !has_full_rank(a, q, value.re, value.im) {
            return Err(TerminalError::NotDetectable { magnitude }.into());
        }
    }
    Ok(())
}

/// Whether the columns of `[A - λI; C]` are independent for `λ = re + i im`, by the singular values
/// of the real matrix of twice the size.
fn has_full_rank(a: &Mat<f64>, c: &Mat<f64>, re: f64, im: f64) -> bool {
    let (n, k) = (a.nrows(), c.nrows());
    // C is scaled to A, because only its rank matters.
    let unit = (largest(a) + re.hypot(im)) / largest(c).max(f64::MIN_POSITIVE);
    let entry = |row: usize, column: usize| {
        let (part, j) = (column / n, column % n);
        let (half, i) = (row / (n + k), row % (n + k));
        match (i < n, half == part) {
            (true, true) => a[(i, j)] - if i == j { re } else { 0.0 },
            (true, false) if i == j => {
                if half == 0 {
                    im
                } else {
                    -im
                }
            }
            (false, true) => unit * c[(i - n, j)],
            _ => 0.0,
        }
    };
    match Mat::from_fn(2 * (n + k), 2 * n, entry).singular_values() {
        Ok(values) => {
            let (low, high) = values
                .iter()
                .fold((f64::INFINITY, 0.0_f64), |(low, high), &s| (low.min(s), high.max(s)));
            low > RANK * high
        }
        Err(_) => false,
    }
}

/// The stabilising solution by doubling; `None` if it does not converge.
fn doubling(a: &Mat<f64>, b: &Mat<f64>, q: &Mat<f64>, r: &Mat<f64>) -> Option<Mat<f64>> {
    let n = a.nrows();
    let identity = Mat::<f64>::identity(n, n);
    let mut step = a.clone();
    let mut inputs = if r.nrows() == 0 {
        Mat::zeros(n, n)
    } else {
        b * r.llt(Side::Lower).ok()?.solve(&b.transpose().to_owned())
    };
    let mut cost = symmetric(q);
    for _ in 0..DOUBLINGS {
        let mixed = (&identity + &inputs * &cost).partial_piv_lu();
        let (moved, spread) = (mixed.solve(&step), mixed.solve(&inputs));
        let gained = step.transpose() * &cost * &moved;
        inputs = symmetric(&(&inputs + &step * spread * step.transpose()));
        cost = symmetric(&(&cost + &gained));
        step = &step * moved;
        let (gained, size) = (largest(&gained), largest(&cost));
        if !gained.is_finite() || !size.is_finite() {
            return None;
        }
        if gained <= 1e-16 * size {
            break;
        }
    }
    Some(cost)
}

/// `-(R + B'PB)^-1 B'PA`.
fn gain(a: &Mat<f64>, b: &Mat<f64>, r: &Mat<f64>, cost: &Mat<f64>) -> Mat<f64> {
    if r.nrows() == 0 {
        return Mat::zeros(0, a.ncols());
    }
    let weight = r + b.transpose() * cost * b;
    let gain = weight.partial_piv_lu().solve(&(b.transpose() * cost * a));
    Mat::from_fn(gain.nrows(), gain.ncols(), |i, j| -gain[(i, j)])
}

fn symmetric(matrix: &Mat<f64>) -> Mat<f64> {
    let entry = |i, j| 0.5 * (matrix[(i, j)] + matrix[(j, i)]);
    Mat::from_fn(matrix.nrows(), matrix.ncols(), entry)
}

/// The largest magnitude of an entry; NaN if there is one.
fn largest(matrix: &Mat<f64>) -> f64 {
    let index = (0..matrix.nrows()).flat_map(|i| (0..matrix.ncols()).map(move |j| (i, j)));
    let larger = |most: f64, x: f64| if x.abs() > most || x.is_nan() { x.abs() } else { most };
    index.map(|index| matrix[index]).fold(0.0, larger)
}

/// The largest magnitude of an eigenvalue; infinite if it is not found.
pub(super) fn spectral_radius(matrix: &Mat<f64>) -> f64 {
    match matrix.eigenvalues() {
        Ok(values) => values.iter().map(|value| value.re.hypot(value.im)).fold(0.0, f64::max),
        Err(_) => f64::INFINITY,
    }
}
