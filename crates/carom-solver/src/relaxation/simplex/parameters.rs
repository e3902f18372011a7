//! The parameters of the simplex methods. "Scaled" means in the units of the scaled program.

/// The dual method solves objectives with more than one term in this many columns.
pub(super) const COLUMNS_PER_COST: usize = 50;

/// The number of columns from which a program is large.
pub(super) const LARGE_PROGRAM: usize = 1000;

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

/// The number of exchanges after which the basis is factorised again, and the number of rows that
/// allow one more.
pub(super) const MAX_UPDATES: usize = 100;
pub(super) const ROWS_PER_UPDATE: usize = 400;

/// The number of exchanges from which long factors are reason enough.
pub(super) const MIN_UPDATES: usize = 20;

/// The least weight of an edge.
pub(super) const MIN_WEIGHT: f64 = 1e-4;

/// The unit of the perturbation of costs, scaled: a cost moves by one to two units, more if it is
/// large.
pub(super) const PERTURBATION: f64 = 5e-7;

/// Costs are perturbed after so many steps of length zero, and more than one in so many.
pub(super) const MIN_IDLE_STEPS: u32 = 50;
pub(super) const IDLE_PART: u32 = 4;
