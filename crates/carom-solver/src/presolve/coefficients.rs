//! Coefficient tightening: big-Ms from bounds.
//!
//! Takes rows with one limit and binaries; leaves smaller coefficients of the binaries, and limits
//! to match (Crowder, Johnson and Padberg, Solving large-scale zero-one linear programming
//! problems, Operations Research 31, 1983). If all columns of a row are integral, its limits are
//! rounded to multiples of the greatest common divisor of its coefficients.
//!
//! If a row is redundant at one value of a binary, the binary's coefficient and the row's limit can
//! be changed together until it is only just redundant. This keeps integral points and cuts off
//! relaxed ones: `x <= 2 + 8 (1 - z)` at a node with `x <= 5` becomes `x <= 2 + 3 (1 - z)`.

use super::reduced::Reduced;
use crate::activity::term_ends;
use crate::tolerance::{self, finite_size};

/// The amount by which a row stays looser than necessary, relative to its activity (no unit), so
/// that rounding cuts off no whole point.
const ACTIVITY_MARGIN: f64 = 1e-9;

/// The smallest possible violation of a row that is tightened, in its unit. Smaller coefficients
/// would be rounding.
const MIN_EXCESS: f64 = tolerance::FEASIBILITY;

/// The smallest gain that is used, as a fraction of the coefficient.
const MIN_COEFFICIENT_GAIN: f64 = 1e-3;

/// The number of last binary digits that are 0 in a coefficient that has not been rounded.
const MIN_TRAILING_ZEROS: u32 = 16;

/// The largest coefficient of a row of integers whose limits are rounded.
const MAX_DIVISIBLE: f64 = 1e9;

/// A row in the form `sign * terms <= limit`.
#[derive(Debug, Clone, Copy)]
struct OneSided {
    sign: f64,
    limit: f64,
    /// The largest activity over the bounds.
    most: f64,
}

impl OneSided {
    /// A row with these limits, or `None` if it has two or none.
    fn new(lower: f64, upper: f64) -> Option<Self> {
        let (sign, limit) = match (lower.is_finite(), upper.is_finite()) {
            (true, false) => (-1.0, -lower),
            (false, true) => (1.0, upper),
            _ => return None,
        };
        Some(OneSided { sign, limit, most: f64::INFINITY })
    }

    /// Whether the bounds allow points that the row excludes.
    fn can_be_violated(&self) -> bool {
        self.most.is_finite() && self.most - self.limit > MIN_EXCESS
    }

    /// Shrinks the coefficient of a binary, and moves the limit with it; returns whether they
    /// moved.
    ///
    /// The row stays looser than it could be by `margin` (row's unit), and the limit by `rounding`,
    /// which is relative to the coefficient and the limit: nothing else is rounded.
    fn shrink(&mut self, coefficient: &mut f64, margin: f64, rounding: f64) -> bool {
        let size = coefficient.abs();
        // The distance of the row from its limit at the value of the binary that relaxes it.
        let room = self.limit - (self.most - size) - margin;
        if room <= MIN_COEFFICIENT_GAIN * size {
            return false;
        }
        let rounding = rounding * (size + self.limit.abs());
        // `most > limit` leaves the rest of the coefficient positive.
        let cut = room.min(size);
        let is_idle_at_zero = self.sign * *coefficient > 0.0;
        *coefficient -= cut.copysign(*coefficient);
        if is_idle_at_zero {
            // Limit and largest activity move with the coefficient.
            self.limit += rounding - cut;
            self.most -= cut;
        }
        true
    }

    /// The limit that the row has, with its own sign.
    fn write_limit(&self, lower: &mut f64, upper: &mut f64) {
        if self.sign > 0.0 { *upper = self.limit } else { *lower = -self.limit }
    }
}

/// The bounds and the integrality of columns.
#[derive(Debug, Clone, Copy)]
pub(super) struct Columns<'a> {
    pub(super) lower: &'a [f64],
    pub(super) upper: &'a [f64],
    pub(super) integral: &'a [bool],
}

impl Columns<'_> {
    fn is_binary(&self, j: usize) -> bool {
        self.integral[j] && self.lower[j] == 0.0 && self.upper[j] == 1.0
    }
}

