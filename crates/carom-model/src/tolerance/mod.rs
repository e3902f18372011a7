//! The tolerances and limits that users and several modules rely on, with units, defaults and
//! ranges.
//!
//! These decide what counts as feasible, integral and optimal, and how closely plans and replays
//! must agree. Constants that belong to a single algorithm, such as the margin of a presolve rule,
//! are declared beside its code. Tolerances that you can change are fields of
//! [`Options`](crate::solver::Options); their defaults are the constants below.

pub(crate) mod derived;

pub(crate) use derived::{
    SMALL_UNIT, allowed_miss, finite_size, gap_scale, largest_magnitude, margin_scale, relative_gap,
};

/// Bounds and right-hand sides of at least this magnitude are treated as infinite (no unit).
///
/// Clarabel and the MPS dialects use 1e20 as well.
pub const INFINITE: f64 = 1e20;

/// Default feasibility tolerance of rows and bounds, in the row's own unit, absolute.
///
/// A point satisfies `l <= a'x <= u` if it violates the row by at most this plus the rounding of
/// its values, [`ROUNDING`] times the sum of its terms' magnitudes. Rows of tiny terms are measured
/// by these: if they are smaller than 1e-3 wherever the variables are within their bounds, by this
/// times their sum. Range `1e-9..=1e-3`.
pub const FEASIBILITY: f64 = 1e-6;

/// Default distance to the nearest integer at which a relaxed value counts as integral
/// (no unit). Range `1e-9..=1e-2`. Accepted plans have their integers rounded exactly; this value
/// only decides which relaxations are tried as candidates.
pub const INTEGRALITY: f64 = 1e-6;

/// Default relative gap `(incumbent - bound) / |incumbent|` at which a search stops (no unit). If
/// the incumbent is smaller without the constant of the objective, that counts.
pub const RELATIVE_GAP: f64 = 1e-6;

/// Default absolute gap `incumbent - bound` at which a search stops, in the objective's unit.
pub const ABSOLUTE_GAP: f64 = 1e-7;

/// Largest distance between the optimal objective and the bound that its multipliers prove,
/// relative to the objective (no unit; an objective below 1 counts as 1).
pub const COMPLEMENTARITY: f64 = 1e-6;

/// Relative width by which a propagated bound of a continuous variable is loosened, so that
/// rounding in the activities can never cut a point off (no unit).
pub const PROPAGATION_SLACK: f64 = 1e-9;

/// A propagated bound on a continuous variable is kept only if it shrinks the domain by at least
/// this fraction (no unit), because long chains of smaller gains cost more than they give.
pub const PROPAGATION_GAIN: f64 = 1e-3;

/// The same for propagation in probing (no unit). With [`PROPAGATION_GAIN`], probing spends most of
/// its time on long chains of small gains, and the trees are hardly smaller.
pub const PROBING_GAIN: f64 = 1e-2;

/// Relative excess over a row's limit at which its activity proves infeasibility (no unit).
pub const PROPAGATION_INFEASIBLE: f64 = 1e-8;

/// Radius within which variables without finite bounds are searched, in the variable's unit.
///
/// A dual bound needs every column's contribution over its domain. If neither bounds, propagation
/// nor curvature limit a variable, dual bounds hold for points with `|x| <= FREE_RADIUS`, or up to
/// four times the relaxation's own point if that is larger.
pub const FREE_RADIUS: f64 = 1e9;

/// The same for proofs of infeasibility, where a point beyond [`FREE_RADIUS`] is a counterexample
/// too. Multipliers are corrected until columns without bounds contribute almost nothing to the
/// proof, so the larger radius does not weaken proofs.
pub const INFEASIBILITY_RADIUS: f64 = 1e15;

/// How far an accepted quadratic objective may be below its tangents within the bounds of the
/// variables, in the objective's unit, beside the rounding of its coefficients. Bounds of
/// relaxations are as far off at most.
pub const CONVEXITY: f64 = 1e-7;

/// Relative difference up to which two slopes of a piecewise-affine function are equal (no unit).
/// The breakpoint between them is dropped.
pub const SLOPE: f64 = 1e-12;

/// Largest difference of a plan's samples from its discrete replay, a step at a time, in SI units
/// (m, m/s). This and the other tolerances of systems and scenes are in the unit of the domains
/// where these are not of an ordinary size (some 0.02 to 2e6), and about their middles where these
/// are far from 0.
pub const REPLAY: f64 = 1e-6;

/// How far a sample of a plan may be from the run of the plan's inputs from its start, relative to
/// the width of the state's domain (no unit), where [`REPLAY`] at every step allows more than that.
pub const DRIFT: f64 = 1e-5;

/// Distance from a surface, in m, within which a replay with located impacts asks the plan in which
/// step an impact is, because rows are satisfied only to [`FEASIBILITY`]. Farther away the replay
/// decides alone.
pub const CONTACT_TIE: f64 = 1e-6;

/// Rebound speed, in m/s, below which a vehicle that is pressed against a wall rests there in a
/// continuous replay. The ignored hop is lower than `REST_SPEED^2 / (2 |a|)`, in m.
pub const REST_SPEED: f64 = 1e-7;

/// Number of bounces within one step after which a vehicle that is pressed against a wall rests
/// there in a continuous replay. This limits the work at huge accelerations.
pub const MAX_BOUNCES: usize = 1000;

/// Default margin of reach sets, in SI units: how much a plan may miss limits, guards and ends and
/// still lie in the sets. An accepted plan satisfies its rows to [`FEASIBILITY`] and agrees with
/// its replay to [`REPLAY`]; this is twice their sum. Beyond a magnitude of 1000 it grows in
/// proportion.
pub const REACH: f64 = 4e-6;

/// By how much a negated row of a mission fails where a program requires it, in the row's unit, so
/// that a mission and its negation never both hold: more than two rows that are satisfied only to
/// [`FEASIBILITY`] can give.
pub const MISSION_SEPARATION: f64 = 1e-5;

/// Longest horizon, in steps, for which a model is built. A longer one is refused with an error
/// before anything is allocated.
pub const MAX_STEPS: usize = 100_000;

/// How much rounding may add to the violation of a row, relative to the sum of the magnitudes of
/// its terms and its limit (no unit).
///
/// Every value of a point has a rounding error: half an epsilon for its last rounding, and another
/// half for each product, sum and quotient of the equality from which presolve computed it. Eight
/// halves cover an equality with a few terms. The evaluation itself adds nothing, because
/// [`Verification`](crate::solution::Verification) sums with twice the digits.
pub const ROUNDING: f64 = 4.0 * f64::EPSILON;
