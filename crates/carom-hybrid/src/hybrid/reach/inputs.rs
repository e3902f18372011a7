//! The ranges that guards leave to the inputs.

use super::rounding::EPSILON;
use super::shape::Shape;
use crate::activity;
use crate::interval::Interval;

/// Number of rounds in which guards tighten inputs.
const ROUNDS: usize = 2;

/// A guard on inputs, margin included.
#[derive(Debug, Clone)]
pub(super) struct Joint {
    pub(super) name: String,
    /// The block whose states it depends on, if there is one.
    pub(super) block: Option<usize>,
    /// The coefficients of the block's states.
    pub(super) normal: Vec<f64>,
    /// The coefficients of all inputs.
    pub(super) gains: Vec<f64>,
    pub(super) limit: f64,
    /// The original limit, for reports.
    pub(super) given: f64,
}

/// The smallest value of `gains . u`, without input `without`, rounded down.
pub(super) fn least(gains: &[f64], inputs: &[Interval], without: Option<usize>) -> f64 {
    let terms = gains.iter().copied().zip(inputs.iter().copied()).enumerate();
    let terms = terms.filter(|(j, _)| Some(*j) != without).map(|(_, term)| term);
    activity::range(0.0, terms).lower
}

/// The ranges of the inputs that the guards leave, for states in a product of sets; or the number
/// of a guard that leaves none, and the smallest value of its left side.
pub(super) fn tightened(
    mut inputs: Vec<Interval>,
    joint: &[Joint],
    states: &[&Shape],
) -> Result<Vec<Interval>, (usize, f64)> {
    let lowest = |guard: &Joint| match guard.block {
        Some(block) => states[block].lowest(&guard.normal),
        None => 0.0,
    };
    let lowest: Vec<f64> = joint.iter().map(lowest).collect();
    for _ in 0..ROUNDS {
        for (k, guard) in joint.iter().enumerate() {
            let nearest = lowest[k] + least(&guard.gains, &inputs, None);
            let noise = |size: f64| 16.0 * EPSILON * (size + guard.limit.abs() + lowest[k].abs());
            let size = inputs.iter().zip(&guard.gains).map(|(r, m)| (m * r.magnitude()).abs());
            let noise = noise(size.sum());
            if nearest > guard.limit + noise {
                return Err((k, nearest));
            }
            for (j, &gain) in guard.gains.iter().enumerate().filter(|(_, gain)| **gain != 0.0) {
                let rest = guard.limit - lowest[k] - least(&guard.gains, &inputs, Some(j)) + noise;
                let end = rest / gain;
                let end = if gain > 0.0 { end.next_up() } else { end.next_down() };
                if end.is_finite() {
                    let range = &mut inputs[j];
                    match gain > 0.0 {
                        true => range.upper = range.upper.min(end).max(range.lower),
                        false => range.lower = range.lower.max(end).min(range.upper),
                    }
                }
            }
        }
    }
    Ok(inputs)
}
