//! Bounds of columns from one row.
//!
//! Most visits end after a single pass: if the row's slack (its limit less its smallest activity)
//! is at least its widest term, no bound can move. Bounds of continuous columns are loosened
//! slightly ([`tolerance::PROPAGATION_SLACK`]), so that rounding never cuts off a feasible point.

use crate::tolerance;

/// One term of a row; the coefficient is not zero.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    /// Twice the column, plus one where the coefficient is negative: the bound at which the term is
    /// smallest.
    least: u32,
    pub(super) coefficient: f64,
}

impl Entry {
    pub(super) fn new(column: usize, coefficient: f64) -> Self {
        Entry { least: 2 * column as u32 + u32::from(coefficient < 0.0), coefficient }
    }

    #[inline]
    pub(super) fn column(&self) -> usize {
        (self.least / 2) as usize
    }

    /// Smallest and largest value of the term.
    #[inline]
    fn ends(&self, bounds: &[[f64; 2]]) -> (f64, f64) {
        let side = (self.least % 2) as usize;
        let bounds = &bounds[self.column()];
        (self.coefficient * bounds[side], self.coefficient * bounds[1 - side])
    }
}

/// A row: where its entries are, and its limits.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    pub(super) range: [usize; 2],
    pub(super) limits: [f64; 2],
}

/// One tightened bound of a row.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tightening {
    pub(super) column: usize,
    pub(super) is_upper: bool,
    pub(super) value: f64,
}

/// What a visit says about a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum RowState {
    /// No point of the domain satisfies it.
    Violated,
    /// Every point of the domain satisfies it.
    Implied,
    Open,
}

/// Smallest or largest activity of a row: the finite part, and how many terms are infinite.
#[derive(Clone, Copy, Default)]
struct Activity {
    finite: f64,
    infinite: usize,
}

impl Activity {
    fn add(&mut self, term: f64) {
        if term.is_finite() {
            self.finite += term;
        } else {
            self.infinite += 1;
        }
    }

    /// The room between the activity without one of its terms and a limit; `None` where the rest is
    /// infinite.
    fn room(&self, term: f64, limit: f64) -> Option<f64> {
        match (self.infinite, term.is_finite()) {
            (0, true) => Some(limit - self.finite + term),
            (1, false) => Some(limit - self.finite),
            _ => None,
        }
    }
}

/// Finds the bounds that one row tightens by more than `least_gain` of their width.
#[inline]
pub(super) fn tighten(
    integral: &[bool],
    bounds: &[[f64; 2]],
    entries: &[Entry],
    limits: [f64; 2],
    least_gain: f64,
    found: &mut Vec<Tightening>,
) -> RowState {
    let (mut least, mut most, mut widest) = (0.0, 0.0, 0.0_f64);
    for entry in entries {
        let (low, high) = entry.ends(bounds);
        least += low;
        most += high;
        widest = larger(high - low, widest);
    }
    // Sums that are not numbers compare false and take the long way.
    if limits[1] - least >= widest && most - limits[0] >= widest && widest < f64::INFINITY {
        return if most <= limits[1] && least >= limits[0] {
            RowState::Implied
        } else {
            RowState::Open
        };
    }
    if most <= limits[1] && least >= limits[0] {
        return RowState::Implied;
    }
    let activities = if widest < f64::INFINITY {
        [least, most].map(|finite| Activity { finite, infinite: 0 })
    } else {
        count_infinite(bounds, entries)
    };
    tighten_binding(integral, bounds, entries, limits, activities, least_gain, found)
}

/// Smallest and largest activity of a row with infinite terms.
fn count_infinite(bounds: &[[f64; 2]], entries: &[Entry]) -> [Activity; 2] {
    let mut activities = [Activity::default(); 2];
    for entry in entries {
        let (low, high) = entry.ends(bounds);
        activities[0].add(low);
        activities[1].add(high);
    }
    activities
}

