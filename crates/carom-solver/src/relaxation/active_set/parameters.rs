//! The parameters of the active-set method.

/// The largest number of columns. Methods that see which entries are zero solve larger programs.
pub(super) const MAX_DENSE_COLUMNS: usize = 150;

/// The smallest pivot of the curvature, as a fraction of its diagonal entry.
pub(super) const MIN_CHOLESKY_PIVOT: f64 = 1e-9;

/// The largest violation of a limit, in units of the row's largest coefficient or of the limit.
pub(super) const MAX_ROW_VIOLATION: f64 = 1e-9;

/// The smallest squared sine of the angle between a vector and the span of others at which it
/// counts as independent of them.
pub(super) const MIN_SQUARED_SINE: f64 = 1e-12;

/// The fraction of the largest multiplier below which a multiplier counts as rounding.
pub(super) const MULTIPLIER_ROUNDING: f64 = 1e-13;
