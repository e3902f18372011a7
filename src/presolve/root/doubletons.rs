//! Equalities over two columns replace one of them, chain after chain.
//!
//! The bounds of the column become a row over the other one, which `singleton_rows` turns into bounds.
//! An integral column is only replaced by a whole multiple of an integral one, and the continuous
//! column of a mixed pair goes. Two binaries of which exactly one is on stay as they are: the search
//! reads modes from such rows. So do columns with curvature, whose products would spread.

use super::substitute::{is_stable, substitute};
use super::work::{Work, is_whole};

pub(super) fn apply(work: &mut Work) -> usize {
    let mut changes = 0;
    for row in work.live_rows() {
        if work.is_late(work.rows[row].len()) {
            break;
        }
        if !work.is_equality(row) {
            continue;
        }
        let [one, two] = work.rows[row][..] else { continue };
        let candidates = [(one, two), (two, one)];
        let best = candidates
            .into_iter()
            .filter(|&(gone, stays)| may_go(work, row, gone, stays))
            .min_by_key(|&(gone, _)| (work.uses[gone.0].len(), gone.0));
        let Some((gone, _)) = best else { continue };
        substitute(work, gone.0, row, true);
        changes += 1;
    }
    changes
}

fn may_go(work: &Work, row: usize, gone: (usize, f64), stays: (usize, f64)) -> bool {
    let is_binary = |j: usize| work.integral[j] && work.lower[j] >= 0.0 && work.upper[j] <= 1.0;
    if !work.is_straight(gone.0) || (is_binary(gone.0) && is_binary(stays.0)) {
        return false;
    }
    let whole = match (work.integral[gone.0], work.integral[stays.0]) {
        (false, _) => true,
        (true, false) => false,
        (true, true) => is_whole(stays.1 / gone.1) && is_whole(work.row_lower[row] / gone.1),
    };
    whole && is_stable(work, gone.0, row)
}
