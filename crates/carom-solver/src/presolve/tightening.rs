//! Bounds of columns from one row.
//!
//! Takes a row and the bounds of its columns; leaves tighter bounds, or a contradiction (Brearley,
//! Mitra and Williams, Analysis of mathematical programming problems prior to applying the simplex
//! algorithm, Mathematical Programming 8, 1975).
//!
//! Most visits end after a single pass: if the row's slack (its limit less its smallest activity)
//! is at least its widest term, no bound can move. Bounds of continuous columns are loosened
//! slightly ([`tolerance::PROPAGATION_SLACK`]), so that rounding never cuts off a feasible point. A
//! bound that an equation makes exactly 0 has no rounding and is not loosened.
//!
//! Terms of integral columns with coefficients that were not rounded are exact, however large they
//! are, so they loosen no bound. So `1e8 z >= 20` leaves a binary only the value 1, and a row over
//! wide integers is refuted as soon as it is violated.

use super::coefficients::is_exact;
use crate::activity::RowActivity;
use crate::sum::Sum;
use crate::tolerance::{self, finite_size};

/// The largest rounding of a plain sum, in the row's unit. Beyond it, sums are compensated:
/// rounding could hide a violation beyond the tolerance.
const MAX_PLAIN_ROUNDING: f64 = 0.1 * tolerance::FEASIBILITY;

/// One term of a row; the coefficient is not zero.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    /// Twice the column, plus one where the coefficient is negative: the bound at which the term is
    /// smallest.
    least: u32,
    /// Whether nothing of the term was rounded: an exact coefficient and an integral column.
    pub(super) exact: bool,
    pub(super) coefficient: f64,
}

impl Entry {
    pub(super) fn new(column: usize, coefficient: f64, integral: bool) -> Self {
        let exact = integral && is_exact(coefficient);
        Entry { least: 2 * column as u32 + u32::from(coefficient < 0.0), exact, coefficient }
    }

    #[inline]
    pub(super) fn column(&self) -> usize {
        (self.least / 2) as usize
    }

    /// The bound of the column at which the term is smallest (0) or largest (1).
    #[inline]
    fn bound(&self, bounds: &[[f64; 2]], which: usize) -> f64 {
        bounds[self.column()][(self.least as usize + which) % 2]
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
pub(super) struct PropagatedRow {
    pub(super) range: [usize; 2],
    pub(super) limits: [f64; 2],
    /// Whether it is an equality over whole numbers.
    pub(super) whole_equality: bool,
}

/// One tightened bound of a row.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tightening {
    pub(super) column: usize,
    pub(super) is_upper: bool,
    pub(super) value: f64,
}

/// The state of a row after a visit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum RowState {
    /// No point of the domain satisfies it.
    Violated,
    /// Every point of the domain satisfies it.
    Implied,
    Open,
}

/// Finds the bounds that one row tightens by more than `least_gain` of their width. Inlined,
/// because a search spends much of its time here.
#[inline(always)]
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
        [least, most].map(|finite| RowActivity { finite, infinite: 0 })
    } else {
        count_infinite(bounds, entries)
    };
    tighten_binding(integral, bounds, entries, limits, activities, least_gain, found)
}

/// Smallest and largest activity of a row with infinite terms.
fn count_infinite(bounds: &[[f64; 2]], entries: &[Entry]) -> [RowActivity; 2] {
    let mut activities = [RowActivity::default(); 2];
    for entry in entries {
        let (low, high) = entry.ends(bounds);
        activities[0].add(low);
        activities[1].add(high);
    }
    activities
}

