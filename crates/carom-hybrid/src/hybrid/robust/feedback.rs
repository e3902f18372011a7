//! Feedbacks that keep disturbed runs near a plan, and the directions in which errors are measured.

use faer::Mat;
use faer::linalg::solvers::Solve;

use crate::error::{Error, ErrorKind, check_finite};
use crate::hybrid::linear::LinearSystem;
use crate::hybrid::matrix::Matrix;
use crate::hybrid::step::{self, AffineForm};
use crate::hybrid::system::{Coordinates, HybridSystem, Restated, Transition, Uncertain};
use crate::hybrid::terminal::Lqr;

/// Weights of the inputs, relative to those of the states, of the regulators that are tried.
const WEIGHTS: [f64; 13] =
    [1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0];

/// Over how many steps tubes are compared.
const STEPS: usize = 40;

/// Eigenvalues nearer to each other than this count as equal.
const EIGENVALUE_GAP: f64 = 1e-4;

/// The largest entry of a basis of directions and of its inverse.
const CONDITION: f64 = 1e4;

/// A feedback `u = v + K (x - z)` around a plan with the states z and the inputs v. It acts on the
/// measured state at the start of each step.
///
/// ```
/// use carom::hybrid::Feedback;
/// use carom::prelude::*;
///
/// let mut cart = HybridSystem::new(0.25); // s
/// let x = cart.state("x", 0.0, 9.0)?; // m
/// let v = cart.state("v", -2.0, 2.0)?; // m/s
/// let a = cart.input("a", -1.0, 1.0)?; // m/s²
/// cart.disturbance(v, -0.02, 0.02)?;
/// cart.mode("roll")?.rates([x.is(v), v.is(a)])?;
/// let feedback = Feedback::regulator(&cart)?;
/// assert!(feedback.gain()[(0, 0)] < 0.0 && feedback.gain()[(0, 1)] < 0.0);
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Feedback {
    gain: Matrix,
    /// T: errors are `T e`, and a tube holds the box of e at each sample.
    pub(super) shape: Mat<f64>,
    /// The inverse of T, up to rounding.
    pub(super) inverse: Mat<f64>,
}

impl Feedback {
    /// The feedback with a gain.
    ///
    /// # Arguments
    ///
    /// * `gain`: K, a row for each input and a column for each state, in the order of their
    ///   declaration.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Shape`], [`ErrorKind::NotFinite`]; those of [`HybridSystem::check`].
    pub fn new(system: &HybridSystem, gain: impl Into<Matrix>) -> Result<Self, Error> {
        system.check()?;
        system.check_is_linear("a feedback for robust plans")?;
        let gain = gain.into();
        let (n, m) = (system.states.len(), system.inputs.len());
        // An array without rows cannot say how many columns it has.
        let gain = if m == 0 && gain.nrows() == 0 { Matrix::zeros(0, n) } else { gain };
        if (gain.nrows(), gain.ncols()) != (m, n) {
            return Err(ErrorKind::Shape {
                what: "the gain of a feedback",
                rows: gain.nrows(),
                columns: gain.ncols(),
                expected: format!("{m}x{n}, a row for each input and a column for each state"),
            }
            .into());
        }
        let index = (0..m).flat_map(|i| (0..n).map(move |j| (i, j)));
        check_finite("the gain of a feedback", "an entry", index.map(|index| gain[index]))?;
        let Restated { system: own, coordinates } = system.restated()?;
        let identity = || Mat::identity(n, n);
        let given = Feedback { gain, shape: identity(), inverse: identity() };
        let gain = given.restated(&coordinates).gain;
        Ok(Feedback::shaped(&own, &gain).0.restated(&coordinates.inverse()))
    }

    /// The same feedback for a system in coordinates.
    pub(super) fn restated(&self, coordinates: &Coordinates) -> Self {
        if coordinates.is_plain() {
            return self.clone();
        }
        let (n, m) = (self.gain.ncols(), self.gain.nrows());
        let (of_state, of_input) =
            (|i: usize| coordinates.state(i).scale, |u: usize| coordinates.input(u).scale);
        Feedback {
            gain: Matrix::from_fn(m, n, |u, i| self.gain[(u, i)] * of_state(i) / of_input(u)),
            shape: Mat::from_fn(n, n, |i, k| self.shape[(i, k)] / of_state(i)),
            inverse: Mat::from_fn(n, n, |k, i| self.inverse[(k, i)] * of_state(i)),
        }
    }

    /// No feedback: the inputs are those of the plan, whatever happens.
    ///
    /// # Errors
    ///
    /// Those of [`HybridSystem::check`].
    pub fn none(system: &HybridSystem) -> Result<Self, Error> {
        Feedback::new(system, Matrix::zeros(system.inputs.len(), system.states.len()))
    }