/// Tightens the binaries of a one-sided row; the new limits, or `None` if nothing moves.
///
/// # Arguments
///
/// * `noise`: how far rounding may have moved terms and limits, in the row's unit.
pub(super) fn tighten_terms(
    terms: &mut [(usize, f64)],
    [lower, upper]: [f64; 2],
    columns: Columns<'_>,
    noise: f64,
) -> Option<[f64; 2]> {
    let mut side = OneSided::new(lower, upper)?;
    let (mut most, mut scale) = (0.0, 1.0_f64);
    for &(j, a) in &*terms {
        let ends = term_ends(side.sign * a, [columns.lower[j], columns.upper[j]]);
        most += ends[1];
        scale = ends.into_iter().fold(scale, |scale, end| scale.max(finite_size(end)));
    }
    side.most = most;
    if !side.can_be_violated() {
        return None;
    }
    let is_whole_term = |&(j, a): &(usize, f64)| columns.integral[j] && is_whole(a);
    // Limits are rounded to their last digit each time; whole numbers are not.
    let (margin, rounding) = if is_whole(side.limit) && terms.iter().all(is_whole_term) {
        (0.0, 0.0)
    } else {
        let scale = scale * terms.len() as f64;
        (ACTIVITY_MARGIN * scale + noise, 2.0 * f64::EPSILON)
    };
    let mut moved = false;
    for (_, value) in terms.iter_mut().filter(|(j, _)| columns.is_binary(*j)) {
        moved |= side.shrink(value, margin, rounding);
    }
    let (mut lower, mut upper) = (lower, upper);
    side.write_limit(&mut lower, &mut upper);
    moved.then_some([lower, upper])
}

/// The limits of a row of integers, rounded to multiples of the greatest common divisor of its
/// coefficients, and whether they have moved; `None` if there is no divisor.
pub(super) fn round_limits(
    terms: &[(usize, f64)],
    [lower, upper]: [f64; 2],
    columns: Columns<'_>,
    noise: f64,
) -> Option<([f64; 2], bool)> {
    let mut divisor = 0u64;
    for &(j, a) in terms {
        if !columns.integral[j] || a.abs() > MAX_DIVISIBLE || a != a.round() {
            return None;
        }
        let (mut p, mut q) = (divisor, a.abs() as u64);
        while q > 0 {
            (p, q) = (q, p % q);
        }
        divisor = p;
    }
    let divisor = divisor as f64;
    let slack = 1e-6_f64.min(1e-6 * divisor).max(noise);
    if divisor == 0.0 || slack >= 0.5 * divisor {
        return None;
    }
    let new_lower = divisor * ((lower - slack) / divisor).ceil();
    let new_upper = divisor * ((upper + slack) / divisor).floor();
    let moved = |old: f64, new: f64| old.is_finite() && (old - new).abs() > slack;
    Some(([new_lower, new_upper], moved(lower, new_lower) || moved(upper, new_upper)))
}

/// Whether a value is a whole number, up to rounding. Between numbers of 1e14, a quarter is no
/// rounding.
pub(super) fn is_whole(value: f64) -> bool {
    let rounding = (1e-12 * value.abs().max(1.0)).min(tolerance::INTEGRALITY);
    (value - value.round()).abs() <= rounding
}

/// Whether a coefficient has not been rounded: it is whole, or has few binary digits. Differences
/// from presolve have all of them.
pub(super) fn is_exact(coefficient: f64) -> bool {
    coefficient == coefficient.round()
        || coefficient.to_bits().trailing_zeros() >= MIN_TRAILING_ZEROS
}

/// Tightens the one-sided rows of a reduced program; `integral` is by program column.
pub fn tighten_coefficients(reduced: &mut Reduced, integral: &[bool]) {
    let Reduced { columns: names, lower, upper, rows, row_lower, row_upper, .. } = reduced;
    let is_binary = |k: usize| lower[k] == 0.0 && upper[k] == 1.0 && integral[names[k]];
    for row in 0..rows.len() {
        let (least, largest) = (&mut row_lower[row], &mut row_upper[row]);
        let Some(mut side) = OneSided::new(*least, *largest) else { continue };
        let range = rows.start[row]..rows.start[row + 1];
        let columns = &rows.index[range.clone()];
        if !columns.iter().any(|&k| is_binary(k)) {
            continue;
        }
        let values = &mut rows.value[range];
        let (mut most, mut scale) = (0.0, side.limit.abs().max(1.0));
        for (&k, &a) in columns.iter().zip(&*values) {
            let [low, high] = term_ends(side.sign * a, [lower[k], upper[k]]);
            most += high;
            scale += low.abs().max(high.abs());
        }
        side.most = most;
        if !side.can_be_violated() {
            continue;
        }
        for (_, value) in columns.iter().zip(values).filter(|(k, _)| is_binary(**k)) {
            side.shrink(value, ACTIVITY_MARGIN * scale, 4.0 * f64::EPSILON);
        }
        side.write_limit(least, largest);
    }
}