/// As [`tighten`], for rows that may bind or have infinite activities.
#[inline]
fn tighten_binding(
    integral: &[bool],
    bounds: &[[f64; 2]],
    entries: &[Entry],
    [row_lower, row_upper]: [f64; 2],
    [least, most]: [RowActivity; 2],
    least_gain: f64,
    found: &mut Vec<Tightening>,
) -> RowState {
    let uncertainty = Uncertainty::of(bounds, entries, [row_lower, row_upper]);
    let exact = (uncertainty.plain_rounding > MAX_PLAIN_ROUNDING)
        .then(|| CompensatedSums::of(bounds, entries));
    let rounding = if exact.is_some() { uncertainty.rounding } else { uncertainty.plain_rounding };
    let ends = RowActivities { least, most, exact };
    let excess = uncertainty.excess + rounding;
    if (least.infinite == 0 && ends.left(0, row_upper) < -excess)
        || (most.infinite == 0 && ends.left(1, row_lower) > excess)
    {
        return RowState::Violated;
    }
    let upper_binds = row_upper.is_finite() && (most.infinite > 0 || ends.left(1, row_upper) < 0.0);
    let lower_binds =
        row_lower.is_finite() && (least.infinite > 0 || ends.left(0, row_lower) > 0.0);
    if !upper_binds && !lower_binds {
        return RowState::Implied;
    }
    if let [entry] = entries
        && !integral[entry.column()]
    {
        let limits = [lower_binds.then_some(row_lower), upper_binds.then_some(row_upper)];
        found.extend(limits.into_iter().enumerate().filter_map(|(side, limit)| {
            bound_of_singleton(bounds[entry.column()], entry, side == 1, limit?)
        }));
        return RowState::Open;
    }
    let mut offer = |entry: &Entry, term: f64, is_upper: bool| {
        let column = entry.column();
        let value = term / entry.coefficient;
        if !value.is_finite() || value.abs() >= tolerance::INFINITE {
            return;
        }
        found.extend(if integral[column] {
            let own = if entry.exact { 0.0 } else { largest_term(entry, bounds) };
            let slack = whole_slack(entry, value, uncertainty.soft - own);
            whole(bounds[column], column, is_upper, value, slack)
        } else if is_exact_zero(entry, value, entries, bounds, [row_lower, row_upper], is_upper) {
            worthwhile(bounds[column], column, is_upper, 0.0, 0.0, least_gain)
        } else {
            let size = value.abs().max(1.0);
            worthwhile(bounds[column], column, is_upper, value, size, least_gain)
        });
    };
    if least.infinite + most.infinite == 0 && ends.exact.is_none() {
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
            && let Some(most) = ends.room(0, entry, bounds, row_upper).map(|m| m + rounding)
            && most < high
        {
            offer(entry, most, entry.coefficient > 0.0);
        }
        if lower_binds
            && let Some(least) = ends.room(1, entry, bounds, row_lower).map(|l| l - rounding)
            && least > low
        {
            offer(entry, least, entry.coefficient < 0.0);
        }
    }
    RowState::Open
}

/// The uncertainty of a row because of rounding, in its unit.
struct Uncertainty {
    /// The sum of the largest magnitudes of terms that are not exact, and of a limit that presolve
    /// may have rounded.
    soft: f64,
    /// Accumulated rounding of an activity: of a plain sum, and of a compensated one.
    plain_rounding: f64,
    rounding: f64,
    /// The violation of the row that the uncertainty of its soft terms may cause.
    excess: f64,
}

impl Uncertainty {
    fn of(bounds: &[[f64; 2]], entries: &[Entry], [lower, upper]: [f64; 2]) -> Self {
        let (mut scale, mut soft, mut all_exact) = (0.0, 0.0, true);
        for entry in entries {
            let size = largest_term(entry, bounds);
            scale += size;
            if !entry.exact {
                (soft, all_exact) = (soft + size, false);
            }
        }
        let limit = finite_size(lower).max(finite_size(upper));
        // Presolve leaves equalities the rounding of their limits, and widens other rows by it.
        if lower == upper && !all_exact {
            soft += limit;
        }
        let scale = larger(scale, limit).max(1.0);
        let count = entries.len() as f64;
        let rounding = 1e-15 * soft * count + 64.0 * f64::EPSILON * limit;
        // Exact terms have no rounding, so their violation counts beyond the tolerance.
        let missed = tolerance::PROPAGATION_INFEASIBLE * soft;
        let excess = missed.max(tolerance::FEASIBILITY);
        Uncertainty {
            soft,
            plain_rounding: larger(1e-15 * scale * count, rounding),
            rounding,
            excess: excess.min(tolerance::PROPAGATION_INFEASIBLE * scale),
        }
    }
}

/// The largest magnitude of a term; 0 where it is infinite.
#[inline]
fn largest_term(entry: &Entry, bounds: &[[f64; 2]]) -> f64 {
    let (low, high) = entry.ends(bounds);
    larger(finite_size(low), finite_size(high))
}

/// Smallest and largest activity, and both in compensated sums where plain ones are too coarse.
struct RowActivities {
    least: RowActivity,
    most: RowActivity,
    exact: Option<CompensatedSums>,
}

/// The finite parts of the smallest and the largest activity, negated.
struct CompensatedSums([Sum; 2]);

impl CompensatedSums {
    fn of(bounds: &[[f64; 2]], entries: &[Entry]) -> Self {
        let mut sums = [Sum::default(); 2];
        for entry in entries {
            for (k, sum) in sums.iter_mut().enumerate() {
                let bound = entry.bound(bounds, k);
                if bound.is_finite() {
                    sum.add_product(-entry.coefficient, bound);
                }
            }
        }
        CompensatedSums(sums)
    }
}

