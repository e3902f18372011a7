//! Coefficient tightening: big-Ms from the bounds of a node.
//!
//! Where a row cannot bind at one value of a binary, the binary's coefficient and the row's limit
//! can move together until it just does not bind there. Whole points are kept, relaxed ones are
//! not: `x <= 2 + 8 (1 - z)` at a node with `x <= 5` becomes `x <= 2 + 3 (1 - z)`.

use super::reduce::Reduced;
use crate::tolerance;

/// Rows are left this much looser than they could be, relative to their activity (no unit):
/// rounding must not cut a whole point off.
const MARGIN: f64 = 1e-9;

/// Rows that can be missed by no more than this stay as they are, in their unit: tight coefficients as
/// small as that would be rounding.
const IMPERCEPTIBLE: f64 = tolerance::FEASIBILITY;

/// Gains below this fraction of a coefficient are not worth a change (no unit).
const GAIN: f64 = 1e-3;

/// Tightens the one-sided rows of a reduced program; `integral` is by program column.
pub fn tighten_coefficients(reduced: &mut Reduced, integral: &[bool]) {
    let binary: Vec<bool> =
        (0..reduced.columns.len()).map(|k| is_binary(reduced, k, integral)).collect();
    for row in 0..reduced.rows.len() {
        let (lower, upper) = (reduced.row_lower[row], reduced.row_upper[row]);
        // In the form `sign * row <= limit`.
        let (sign, mut limit) = match (lower.is_finite(), upper.is_finite()) {
            (true, false) => (-1.0, -lower),
            (false, true) => (1.0, upper),
            _ => continue,
        };
        let range = reduced.rows.start[row]..reduced.rows.start[row + 1];
        let columns = &reduced.rows.index[range.clone()];
        if !columns.iter().any(|&k| binary[k]) {
            continue;
        }
        let values = &mut reduced.rows.value[range];
        let (mut most, mut scale) = (0.0, limit.abs().max(1.0));
        for (&k, &a) in columns.iter().zip(&*values) {
            let (p, q) = (sign * a * reduced.lower[k], sign * a * reduced.upper[k]);
            most += p.max(q);
            scale += p.abs().max(q.abs());
        }
        let margin = MARGIN * scale;
        if !(most.is_finite() && most - limit > IMPERCEPTIBLE) {
            continue;
        }
        for (_, value) in columns.iter().zip(values).filter(|(k, _)| binary[**k]) {
            let size = value.abs();
            // How far the row is from binding at the binary's idle value.
            let room = limit - (most - size) - margin;
            if room <= GAIN * size {
                continue;
            }
            // `most > limit` leaves the rest of the coefficient positive.
            let cut = room.min(size);
            let raises = sign * *value > 0.0;
            *value -= cut.copysign(*value);
            if raises {
                // Idle at 0: limit and largest activity move with the coefficient.
                limit += 4.0 * f64::EPSILON * scale - cut;
                most -= cut;
            }
        }
        if sign > 0.0 { reduced.row_upper[row] = limit } else { reduced.row_lower[row] = -limit }
    }
}

/// Whether a reduced column takes exactly the values 0 and 1.
pub(super) fn is_binary(reduced: &Reduced, k: usize, integral: &[bool]) -> bool {
    integral[reduced.columns[k]] && reduced.lower[k] == 0.0 && reduced.upper[k] == 1.0
}