    /// The linear-quadratic regulator whose tube takes the least of the limits, or no feedback if
    /// that takes less: states and inputs are weighted by their ranges, inputs by more or less. The
    /// regulators are those of the common flow, or of the first transition if there is none. Where
    /// a goal is much narrower than the domains, a gain of your own may leave more room in it.
    ///
    /// # Errors
    ///
    /// Those of [`HybridSystem::check`].
    pub fn regulator(system: &HybridSystem) -> Result<Self, Error> {
        system.check()?;
        system.check_is_linear("a feedback for robust plans")?;
        let Restated { system, coordinates } = &system.restated()?;
        let (n, m) = (system.states.len(), system.inputs.len());
        let half = |width: f64| (0.5 * width).clamp(1e-6, 1e6);
        let states: Vec<f64> = system.states.iter().map(|(_, range)| half(range.width())).collect();
        let inputs = (0..m).map(|u| half(system.input_ranges(u, 0).map(|r| r.width()).sum()));
        let inputs: Vec<f64> = inputs.collect();
        let weight = |halves: &[f64], factor: f64| {
            let size = halves.len();
            let entry = |i: usize, j: usize| if i == j { factor / halves[i].powi(2) } else { 0.0 };
            Mat::from_fn(size, size, entry)
        };
        let mut best = Feedback::shaped(system, &Matrix::zeros(m, n));
        let Some(flow) = common_flow(system) else {
            return Ok(best.0.restated(&coordinates.inverse()));
        };
        for factor in WEIGHTS {
            // A flow that no regulator stabilises keeps the plan's inputs.
            let Ok(lqr) = Lqr::new(flow, weight(&states, 1.0), weight(&inputs, factor)) else {
                continue;
            };
            // An input that takes some values only cannot be corrected.
            let entry = |u: usize, i: usize| match system.values_of_input(u) {
                Some(_) => 0.0,
                None => lqr.gain[(u, i)],
            };
            let own = Feedback::shaped(system, &Matrix::from(Mat::from_fn(m, n, entry)));
            if own.1 < best.1 {
                best = own;
            }
        }
        Ok(best.0.restated(&coordinates.inverse()))
    }

    /// K, a row for each input and a column for each state.
    pub fn gain(&self) -> &Matrix {
        &self.gain
    }

    /// A gain with the directions in which its tube is the smallest, and the share of the limits
    /// that it takes.
    fn shaped(system: &HybridSystem, gain: &Matrix) -> (Self, f64) {
        let n = system.states.len();
        let identity = || Mat::identity(n, n);
        let plain = Feedback { gain: gain.clone(), shape: identity(), inverse: identity() };
        let share = plain.share(system);
        let Some(flow) = common_flow(system) else { return (plain, share) };
        let closed = flow.a().faer() + flow.b().faer() * gain.faer();
        let Some(shape) = directions(&closed) else { return (plain, share) };
        let inverse = shape.partial_piv_lu().solve(identity());
        let modal = Feedback { gain: gain.clone(), shape, inverse };
        let own = modal.share(system);
        if own < share { (modal, own) } else { (plain, share) }
    }

    /// An affine map of states and inputs, as factors of the error e.
    pub(super) fn closed(&self, map: &AffineForm) -> Vec<f64> {
        let n = self.shape.nrows();
        let (of_states, of_inputs) = map.factors.split_at(n);
        let by_state = |i: usize| {
            let fed = of_inputs.iter().enumerate().map(|(u, f)| f * self.gain[(u, i)]);
            of_states[i] + fed.sum::<f64>()
        };
        let factors: Vec<f64> = (0..n).map(by_state).collect();
        let by_error = |k: usize| (0..n).map(|i| factors[i] * self.shape[(i, k)]).sum();
        (0..n).map(by_error).collect()
    }

    /// Maps of the next state as maps of the next error e.
    pub(super) fn errors(&self, maps: &[AffineForm], width: usize) -> Vec<AffineForm> {
        let row = |k: usize| {
            let factors = (0..maps.len()).map(|i| self.inverse[(k, i)]);
            step::combine(factors, maps, width, 0.0)
        };
        (0..maps.len()).map(row).collect()
    }

    /// The largest magnitude of each entry of e that one disturbance adds.
    pub(super) fn spread(&self, disturbance: &[f64]) -> Vec<f64> {
        let row = |k: usize| {
            let terms = disturbance.iter().enumerate();
            terms.map(|(i, w)| self.inverse[(k, i)].abs() * w).sum()
        };
        (0..self.inverse.nrows()).map(row).collect()
    }

