//! The parameters of the dual simplex method. "Scaled" means in the units of the scaled program.

/// The method solves objectives with more than one term in this many columns.
pub(super) const COLUMNS_PER_COST: usize = 50;

/// The largest violation of a bound, scaled and relative to the bound.
pub(super) const PRIMAL_TOLERANCE: f64 = 1e-9;

/// The largest amount by which a reduced cost may have the wrong sign, scaled.
pub(super) const DUAL_TOLERANCE: f64 = 1e-9;

/// The smallest entry of a pivot row that does not count as zero, scaled.
pub(super) const MIN_ENTRY: f64 = 1e-9;

/// The smallest pivot of an exchange, scaled.
pub(super) const MIN_PIVOT: f64 = 1e-7;

/// The largest difference between the two computations of a pivot, relative.
pub(super) const MAX_PIVOT_DIFFERENCE: f64 = 1e-6;

/// The smallest pivot of a factorisation, scaled.
pub(super) const MIN_FACTOR_PIVOT: f64 = 1e-9;

/// The number of exchanges after which the basis is factorised again.
pub(super) const MAX_EXCHANGES: usize = 50;
