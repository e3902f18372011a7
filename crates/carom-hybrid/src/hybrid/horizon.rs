//! The planning horizon: number and length of steps.

use super::linear::check_time_step;
use crate::error::Error;
use crate::tolerance;

/// A horizon of `steps` steps of `time_step` seconds: samples `t = 0, 1, ..., steps`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Horizon {
    steps: usize,
    time_step: f64,
}

impl Horizon {
    /// A checked horizon: from 1 to [`tolerance::MAX_STEPS`] steps of a finite and positive length
    /// in s.
    pub(crate) fn new(steps: usize, time_step: f64) -> Result<Self, Error> {
        check_steps("the number of steps", steps)?;
        check_time_step(time_step)?;
        Ok(Horizon { steps, time_step })
    }

    /// Number of steps, τ.
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// Length of a step, Δt, in s.
    pub(crate) fn time_step(&self) -> f64 {
        self.time_step
    }
}

/// Refuses step counts outside `1..=MAX_STEPS`.
pub(super) fn check_steps(what: &str, steps: usize) -> Result<(), Error> {
    if (1..=tolerance::MAX_STEPS).contains(&steps) {
        return Ok(());
    }
    let most = tolerance::MAX_STEPS as f64;
    Err(Error::out_of_range_in_words(what, steps as f64, 1.0..=most, format!("from 1 to {most}")))
}
