//! Doubleton equalities.
//!
//! Takes an equality over two columns; leaves the program without one of them (Andersen and
//! Andersen, Presolving in linear programming, Mathematical Programming 71, 1995, for columns in a
//! single row).
//!
//! The bounds of the column become a row over the other one, which `singleton_rows` turns into
//! bounds. An integral column is replaced only by an integral multiple of an integral one, and of a
//! mixed pair the continuous column is replaced. Two binaries of which exactly one is 1 are kept,
//! because the search reads modes from such rows. So are columns with curvature, because their
//! products would fill in.

use super::substitute::{is_stable, substitute};
use super::working_program::WorkingProgram;
use crate::presolve::coefficients::is_whole;

pub(super) fn apply(work: &mut WorkingProgram, row: usize) -> usize {
    if !work.is_equality(row) {
        return 0;
    }
    let [one, two] = work.rows[row][..] else { return 0 };
    let candidates = [(one, two), (two, one)];
    let best = candidates
        .into_iter()
        .filter(|&(gone, stays)| may_go(work, row, gone, stays))
        .min_by_key(|&(gone, _)| (work.uses[gone.0].len(), gone.0));
    let Some((gone, _)) = best else { return 0 };
    substitute(work, gone.0, row, true);
    1
}

fn may_go(work: &WorkingProgram, row: usize, gone: (usize, f64), stays: (usize, f64)) -> bool {
    let is_binary = |j: usize| work.integral[j] && work.lower[j] >= 0.0 && work.upper[j] <= 1.0;
    let modes = is_binary(gone.0) && is_binary(stays.0) && gone.1 * stays.1 > 0.0;
    if !work.is_straight(gone.0) || modes {
        return false;
    }
    let whole = match (work.integral[gone.0], work.integral[stays.0]) {
        (false, _) => true,
        (true, false) => false,
        (true, true) => is_whole(stays.1 / gone.1) && is_whole(work.row_lower[row] / gone.1),
    };
    whole && is_stable(work, gone.0, row)
}
