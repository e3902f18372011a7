//! The parameters of the interior-point method. "Scaled" means in the units of the scaled program.

/// The step length below which a step is negligible (no unit).
pub(super) const SHORT_STEP: f64 = 1e-3;

/// The number of consecutive negligible steps after which the method gives up.
pub(super) const MAX_SHORT_STEPS: u32 = 3;

/// Where the step of a program with cones is shorter than the first, a step to the centre is taken
/// instead. It aims at the second part of the mean complementarity (no unit).
pub(super) const POOR_STEP: f64 = 0.1;
pub(super) const CENTRING: f64 = 0.5;

/// The fraction of the way to the nearest side that a step may go.
pub(super) const STEP_FRACTION: f64 = 0.995;

/// The complementarity, scaled, below which reducing it gains nothing.
pub(super) const CLOSED_COMPLEMENTARITY: f64 = 1e-9;

/// The tolerance at which a program counts as solved if the method cannot improve it.
pub(super) const COARSE_TOLERANCE: f64 = 1e-8;

/// The gradient of columns without bounds at which a dual value counts as a bound, scaled, and the
/// relative margin that it then needs: proving it costs some of it.
pub(super) const FREE_MARGIN: f64 = 1e-5;

/// The largest number of entries of a cone, whose block of the system is dense.
pub(super) const MAX_CONE_ENTRIES: usize = 300;

/// The margin of a certificate of infeasibility, relative to its terms.
pub(super) const CERTIFICATE_MARGIN: f64 = 1e-8;

/// The smallest initial slack of a row's side, scaled.
pub(super) const MIN_INITIAL_SLACK: f64 = 1.0;

/// A start from the parent's iterate is given up if this number of iterations leaves more than
/// [`MAX_WARM_RESIDUAL`] of its residuals. The child is then far from its parent.
pub(super) const WARM_ITERATIONS: u32 = 3;

/// See [`WARM_ITERATIONS`] (no unit).
pub(super) const MAX_WARM_RESIDUAL: f64 = 0.7;

/// A start is replaced if the method gives up within this number of iterations.
pub(super) const EARLY_ITERATIONS: u64 = 6;

/// The complementarity, scaled, down to which an iterate is kept for the children. The first
/// iterate has 1.
pub(super) const MIN_KEPT_COMPLEMENTARITY: f64 = 1e-3;

/// The smallest complementarity of a side at a warm start, scaled.
pub(super) const MIN_START_COMPLEMENTARITY: f64 = 1e-2;

/// The smallest distance of a warm start from bounds and from limits of inequalities, scaled.
pub(super) const MIN_START_DISTANCE: f64 = 0.1;

/// The largest number of refinement steps of a direction.
pub(super) const MAX_REFINEMENTS: usize = 2;

/// The same for the predictor, which determines centring and the second-order correction.
pub(super) const MAX_PREDICTOR_REFINEMENTS: usize = 1;

/// The residual of a direction, scaled, at which refinement stops.
pub(super) const RESIDUAL_TOLERANCE: f64 = 1e-11;

/// The same as a fraction of the mean complementarity: the next step removes the rest.
pub(super) const RESIDUAL_FRACTION: f64 = 1e-5;

/// The same for programs with cones, as a part of that fraction.
pub(super) const CONE_ACCURACY: f64 = 1e-3;

/// The number that is added to the diagonal of columns and subtracted from that of rows; refinement
/// removes its effect. With 1e-10 for rows, many relaxations of pendulums break down near their
/// optimum.
pub(super) const REGULARISATION: f64 = 1e-8;

/// The same for the entries of cones, whose own block is definite.
pub(super) const CONE_REGULARISATION: f64 = 1e-10;

/// Rows with at most this many entries are always condensed.
pub(super) const MAX_SHORT_TERMS: usize = 12;

/// The operations per entry of the factors, in units of 40, from which factors are computed in
/// dense blocks.
pub(super) const SUPERNODAL_RATIO: f64 = 0.25;

/// The operations a second (a multiplication and an addition) that are assumed until a large
/// factorisation is measured.
pub(super) const ASSUMED_RATE: f64 = 1e10;

/// The operations from which a factorisation is large: some tens of milliseconds.
pub(super) const LARGE_FACTORISATION: f64 = 1e8;

/// The number of systems whose symbolic factors are kept.
pub(super) const MAX_KEPT_SYSTEMS: usize = 6;

/// The number of elimination orders that are kept.
pub(super) const MAX_KEPT_ORDERS: usize = 6;

/// A kept order is used while at least this part of its unknowns is left: smaller systems have
/// better orders of their own.
pub(super) const MIN_REUSED_PART: f64 = 0.75;

/// A kept order is used if it leaves at most this many times its own fill.
pub(super) const MAX_FILL_RATIO: f64 = 1.1;

/// The largest number of unknowns that a kept order may lack. They are eliminated last.
pub(super) const MAX_EXTRA_UNKNOWNS: usize = 4;

/// The largest number of vectors, and of states, whose memory is kept.
pub(super) const MAX_KEPT_RESULTS: usize = 16;
