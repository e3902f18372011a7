//! Where to split a box.

use super::program::SpatialProgram;
use crate::presolve::Domain;

/// A split: the column and the value at which it is split. Whole columns are split between the
/// value's neighbours.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BoxSplit {
    pub(crate) column: usize,
    pub(crate) at: f64,
}

/// The part of a range that each child has at least.
const LEAST_PART: f64 = 0.15;

/// How far the place is moved from the point to the middle.
const TO_MIDDLE: f64 = 0.25;

/// The width below which a range is not split, relative to its magnitude (no unit).
const NARROW_RANGE: f64 = 1e-10;

/// A miss of terms below this is rounding (no unit).
const LEAST_TERM_MISS: f64 = 1e-9;

/// The gains of earlier splits, by column.
#[derive(Debug)]
pub(crate) struct SplitHistory {
    /// The lift of the bound per unit of what was split away, and the number of children.
    gains: Vec<(f64, u32)>,
}

impl SplitHistory {
    pub(crate) fn new(columns: usize) -> Self {
        SplitHistory { gains: vec![(0.0, 0); columns] }
    }

    /// Notes the lift of a child.
    pub(crate) fn note(&mut self, column: usize, lift: f64, distance: f64) {
        if lift.is_finite() && distance > 0.0 {
            let entry = &mut self.gains[column];
            entry.0 += lift.max(0.0) / distance;
            entry.1 += 1;
        }
    }

    fn gain(&self, column: usize, default: f64) -> f64 {
        match self.gains[column] {
            (_, 0) => default,
            (sum, count) => sum / f64::from(count),
        }
    }

    fn mean(&self, columns: impl Iterator<Item = usize>) -> f64 {
        let known = columns.map(|j| self.gains[j]).filter(|(_, count)| *count > 0);
        let (sum, count) =
            known.fold((0.0, 0), |(s, n), (sum, count)| (s + sum / f64::from(count), n + 1));
        if count > 0 { sum / f64::from(count) } else { 1.0 }
    }
}

/// The split of a box at its relaxed point; `None` if all integers are whole and no range can be
/// split.
pub(crate) fn choose(
    program: &SpatialProgram,
    history: &SplitHistory,
    domain: &Domain,
    x: &[f64],
    integrality: f64,
) -> Option<BoxSplit> {
    let integers = &program.program.integers;
    let fraction = |j: usize| {
        let part = x[j] - x[j].floor();
        part.min(1.0 - part)
    };
    let mean = history.mean(integers.iter().copied());
    let open =
        integers.iter().copied().filter(|&j| fraction(j) > integrality && !domain.is_fixed(j));
    let score = |j: usize| fraction(j) * history.gain(j, mean).max(1e-6 * mean.max(1e-6));
    if let Some(column) = open.max_by(|&a, &b| score(a).total_cmp(&score(b))) {
        return Some(BoxSplit { column, at: x[column] });
    }
    spatial_split(program, history, domain, x)
}

fn spatial_split(
    program: &SpatialProgram,
    history: &SplitHistory,
    domain: &Domain,
    x: &[f64],
) -> Option<BoxSplit> {
    let off = program.misses(x);
    let can_split = |j: usize| {
        let [lower, upper] = domain.bounds(j);
        let size = lower.abs().max(upper.abs()).max(1e-3);
        upper - lower == f64::INFINITY || upper - lower > NARROW_RANGE * size
    };
    let mean = history.mean(program.spatial.iter().copied());
    let score = |j: usize| {
        let [lower, upper] = domain.bounds(j);
        let width = (upper - lower).min(1e6);
        let share = off[j] * (0.1 + history.gain(j, mean) / mean.max(1e-12));
        // Of equal ones, the wider range.
        share * width.max(1e-12).powf(0.25)
    };
    let places =
        program.spatial.iter().copied().filter(|&j| can_split(j) && off[j] > LEAST_TERM_MISS);
    let column = places.max_by(|&a, &b| score(a).total_cmp(&score(b)));
    // Without a violation the widest range is left.
    let column = column.or_else(|| {
        let all = program.spatial.iter().copied().filter(|&j| can_split(j));
        let width = |j: usize| domain.upper(j) - domain.lower(j);
        all.max_by(|&a, &b| width(a).total_cmp(&width(b)))
    })?;
    Some(BoxSplit { column, at: place(domain, column, x[column]) })
}

/// The value at which a range is split.
fn place(domain: &Domain, column: usize, x: f64) -> f64 {
    let [lower, upper] = domain.bounds(column);
    match (lower.is_finite(), upper.is_finite()) {
        (true, true) => {
            let (middle, width) = (0.5 * lower + 0.5 * upper, upper - lower);
            let at = (1.0 - TO_MIDDLE) * x + TO_MIDDLE * middle;
            at.max(lower + LEAST_PART * width).min(upper - LEAST_PART * width)
        }
        (true, false) => x.max(lower + lower.abs().max(1.0)),
        (false, true) => x.min(upper - upper.abs().max(1.0)),
        (false, false) => {
            if x.is_finite() {
                x
            } else {
                0.0
            }
        }
    }
}
