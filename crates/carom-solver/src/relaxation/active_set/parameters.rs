//! The parameters of the active-set method.

/// The largest number of columns. Methods that see which entries are zero solve larger programs.
pub(super) const MAX_DENSE_COLUMNS: usize = 400;

/// The smallest pivot of the curvature, as a fraction of its diagonal entry.
pub(super) const MIN_CHOLESKY_PIVOT: f64 = 1e-9;

/// The pivot that a column without one gets, as a fraction of a typical diagonal entry: where the
/// point has all digits, and where it is the next one of a sequence, which needs fewer steps if the
/// pull is weak.
pub(super) const PROXIMAL_PIVOT: f64 = 1e-2;
pub(super) const WEAK_PROXIMAL_PIVOT: f64 = 1e-4;

/// The largest negative pivot that counts as rounding, as a fraction of a typical diagonal entry.
pub(super) const MAX_CONCAVITY: f64 = 1e-7;

/// Most steps in a row at which the dual objective does not rise, besides two for each row and
/// column.
pub(super) const MAX_IDLE_STEPS: usize = 30;

/// Most moves of the centre of curvature that was added.
pub(super) const MAX_CENTRES: u32 = 60;

/// The most that the pull towards the centre may take from the objective, relative to it.
pub(super) const LARGEST_PULL: f64 = 1e-10;

/// The largest violation of a limit, in units of the row's largest coefficient or of the limit.
pub(super) const MAX_ROW_VIOLATION: f64 = 1e-9;

/// The smallest squared sine of the angle between a vector and the span of others at which it
/// counts as independent of them.
pub(super) const MIN_SQUARED_SINE: f64 = 1e-12;

/// The fraction of the largest multiplier below which a multiplier counts as rounding.
pub(super) const MULTIPLIER_ROUNDING: f64 = 1e-13;
