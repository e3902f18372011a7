//! Tolerances that follow from the magnitudes of what is judged.

use std::borrow::Borrow;

use super::{ABSOLUTE_GAP, DRIFT, RELATIVE_GAP, REPLAY, ROUNDING};

/// Rows, and bounds of variables, whose terms are all smaller than this within the bounds of the
/// variables, are satisfied up to [`FEASIBILITY`](super::FEASIBILITY) times their terms, rather
/// than up to [`FEASIBILITY`](super::FEASIBILITY) (in the row's unit).
pub const SMALL_UNIT: f64 = 1e-3;

/// How much an accepted point may violate a row, a bound or a function, in its unit: the absolute
/// tolerance plus the rounding of the point's values. Nothing else is proportional to the terms.
///
/// # Arguments
///
/// * `feasibility`: the absolute tolerance, in the row's unit.
/// * `magnitude`: the sum of `|a_j x_j|` and of the limit's magnitude, in the row's unit; 0 for a
///   row of integers with whole coefficients, which has no rounding.
#[inline]
pub fn allowed_miss(feasibility: f64, magnitude: f64) -> f64 {
    feasibility + ROUNDING * magnitude
}

/// How far a sample of a plan may be from the run of the plan's inputs from its start, in the
/// state's unit: what so many steps may miss if nothing multiplies it, at most [`DRIFT`] of the
/// domain, and at least what one step may miss.
///
/// # Arguments
///
/// * `width`: of the state's domain, in its unit; may be infinite.
/// * `value`: the state in the plan.
/// * `steps`: those of the plan.
#[inline]
pub fn allowed_drift(width: f64, value: f64, steps: usize) -> f64 {
    let step = REPLAY * margin_scale(value.abs(), 0.0);
    (steps as f64 * step).min(DRIFT * width).max(step)
}

/// The magnitude that a relative gap is relative to: that of the objective with or without its
/// constant, whichever is smaller, so that no constant hides a part of the program. At least a
/// hundred millionth of the objective, below which digits end.
///
/// # Arguments
///
/// * `objective`, `constant`: in the objective's unit.
#[inline]
pub fn gap_scale(objective: f64, constant: f64) -> f64 {
    let size = objective.abs();
    size.min((objective - constant).abs()).max(1e-8 * size)
}

/// A gap relative to the objective as [`gap_scale`] has it; below 0.1 relative to 0.1, so that an
/// [`ABSOLUTE_GAP`] is the [`RELATIVE_GAP`] there.
#[inline]
pub fn relative_gap(gap: f64, objective: f64, constant: f64) -> f64 {
    gap / gap_scale(objective, constant).max(ABSOLUTE_GAP / RELATIVE_GAP)
}

/// The factor by which margins that only loosen something grow: one thousandth of the largest
/// magnitude, but at least 1. It is far above `allowed_miss`, so reach sets contain every
/// accepted plan.
///
/// # Arguments
///
/// * `largest_term`: the largest `|a_j x_j|`, in the row's unit.
/// * `limit`: the limit, in the row's unit; infinite limits are ignored.
#[inline]
pub fn margin_scale(largest_term: f64, limit: f64) -> f64 {
    (largest_term.max(finite_size(limit)) * 1e-3).max(1.0)
}

/// The magnitude of a bound or limit; 0 where there is none.
#[inline]
pub fn finite_size(value: f64) -> f64 {
    if value.is_finite() { value.abs() } else { 0.0 }
}

/// The largest magnitude of some numbers; 0 if there are none.
#[inline]
pub fn largest_magnitude<T: Borrow<f64>>(values: impl IntoIterator<Item = T>) -> f64 {
    values.into_iter().fold(0.0, |most: f64, value| most.max(value.borrow().abs()))
}