    /// The largest share of a range that the tube takes, of states and of inputs, after many steps
    /// without events and then one of them.
    fn share(&self, system: &HybridSystem) -> f64 {
        let (n, m) = (system.states.len(), system.inputs.len());
        let Some(flow) = common_flow(system) else { return f64::INFINITY };
        let mut by = disturbance(system);
        if by.iter().all(|w| *w == 0.0) {
            by = system.states.iter().map(|(_, range)| 0.005 * range.width()).collect();
        }
        let by = self.spread(&by);
        let next = self.errors(&step::flow(flow), n + m);
        let next: Vec<Vec<f64>> = next.iter().map(|map| self.closed(map)).collect();
        let size = |factors: &[f64], radius: &[f64]| -> f64 {
            factors.iter().zip(radius).map(|(a, r)| a.abs() * r).sum()
        };
        let grown = |radius: &[f64]| -> Vec<f64> {
            next.iter().zip(&by).map(|(row, w)| size(row, radius) + w).collect()
        };
        let unit = |k: usize| {
            let factors = (0..n + m).map(|i| if i == k { 1.0 } else { 0.0 }).collect();
            self.closed(&AffineForm { factors, constant: 0.0 })
        };
        let ranges = system.states.iter().map(|(_, range)| range.width());
        let inputs = (0..m).map(|u| system.input_ranges(u, 0).map(|r| r.width()).sum());
        let widths: Vec<f64> = ranges.chain(inputs).collect();
        let units: Vec<Vec<f64>> = (0..n + m).map(unit).collect();
        let largest_share = |radius: &[f64], range: std::ops::Range<usize>| {
            let share = |k: usize| 2.0 * size(&units[k], radius) / widths[k].max(1e-9);
            range.map(share).fold(0.0, f64::max)
        };
        let mut radius = vec![0.0; n];
        for _ in 0..STEPS {
            radius = grown(&radius);
        }
        // One event on top of it.
        let event = self.spread(&event(system));
        radius.iter_mut().zip(event).for_each(|(radius, by)| *radius += by);
        let mut share = 0.0_f64;
        for _ in 0..STEPS {
            share = share.max(largest_share(&radius, 0..n) + largest_share(&radius, n..n + m));
            radius = grown(&radius);
        }
        share
    }
}

/// The largest magnitude of the disturbance of each state.
pub(super) fn disturbance(system: &HybridSystem) -> Vec<f64> {
    let of = |i: usize| system.disturbance.get(i).map_or(0.0, |range| range.magnitude());
    (0..system.states.len()).map(of).collect()
}

/// The most that the uncertain parameters of an event may add to each state, of a typical size: for
/// states at a quarter of the width of their domains.
fn event(system: &HybridSystem) -> Vec<f64> {
    let typical: Vec<f64> = system.states.iter().map(|(_, domain)| 0.25 * domain.width()).collect();
    let mut most = vec![0.0_f64; typical.len()];
    for own in system.transitions() {
        for (i, most) in most.iter_mut().enumerate() {
            let of = |parameter: &Uncertain| -> f64 {
                let terms = typical.iter().enumerate();
                let by_states: f64 =
                    terms.map(|(j, x)| parameter.effect.matrix[(i, j)].abs() * x).sum();
                let offset = parameter.effect.offset.get(0).and_then(|offset| offset.get(i));
                // A constant is what the states are compared with, unless it stands alone.
                let size =
                    if by_states == 0.0 { offset.map_or(0.0, |m| m.abs()) } else { by_states };
                parameter.range.magnitude() * size
            };
            *most = most.max(own.uncertain.iter().map(of).sum());
        }
    }
    most
}

/// The flow of steps without events.
pub(super) fn common_flow(system: &HybridSystem) -> Option<&LinearSystem> {
    let first = || system.transitions().next().map(|first: &Transition| &first.flow);
    system.flow.as_ref().or_else(first)
}

/// The directions along which a matrix scales, in blocks of states that depend on each other;
/// `None` if a block turns.
fn directions(matrix: &Mat<f64>) -> Option<Mat<f64>> {
    let n = matrix.nrows();
    let mut block: Vec<usize> = (0..n).collect();
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        if matrix[(i, j)] != 0.0 {
            let (from, to) = (block[i], block[j]);
            block.iter_mut().filter(|b| **b == from).for_each(|b| *b = to);
        }
    }
    let mut shape = Mat::<f64>::zeros(n, n);
    for first in 0..n {
        let members: Vec<usize> = (0..n).filter(|&i| block[i] == block[first]).collect();
        if members[0] != first {
            continue;
        }
        let size = members.len();
        let own = Mat::from_fn(size, size, |i, j| matrix[(members[i], members[j])]);
        let values = own.eigenvalues().ok()?;
        let mut values: Vec<f64> =
            values.iter().map(|v| (v.im == 0.0).then_some(v.re)).collect::<Option<_>>()?;
        values.sort_by(f64::total_cmp);
        if values.windows(2).any(|pair| pair[1] - pair[0] < EIGENVALUE_GAP) {
            return None;
        }
        for (k, value) in values.iter().enumerate() {
            let shift = value + 1e-9 * (1.0 + value.abs());
            let shifted = &own - Mat::<f64>::identity(size, size) * faer::Scale(shift);
            let solver = shifted.partial_piv_lu();
            let mut vector = Mat::from_fn(size, 1, |i, _| 1.0 + 0.1 * i as f64);
            for _ in 0..3 {
                vector = solver.solve(&vector);
                let most = (0..size).map(|i| vector[(i, 0)].abs()).fold(0.0, f64::max);
                vector = Mat::from_fn(size, 1, |i, _| vector[(i, 0)] / most);
            }
            (0..size).for_each(|i| shape[(members[i], members[k])] = vector[(i, 0)]);
        }
    }
    let inverse = shape.partial_piv_lu().solve(Mat::<f64>::identity(n, n));
    let index = || (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let is_fit = |own: &Mat<f64>| index().all(|at| own[at].abs() <= CONDITION);
    (is_fit(&shape) && is_fit(&inverse)).then_some(shape)
}
