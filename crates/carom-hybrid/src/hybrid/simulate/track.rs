//! Inputs that keep a run at its plan.
//!
//! The differences between a run and its plan follow the plan's transitions, and a linear-quadratic
//! regulator over the horizon keeps them small: a Riccati recursion backward (B. D. O. Anderson, J.
//! B. Moore, "Optimal Control: Linear Quadratic Methods", 1990, section 2.4, with an affine part),
//! and the run itself forward. So states are functions of the inputs that are applied, however
//! unstable the system is.

use faer::Mat;
use faer::linalg::solvers::Solve;

use super::certify::MISS;
use super::digits::Digits;
use super::open_run::{MANY_PARTS, differences, exact, lead};
use super::plan::PlannedRun;
use crate::interval::Interval;
use crate::tolerance::margin_scale;

/// The difference from the plan that costs as much as an input's whole freedom, relative to the
/// drift that is allowed (no unit).
const CLOSENESS: f64 = 0.1;

/// The least freedom of an input, relative to the width of its range (no unit): at an end of it,
/// there is hardly any.
const LEAST_FREEDOM: f64 = 1e-9;

/// The feedback of a step: `δu = gain . e + shift`.
pub(super) struct StepFeedback {
    pub(super) gain: Mat<f64>,
    shift: Vec<f64>,
}

/// Inputs and the samples to which they lead from the start.
pub(super) struct TrackedRun {
    pub(super) inputs: Vec<Vec<f64>>,
    pub(super) states: Vec<Vec<f64>>,
}

/// How much each input may differ from the plan's.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Freedom {
    /// As far as the nearer end of its range: inputs at an end stay there.
    ToNearerEnd,
    /// As far as its range is wide: inputs at an end may leave it inward.
    WholeRange,
}

