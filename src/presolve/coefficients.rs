//! Coefficient tightening: big-Ms from bounds.
//!
//! If a row is redundant at one value of a binary, the binary's coefficient and the row's limit can
//! be changed together until it is only just redundant. This keeps integral points and cuts off
//! relaxed ones: `x <= 2 + 8 (1 - z)` at a node with `x <= 5` becomes `x <= 2 + 3 (1 - z)`.

use super::reduced::Reduced;
use crate::tolerance;

/// Rows are left this much looser than they could be, relative to their activity (no unit), so that
/// rounding cuts no whole point off.
pub(super) const MARGIN: f64 = 1e-9;

/// Rows that can be missed by no more than this stay as they are, in their unit, because coefficients
/// that small would be rounding.
const IMPERCEPTIBLE: f64 = tolerance::FEASIBILITY;

/// Gains below this fraction of a coefficient are not worth a change (no unit).
const GAIN: f64 = 1e-3;

/// A row in the form `sign * terms <= limit`.
#[derive(Debug, Clone, Copy)]
pub(super) struct OneSided {
    pub(super) sign: f64,
    pub(super) limit: f64,
    /// The largest activity over the bounds.
    pub(super) most: f64,
}

impl OneSided {
    /// A row with these limits, or `None` if it has two or none.
    pub(super) fn new(lower: f64, upper: f64) -> Option<Self> {
        let (sign, limit) = match (lower.is_finite(), upper.is_finite()) {
            (true, false) => (-1.0, -lower),
            (false, true) => (1.0, upper),
            _ => return None,
        };
        Some(OneSided { sign, limit, most: f64::INFINITY })
    }

    /// Whether the bounds allow points that the row excludes.
    pub(super) fn can_be_violated(&self) -> bool {
        self.most.is_finite() && self.most - self.limit > IMPERCEPTIBLE
    }

    /// Shrinks the coefficient of a binary, and moves the limit with it; returns whether they moved.
    ///
    /// The row stays looser than it could be by `margin`, and the limit by `rounding` (row's unit).
    pub(super) fn shrink(&mut self, coefficient: &mut f64, margin: f64, rounding: f64) -> bool {
        let size = coefficient.abs();
        // How far the row is from binding at the binary's idle value.
        let room = self.limit - (self.most - size) - margin;
        if room <= GAIN * size {
            return false;
        }
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
    pub(super) fn write_limit(&self, lower: &mut f64, upper: &mut f64) {
        if self.sign > 0.0 { *upper = self.limit } else { *lower = -self.limit }
    }
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
            let (p, q) = (side.sign * a * lower[k], side.sign * a * upper[k]);
            most += p.max(q);
            scale += p.abs().max(q.abs());
        }
        side.most = most;
        if !side.can_be_violated() {
            continue;
        }
        for (_, value) in columns.iter().zip(values).filter(|(k, _)| is_binary(**k)) {
            side.shrink(value, MARGIN * scale, 4.0 * f64::EPSILON * scale);
        }
        side.write_limit(least, largest);
    }
}