/// As [`tighten`], for rows that may bind or have infinite activities.
fn tighten_binding(
    integral: &[bool],
    bounds: &[[f64; 2]],
    entries: &[Entry],
    [row_lower, row_upper]: [f64; 2],
    [least, most]: [Activity; 2],
    least_gain: f64,
    found: &mut Vec<Tightening>,
) -> RowState {
    let mut scale = 0.0_f64;
    for entry in entries {
        let (low, high) = entry.ends(bounds);
        scale += larger(size(low), size(high));
    }
    let scale = scale.max(size(row_lower)).max(size(row_upper)).max(1.0);
    let excess = tolerance::PROPAGATION_INFEASIBLE * scale;
    if (least.infinite == 0 && least.finite > row_upper + excess)
        || (most.infinite == 0 && most.finite < row_lower - excess)
    {
        return RowState::Violated;
    }
    let upper_binds = row_upper.is_finite() && (most.infinite > 0 || most.finite > row_upper);
    let lower_binds = row_lower.is_finite() && (least.infinite > 0 || least.finite < row_lower);
    if !upper_binds && !lower_binds {
        return RowState::Implied;
    }
    // Accumulated rounding of the activity, in the row's unit.
    let rounding = 1e-15 * scale * (entries.len() as f64);
    // What the row itself is known to: a small coefficient makes much of it.
    let known = tolerance::PROPAGATION_SLACK * scale;
    let mut offer = |entry: &Entry, term: f64, is_upper: bool| {
        let column = entry.column();
        let value = term / entry.coefficient;
        if !value.is_finite() || value.abs() >= tolerance::INFINITE {
            return;
        }
        found.extend(if integral[column] {
            let slack = tolerance::INTEGRALITY + known / entry.coefficient.abs();
            whole(bounds[column], column, is_upper, value, slack)
        } else {
            worthwhile(bounds[column], column, is_upper, value, least_gain)
        });
    };
    if least.infinite + most.infinite == 0 {
        let rest_below = row_upper + rounding - least.finite;
        let rest_above = row_lower - rounding - most.finite;
        for entry in entries {
            let (low, high) = entry.ends(bounds);
            // No gain beyond the other end of the term, or too small a one, before any division.
            let gain = if integral[entry.column()] { 0.0 } else { least_gain * (high - low) };
            let (most, least) = (rest_below + low, rest_above + high);
            if most < high - gain && low < high {
                offer(entry, most, entry.coefficient > 0.0);
            }
            if least > low + gain && low < high {
                offer(entry, least, entry.coefficient < 0.0);
            }
        }
        return RowState::Open;
    }
    for entry in entries {
        let (low, high) = entry.ends(bounds);
        if low == high {
            continue;
        }
        if upper_binds
            && let Some(most) = least.room(low, row_upper + rounding).filter(|&m| m < high)
        {
            offer(entry, most, entry.coefficient > 0.0);
        }
        if lower_binds
            && let Some(least) = most.room(high, row_lower - rounding).filter(|&l| l > low)
        {
            offer(entry, least, entry.coefficient < 0.0);
        }
    }
    RowState::Open
}

fn size(value: f64) -> f64 {
    if value.is_finite() { value.abs() } else { 0.0 }
}

/// The larger one of two numbers; the second where one is none. One instruction, unlike
/// [`f64::max`].
#[inline]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// A candidate bound of an integral column: the next whole value, when that is news.
fn whole(
    [lower, upper]: [f64; 2],
    column: usize,
    is_upper: bool,
    value: f64,
    slack: f64,
) -> Option<Tightening> {
    let value = if is_upper { (value + slack).floor() } else { (value - slack).ceil() };
    let news = if is_upper { value < upper } else { value > lower };
    news.then_some(Tightening { column, is_upper, value })
}

/// A candidate bound of a continuous column, when it is worth it.
fn worthwhile(
    [lower, upper]: [f64; 2],
    column: usize,
    is_upper: bool,
    value: f64,
    least_gain: f64,
) -> Option<Tightening> {
    let slack = tolerance::PROPAGATION_SLACK * value.abs().max(1.0);
    let value = if is_upper { value + slack } else { value - slack };
    let gain = if is_upper { upper - value } else { value - lower };
    let width = upper - lower;
    let worth = if width.is_finite() {
        (least_gain * width).max(10.0 * slack)
    } else {
        1e-3 * value.abs().max(1.0)
    };
    if gain.is_nan() || gain <= worth {
        return None;
    }
    Some(Tightening { column, is_upper, value })
}
