//! Programs that have a point up to rounding only.
//!
//! A corner of the box `x, y <= 1` satisfies `0.1 x + 0.2 y >= 0.3` but for the last digit, and no
//! other point does. The corner is within every tolerance and accepted, but in floats the program
//! is empty: multipliers of 1e18 prove any bound, and methods end anywhere. A bound from such
//! multipliers is *blurred*: rounding of the rows' terms moves it visibly.
//!
//! The program is then solved again with slightly wider limits and bounds. A bound on the wider
//! program holds for the program as well. If it is lower by more than its own multipliers explain,
//! the bound of the program was that of an empty set, and the wider one counts.
//!
//! Large multipliers also magnify the residuals of an interior-point method: over ten steps of
//! `x+ = 10 x`, 1e-9 becomes 10. Such a point is *rough*, and a vertex is better.

use crate::presolve::Reduced;
use crate::sum::Sum;
use crate::tolerance::{self, finite_size};

/// The amounts by which bounds and limits are widened, relative to the magnitudes in them (no
/// unit): for violations by rounding, and for violations below the tolerance.
pub(super) const WIDENINGS: [f64; 2] = [1e-13, 1e-9];

/// The smallest move of a bound, or of a value, that is visible, relative.
const VISIBLE_CHANGE: f64 = 1e-7;

/// The largest distance of two bounds, as a multiple of the distance that multipliers explain.
const MAX_EXPLAINED_RATIO: f64 = 100.0;

/// The doubts about a bound and a point.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Doubt {
    /// Rounding of the rows' terms would move the bound visibly.
    pub(super) blurred: bool,
    /// The violations of rows at the point of a leaf make a visible part of its value.
    pub(super) rough: bool,
}

impl Doubt {
    pub(super) fn is_any(self) -> bool {
        self.blurred || self.rough
    }
}

/// The magnitude of a column near a point: that of its bounds, or of its value where these are far.
fn magnitude(program: &Reduced, x: &[f64], j: usize) -> f64 {
    let reach = program.lower[j].abs().max(program.upper[j].abs());
    reach.min(x.get(j).map_or(1.0, |x| x.abs()).max(1.0))
}

/// The sum of the magnitudes of a row's terms and of its limit.
pub(super) fn size(program: &Reduced, x: &[f64], row: usize, limit: f64) -> f64 {
    let (columns, values) = program.rows.vector(row);
    let terms = columns.iter().zip(values).map(|(&j, a)| a.abs() * magnitude(program, x, j));
    terms.sum::<f64>() + finite_size(limit)
}

/// The amount by which a relative change of the rows' terms may move the bound that multipliers
/// prove.
fn effect(program: &Reduced, x: &[f64], y: &[f64], part: f64) -> f64 {
    let effect = |(row, y): (usize, &f64)| {
        let limit = if *y > 0.0 { program.row_upper[row] } else { program.row_lower[row] };
        y.abs() * size(program, x, row, limit)
    };
    part * y.iter().enumerate().filter(|(_, y)| **y != 0.0).map(effect).sum::<f64>()
}

/// Whether rounding of the rows' terms would move a bound visibly.
pub(super) fn is_blurred(program: &Reduced, x: &[f64], y: &[f64], bound: f64) -> bool {
    bound.is_finite()
        && effect(program, x, y, tolerance::ROUNDING) > VISIBLE_CHANGE * bound.abs().max(1.0)
}

/// Whether the violations of rows and bounds at a point make a visible part of its value:
/// multipliers of 1e9 turn rounding into a gain.
pub(super) fn is_rough(program: &Reduced, x: &[f64], y: &[f64], value: f64) -> bool {
    let miss = |value: f64, lower: f64, upper: f64| (lower - value).max(value - upper).max(0.0);
    let mut slopes = program.linear.clone();
    for (j, &xj) in x.iter().enumerate() {
        let (rows, entries) = program.quadratic.vector(j);
        for (&i, &p) in rows.iter().zip(entries) {
            slopes[i] += p * xj;
            slopes[j] += if i == j { 0.0 } else { p * x[i] };
        }
    }
    let mut gain = 0.0;
    for (row, &y) in y.iter().enumerate().filter(|(_, y)| **y != 0.0) {
        let (columns, values) = program.rows.vector(row);
        let mut sum = Sum::default();
        for (&j, &a) in columns.iter().zip(values) {
            sum.add_product(a, x[j]);
            slopes[j] += a * y;
        }
        gain += y.abs() * miss(sum.value(), program.row_lower[row], program.row_upper[row]);
    }
    for (j, slope) in slopes.iter().enumerate() {
        gain += slope.abs() * miss(x[j], program.lower[j], program.upper[j]);
    }
    gain > VISIBLE_CHANGE * value.abs().max(1.0)
}

/// Whether two bounds, of a program and of the same one with wider limits, are further apart than
/// the multipliers of the second explain.
pub(super) fn is_torn(
    program: &Reduced,
    bounds: [f64; 2],
    x: &[f64],
    y: &[f64],
    part: f64,
) -> bool {
    let [own, wider] = bounds;
    let rounding = VISIBLE_CHANGE * wider.abs().max(1.0);
    own - wider > MAX_EXPLAINED_RATIO * effect(program, x, y, part) + rounding
}

/// The program with wider bounds, and wider limits but for equations.
pub(super) fn widened(program: &Reduced, x: &[f64], part: f64) -> Reduced {
    let mut wide = program.clone();
    for row in 0..program.rows.len() {
        let (lower, upper) = (program.row_lower[row], program.row_upper[row]);
        if lower < upper {
            wide.row_lower[row] -= part * size(program, x, row, lower);
            wide.row_upper[row] += part * size(program, x, row, upper);
        }
    }
    for j in 0..program.columns.len() {
        let by = part * magnitude(program, x, j).max(f64::MIN_POSITIVE);
        wide.lower[j] -= by;
        wide.upper[j] += by;
    }
    wide
}
