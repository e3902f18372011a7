//! Bounds of rounding errors, for sets that must never be too small.

/// Twice the relative rounding error of one operation (no unit).
pub(super) const EPSILON: f64 = f64::EPSILON;

/// The largest magnitude of some numbers; 0 when there are none.
pub(super) fn magnitude(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |largest, value| largest.max(value.abs()))
}
