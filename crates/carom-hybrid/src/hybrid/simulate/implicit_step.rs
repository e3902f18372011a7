//! Steps of implicit methods: the next state is a solution of an equation in it.

use std::borrow::Cow;

use faer::Mat;
use faer::linalg::solvers::Solve;

use super::step::StepStart;
use crate::error::Error;
use crate::hybrid::linear::LinearSystem;
use crate::hybrid::system::HybridSystem;

/// The most steps of Newton's method.
const MOST_CORRECTIONS: usize = 50;

/// The relative step of a difference quotient (no unit).
const NEWTON_DIFFERENCE: f64 = 1e-7;

/// The relative change at which Newton's method ends (no unit).
const CONVERGED: f64 = 4.0 * f64::EPSILON;

impl StepStart<'_> {
    /// The input with the values of functions that depend on where a flow leads.
    pub(super) fn input_under(&self, flow: &LinearSystem) -> Result<Cow<'_, [f64]>, Error> {
        if !self.system.functions.use_predictions() {
            return Ok(Cow::Borrowed(self.input));
        }
        let prediction = self.solved(flow)?;
        Ok(Cow::Owned(self.system.with_function_values(self.state, &prediction, self.input)))
    }

    /// The state `y` that equals where the flow leads if its functions are those of `y`, by
    /// Newton's method from the guess; NaN if it has found none.
    fn solved(&self, flow: &LinearSystem) -> Result<Vec<f64>, Error> {
        let lead = |y: &[f64]| {
            flow.step(self.state, &self.system.with_function_values(self.state, y, self.input))
        };
        let n = self.state.len();
        let mut y = self.guess.to_vec();
        for _ in 0..MOST_CORRECTIONS {
            let to = lead(&y)?;
            let mut jacobian = Mat::<f64>::identity(n, n);
            for j in 0..n {
                let (own, by) = (y[j], NEWTON_DIFFERENCE * y[j].abs().max(1.0));
                y[j] = own + by;
                let moved = lead(&y)?;
                y[j] = own;
                (0..n).for_each(|i| jacobian[(i, j)] -= (moved[i] - to[i]) / by);
            }
            let off = Mat::from_fn(n, 1, |i, _| to[i] - y[i]);
            let change = jacobian.partial_piv_lu().solve(&off);
            y.iter_mut().enumerate().for_each(|(i, own)| *own += change[(i, 0)]);
            let is_small =
                |(i, own): (usize, &f64)| change[(i, 0)].abs() <= CONVERGED * own.abs().max(1.0);
            if y.iter().enumerate().all(is_small) {
                return Ok(y);
            }
        }
        // Newton's method may end at the rounding of the functions.
        let to = lead(&y)?;
        let is_near = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-12 * a.abs().max(1.0);
        Ok(if y.iter().zip(&to).all(is_near) { y } else { vec![f64::NAN; n] })
    }
}

impl HybridSystem {
    /// An input with places for the values of functions, of which callers know nothing.
    pub(crate) fn with_places(&self, input: &[f64]) -> Vec<f64> {
        if input.len() == self.inputs.len() || !self.is_nonlinear() {
            return input.to_vec();
        }
        let mut own = input.iter().copied();
        let mut all = Vec::with_capacity(self.inputs.len());
        for number in 0..self.inputs.len() {
            match self.functions.is_function(number) {
                true => all.push(0.0),
                false => all.extend(own.next()),
            }
        }
        // Too many are refused.
        all.extend(own);
        all
    }
}