impl RowActivities {
    /// A limit less the finite part of the smallest activity (0) or the largest one (1).
    fn left(&self, which: usize, limit: f64) -> f64 {
        match &self.exact {
            Some(CompensatedSums(sums)) => {
                let mut left = sums[which];
                left.add(limit);
                left.value()
            }
            None => limit - if which == 0 { self.least.finite } else { self.most.finite },
        }
    }

    /// The room between an activity without one of its terms and a limit; `None` where the rest is
    /// infinite.
    fn room(&self, which: usize, entry: &Entry, bounds: &[[f64; 2]], limit: f64) -> Option<f64> {
        let activity = if which == 0 { &self.least } else { &self.most };
        let bound = entry.bound(bounds, which);
        let Some(CompensatedSums(sums)) = &self.exact else {
            return activity.room(entry.coefficient * bound, limit);
        };
        if !activity.is_finite_without(bound) {
            return None;
        }
        let mut room = sums[which];
        if bound.is_finite() {
            room.add_product(entry.coefficient, bound);
        }
        room.add(limit);
        Some(room.value())
    }
}

/// Whether the bound of a column is exactly 0, because the row is an equation to 0 and all other
/// terms are 0. Such a bound needs no slack, which equations after this one would multiply.
///
/// # Arguments
///
/// * `value`: the bound with its rounding.
fn is_exact_zero(
    entry: &Entry,
    value: f64,
    entries: &[Entry],
    bounds: &[[f64; 2]],
    limits: [f64; 2],
    is_upper: bool,
) -> bool {
    // The upper limit meets the smallest activity.
    let of_least = is_upper == (entry.coefficient > 0.0);
    let which = usize::from(!of_least);
    value.abs() <= tolerance::PROPAGATION_SLACK
        && limits == [0.0; 2]
        && entries
            .iter()
            .all(|other| other.column() == entry.column() || other.bound(bounds, which) == 0.0)
}

/// The distance of a whole value beyond a bound of an integral column at which it still satisfies
/// the row that gives the bound: the tolerance of the row and the uncertainty of its other terms.
///
/// # Arguments
///
/// * `rest`: the sum of the soft magnitudes of the row without this term, in its unit.
#[inline]
fn whole_slack(entry: &Entry, value: f64, rest: f64) -> f64 {
    let size = entry.coefficient.abs();
    let tolerated = tolerance::INTEGRALITY.min(tolerance::FEASIBILITY / size);
    let known = tolerance::PROPAGATION_SLACK * rest.max(1.0) / size;
    let own = if entry.exact { 0.0 } else { tolerance::PROPAGATION_SLACK * value.abs() };
    tolerated + known + own + 4.0 * f64::EPSILON * value.abs()
}

/// The larger one of two numbers; the second where one is none. One instruction, unlike
/// [`f64::max`].
#[inline]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The bound that a row over one continuous column gives, if it is tighter: to the last digit,
/// because other rows may multiply the loss.
fn bound_of_singleton(
    [lower, upper]: [f64; 2],
    entry: &Entry,
    is_row_upper: bool,
    limit: f64,
) -> Option<Tightening> {
    let is_upper = is_row_upper == (entry.coefficient > 0.0);
    let value = limit / entry.coefficient;
    let value = match (value * entry.coefficient == limit, is_upper) {
        (true, _) => value,
        (false, true) => value.next_up(),
        (false, false) => value.next_down(),
    };
    let news = if is_upper { value < upper } else { value > lower };
    let is_far = value.is_nan() || value.abs() >= tolerance::INFINITE;
    (news && !is_far).then_some(Tightening { column: entry.column(), is_upper, value })
}

/// A candidate bound of an integral column: the next whole value, if it is tighter.
pub(super) fn whole(
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
///
/// # Arguments
///
/// * `size`: the magnitude of what the bound was computed from.
pub(super) fn worthwhile(
    [lower, upper]: [f64; 2],
    column: usize,
    is_upper: bool,
    value: f64,
    size: f64,
    least_gain: f64,
) -> Option<Tightening> {
    let slack = tolerance::PROPAGATION_SLACK * size;
    let value = if is_upper { value + slack } else { value - slack };
    let gain = if is_upper { upper - value } else { value - lower };
    let width = upper - lower;
    let worth = if width.is_finite() {
        (least_gain * width).max(10.0 * slack)
    } else {
        1e-3 * value.abs().max(1.0)
    };
    // If an open side runs away, the domain is empty, and no bound says so.
    let away = if is_upper { -value } else { value };
    let runs_away = width.is_infinite() && away > tolerance::FREE_RADIUS;
    if gain.is_nan() || gain <= worth || runs_away {
        return None;
    }
    Some(Tightening { column, is_upper, value })
}
