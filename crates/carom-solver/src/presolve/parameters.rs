//! Parameters that several algorithms of presolve share. Those of one algorithm are listed in its
//! file.

/// Bounds or limits that are crossed by more than this, relative to their magnitude (at least 1),
/// prove that no point exists. Presolve leaves fewer digits than a single operation does.
pub(super) const CONTRADICTION: f64 = 1e-8;

/// A bound or a limit that holds already up to this margin, in its unit, counts as implied.
pub(super) const IMPLIED: f64 = 1e-9;

/// The largest number up to which all whole numbers are floats.
pub(super) const LARGEST_WHOLE: f64 = 9_007_199_254_740_992.0;

/// The rounding of a few operations (no unit).
pub(super) const FEW_ROUNDINGS: f64 = 8.0 * f64::EPSILON;
