//! Bounds of rounding errors, for sets that must never be too small.

/// Twice the relative rounding error of one operation (no unit).
pub(super) const EPSILON: f64 = f64::EPSILON;
