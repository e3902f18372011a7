//! The ratio test of the dual method: which column enters, and which ones jump to their other
//! bound.
//!
//! Columns between two bounds may pass the step at which their reduced costs vanish: they jump to
//! the other bound, as long as the dual objective still rises beyond. Among columns whose steps
//! differ by tolerances only, the one with the largest entry enters (Koberstein, The dual simplex
//! method, techniques for a fast and stable implementation, section 6.2).

use super::parameters::{DUAL_TOLERANCE, MIN_ENTRY};

/// The least entry of the entering column, relative to the largest one of those that might enter or
/// jump. Larger entries of earlier columns are preferred to smaller ones.
const MIN_RELATIVE_ENTRY: f64 = 0.1;

/// The factor by which the longest step in sight grows.
const STEP_GROWTH: f64 = 10.0;

/// A column whose reduced cost falls to zero as the dual step grows.
#[derive(Debug, Clone, Copy)]
pub(super) struct EnteringColumn {
    pub(super) of: usize,
    /// Magnitudes of its entry in the pivot row and of its reduced cost.
    pub(super) entry: f64,
    pub(super) cost: f64,
    /// Distance of its bounds.
    pub(super) width: f64,
}

impl EnteringColumn {
    /// `None` if the entry has the wrong sign for it or is zero.
    ///
    /// # Arguments
    ///
    /// * `entry`: in the pivot row, positive if the column at its lower bound is a candidate.
    pub(super) fn new(
        of: usize,
        entry: f64,
        cost: f64,
        bounds: [f64; 2],
        at: NonbasicStatus,
    ) -> Option<Self> {
        let [lower, upper] = bounds;
        let (fits, cost) = match at {
            NonbasicStatus::Lower => (entry > MIN_ENTRY, cost),
            NonbasicStatus::Upper => (entry < -MIN_ENTRY, -cost),
            NonbasicStatus::Free => (entry.abs() > MIN_ENTRY, 0.0),
        };
        let width = upper - lower;
        let open = fits && width > 0.0;
        open.then(|| EnteringColumn { of, entry: entry.abs(), cost: cost.max(0.0), width })
    }

    fn step(&self) -> f64 {
        self.cost / self.entry
    }

    /// The longest step that misses the sign of the reduced cost by the tolerance at most.
    fn reach(&self) -> f64 {
        (self.cost + DUAL_TOLERANCE) / self.entry
    }
}

/// The bound at which a column outside the basis rests.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NonbasicStatus {
    Lower,
    Upper,
    /// At zero, without bounds.
    Free,
}

/// The column that enters, if any, after the ones that jump, which come before it in `candidates`:
/// their number. `slope` is what the dual objective gains per unit of step.
pub(super) fn test(
    candidates: &mut [EnteringColumn],
    mut slope: f64,
) -> (usize, Option<EnteringColumn>) {
    // A bound that is reached but for rounding is reached.
    let enough = DUAL_TOLERANCE * slope.max(1.0);
    let near = nearest(candidates, slope - enough);
    let near = &mut candidates[..near];
    near.sort_unstable_by(|a, b| a.step().total_cmp(&b.step()));
    let mut reach = vec![f64::INFINITY; near.len() + 1];
    for (k, column) in near.iter().enumerate().rev() {
        reach[k] = column.reach().min(reach[k + 1]);
    }
    let mut groups = Vec::new();
    let mut most = 0.0_f64;
    let (mut begin, mut ends) = (0, false);
    while begin < near.len() && !ends {
        let group = near[begin..].iter().take_while(|c| c.step() <= reach[begin]);
        let (mut length, mut fall) = (0, 0.0);
        for column in group {
            most = most.max(column.entry);
            fall += column.entry * column.width;
            length += 1;
        }
        groups.push(begin..begin + length);
        ends = fall >= slope - enough;
        slope -= fall;
        begin += length;
    }
    if !ends {
        return (near.len(), None);
    }
    let least = (MIN_RELATIVE_ENTRY * most).min(1.0);
    for group in groups.into_iter().rev() {
        let best = near[group.clone()].iter().max_by(|a, b| a.entry.total_cmp(&b.entry));
        if let Some(best) = best.filter(|c| c.entry >= least) {
            return (group.start, Some(*best));
        }
    }
    (0, None)
}

/// Moves the columns with the shortest steps to the front: so many that the dual objective does not
/// rise beyond them, and not many more. Returns their number.
fn nearest(candidates: &mut [EnteringColumn], slope: f64) -> usize {
    let shortest = candidates.iter().map(EnteringColumn::reach).fold(f64::INFINITY, f64::min);
    let mut limit = STEP_GROWTH * shortest.max(DUAL_TOLERANCE);
    let (mut near, mut fall) = (0, 0.0);
    // Without end only if a step is not a number.
    while near < candidates.len() && fall < slope && limit < f64::INFINITY {
        let old = near;
        for k in old..candidates.len() {
            if candidates[k].step() <= limit {
                fall += candidates[k].entry * candidates[k].width;
                candidates.swap(k, near);
                near += 1;
            }
        }
        limit *= if near == old { STEP_GROWTH * STEP_GROWTH } else { STEP_GROWTH };
    }
    near
}
