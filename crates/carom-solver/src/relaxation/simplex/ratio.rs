//! The ratio test of the dual method: which column enters, and which ones jump to their other
//! bound.

use super::parameters::{DUAL_TOLERANCE, MIN_ENTRY};

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
    let mut done = 0;
    while done < candidates.len() {
        let rest = &mut candidates[done..];
        let reach = |c: &EnteringColumn| (c.cost + DUAL_TOLERANCE) / c.entry;
        let most = rest.iter().map(reach).fold(f64::INFINITY, f64::min);
        let mut group = 0;
        let mut fall = 0.0;
        for k in 0..rest.len() {
            if rest[k].cost / rest[k].entry <= most {
                fall += rest[k].entry * rest[k].width;
                rest.swap(k, group);
                group += 1;
            }
        }
        if fall < slope - enough {
            slope -= fall;
            done += group;
            continue;
        }
        let entering = rest[..group].iter().max_by(|a, b| a.entry.total_cmp(&b.entry)).copied();
        return (done, entering);
    }
    (done, None)
}