impl PlannedRun<'_> {
    /// The ranges of the inputs in a step.
    pub(super) fn input_ranges(&self, step: usize) -> Vec<Interval> {
        let taken = self.transitions(step);
        let inputs = 0..self.system.inputs.len();
        inputs.map(|u| self.system.input_range_of(&taken, u, step)).collect()
    }

    /// The inputs of the plan, each within its range if it misses that by a tolerance only.
    pub(super) fn inputs_within(&self) -> Vec<Vec<f64>> {
        let nearest = |(&u, range): (&f64, Interval)| {
            let nearest = range.nearest(u);
            let is_small = (u - nearest).abs() <= MISS * margin_scale(u.abs(), 0.0);
            if is_small { nearest } else { u }
        };
        let of = |(step, input): (usize, &Vec<f64>)| {
            input.iter().zip(self.input_ranges(step)).map(nearest).collect()
        };
        self.inputs.iter().enumerate().map(of).collect()
    }

    /// A run from a start whose inputs differ from the plan's as far as that keeps its states near
    /// to the plan's. `None` if numbers leave the range of floats.
    pub(super) fn tracked(&self, start: &[f64], freedom: Freedom) -> Option<TrackedRun> {
        let ranges: Vec<Vec<Interval>> =
            (0..self.inputs.len()).map(|step| self.input_ranges(step)).collect();
        let planned = self.inputs_within();
        let close = |sample: usize| -> Vec<f64> {
            self.allowed_drifts(sample).iter().map(|allowed| CLOSENESS * allowed).collect()
        };
        let feedbacks = self.feedbacks(&planned, &ranges, freedom, &close)?;
        let mut run = TrackedRun { inputs: Vec::new(), states: vec![start.to_vec()] };
        let mut state: Vec<Digits> = exact(start);
        for (step, feedback) in feedbacks.iter().enumerate() {
            let off = differences(&state, &self.states[step]);
            let input = |(u, range): (usize, &Interval)| {
                let by: f64 = off.iter().enumerate().map(|(i, e)| feedback.gain[(u, i)] * e).sum();
                range.nearest(planned[step][u] + by + feedback.shift[u])
            };
            let input: Vec<f64> = ranges[step].iter().enumerate().map(input).collect();
            if !input.iter().all(|u| u.is_finite()) {
                return None;
            }
            state = match self.system.is_nonlinear() {
                true => exact(&self.led(step, &run.states[step], &input)),
                false => {
                    let taken = self.transitions(step);
                    lead(self.system, &taken, step, &state, &input, MANY_PARTS)
                }
            };
            let values: Vec<f64> = state.iter().map(Digits::value).collect();
            if !values.iter().all(|x| x.is_finite()) {
                return None;
            }
            run.inputs.push(input);
            run.states.push(values);
        }
        Some(run)
    }

    /// The feedbacks of all steps. The difference from the plan is `e⁺ = A e + B δu + r`, where r
    /// is what the plan misses, and the cost of being off is `e'We + δu'R δu` in each step.
    ///
    /// # Arguments
    ///
    /// * `close`: by sample, the difference of each state that costs as much as an input's whole
    ///   freedom.
    pub(super) fn feedbacks(
        &self,
        planned: &[Vec<f64>],
        ranges: &[Vec<Interval>],
        freedom: Freedom,
        close: &dyn Fn(usize) -> Vec<f64>,
    ) -> Option<Vec<StepFeedback>> {
        let (n, m) = (self.system.states.len(), self.system.inputs.len());
        if m == 0 {
            let none = || StepFeedback { gain: Mat::zeros(0, n), shift: Vec::new() };
            return Some(planned.iter().map(|_| none()).collect());
        }
        let residuals = self.residuals(planned);
        let weight = |sample: usize| {
            let close = close(sample);
            let entry = |i: usize, j: usize| if i == j { close[i].powi(-2) } else { 0.0 };
            Mat::from_fn(n, n, entry)
        };
        let mut cost = weight(planned.len());
        let mut slope = Mat::<f64>::zeros(n, 1);
        let mut feedbacks = Vec::with_capacity(planned.len());
        for step in (0..planned.len()).rev() {
            let maps = self.maps(step);
            let a = Mat::from_fn(n, n, |i, j| maps[i].factors[j]);
            let b = Mat::from_fn(n, m, |i, j| maps[i].factors[n + j]);
            let r = Mat::from_fn(n, 1, |i, _| residuals[step][i]);
            let price = |u: usize| {
                let (range, value) = (ranges[step][u], planned[step][u]);
                let width = range.upper - range.lower;
                let width = if width.is_finite() { width } else { value.abs().max(1.0) };
                let nearer = (value - range.lower).min(range.upper - value).min(width);
                let free = match freedom {
                    Freedom::ToNearerEnd => nearer,
                    Freedom::WholeRange => width,
                };
                free.max(LEAST_FREEDOM * width).max(f64::EPSILON * value.abs().max(1.0)).powi(-2)
            };
            let prices = Mat::from_fn(m, m, |i, j| if i == j { price(i) } else { 0.0 });
            // The cost to go is `e'P e + 2 p'e`.
            let after = &cost * &r + &slope;
            let inner = (&prices + b.transpose() * &cost * &b).partial_piv_lu();
            let gain = inner.solve(&(b.transpose() * &cost * &a));
            let shift = inner.solve(&(b.transpose() * &after));
            let closed = &a - &b * &gain;
            // The symmetric form (Joseph's) stays positive.
            let next = weight(step)
                + closed.transpose() * &cost * &closed
                + gain.transpose() * &prices * &gain;
            slope = closed.transpose() * &after;
            cost = Mat::from_fn(n, n, |i, j| 0.5 * (next[(i, j)] + next[(j, i)]));
            feedbacks.push(StepFeedback {
                gain: Mat::from_fn(m, n, |i, j| -gain[(i, j)]),
                shift: (0..m).map(|u| -shift[(u, 0)]).collect(),
            });
            if !(0..n).all(|i| cost[(i, i)].is_finite()) {
                return None;
            }
        }
        feedbacks.reverse();
        Some(feedbacks)
    }
}
