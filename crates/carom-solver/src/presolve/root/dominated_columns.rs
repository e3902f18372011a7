//! Dominated columns.
//!
//! Takes columns whose reduced cost has a known sign; leaves them fixed at a bound (Andersen and
//! Andersen, Presolving in linear programming, Mathematical Programming 71, 1995).
//!
//! If multipliers have known signs (such as that of a row without an upper limit), so do reduced
//! costs: a column that no row holds back goes to the bound that its cost prefers ("dual fixing").
//! Columns without a finite bound on one side have a reduced cost of one sign in every optimum,
//! which bounds the multipliers of their rows, and with them the reduced costs of other columns:
//! those are dominated.
//!
//! If the objective is unbounded, there is no optimum, so the second step requires a lower bound of
//! the objective that follows from costs and bounds.
//!
//! Columns of cones are no candidates. Signs are enough for others, because a column that moves
//! alone changes no cone; but a program with cones may have an optimum without multipliers, so it
//! ends there.
//!
//! A column with curvature has a slope for each point within the bounds; if all of them have one
//! sign, the same holds of its movement alone.
//!
//! For an integral column the argument is the same: the optimal value as a function of the column
//! is convex, and its slopes are the reduced costs.

use super::fixed_columns::fix;
use super::working_program::WorkingProgram;
use crate::activity::{implied_ends, term_ends};

/// The distance of a reduced cost from 0 at which its sign counts, relative to its terms, if bounds
/// of multipliers were computed. Signs alone are exact.
const REDUCED_COST_MARGIN: f64 = 1e-9;

/// The rounding of the slope of a curved objective, relative to the sum of the magnitudes of its
/// terms.
const CURVED_ROUNDING: f64 = 1e-13;

/// The largest number of rounds that tighten the bounds of multipliers.
const MAX_MULTIPLIER_ROUNDS: usize = 3;

pub(super) fn apply(work: &mut WorkingProgram) -> usize {
    let mut changes = 0;
    // Each column fixed by signs alone is decided by the rows as they are; fixing one only takes
    // entries away.
    for column in work.live_columns() {
        if work.is_late(work.uses[column].len()) {
            return changes;
        }
        let found = decided(work, column, signs(work), 0.0);
        if let Some(value) = found {
            fix(work, column, value);
            changes += 1;
        }
    }
    // Programs with cones may have no multipliers.
    if changes > 0 || !work.cones.is_empty() || !is_bounded(work) {
        return changes;
    }
    let multipliers = multipliers(work);
    let dominated: Vec<(usize, f64)> = work
        .live_columns()
        .into_iter()
        .filter_map(|j| Some((j, decided(work, j, |row| multipliers[row], REDUCED_COST_MARGIN)?)))
        .collect();
    // One at a time: the argument for the next column needs the program without this one.
    if let Some(&(column, value)) = dominated.first() {
        fix(work, column, value);
        changes += 1;
    }
    changes
}

/// Whether the bounds alone keep the objective from falling forever; its curvature only raises it.
fn is_bounded(work: &WorkingProgram) -> bool {
    work.live_columns().into_iter().all(|j| {
        let cost = work.linear[j];
        (cost <= 0.0 || work.lower[j].is_finite()) && (cost >= 0.0 || work.upper[j].is_finite())
    })
}

/// The smallest and the largest multiplier of a row that its limits allow.
fn signs(work: &WorkingProgram) -> impl Fn(usize) -> [f64; 2] + Copy + '_ {
    |row| {
        let most = if work.row_upper[row].is_finite() { f64::INFINITY } else { 0.0 };
        let least = if work.row_lower[row].is_finite() { f64::NEG_INFINITY } else { 0.0 };
        [least, most]
    }
}

/// The value to fix a column at, from the known sign of its reduced cost; `None` if there is none.
fn decided(
    work: &WorkingProgram,
    column: usize,
    multiplier: impl Fn(usize) -> [f64; 2] + Copy,
    margin: f64,
) -> Option<f64> {
    // Bounds of multipliers belong to an optimum, where curvature leaves the reduced cost no sign.
    if work.is_held(column) || (margin > 0.0 && !work.is_straight(column)) {
        return None;
    }
    let [least, most] = reduced_cost(work, column, multiplier, None);
    let [fall, rise] = slopes(work, column);
    let [least, most] = [least + fall, most + rise];
    if least == f64::NEG_INFINITY && most == f64::INFINITY {
        return None;
    }
    let margin = margin * scale(work, column, multiplier);
    let (lower, upper) = (work.lower[column], work.upper[column]);
    let cheap = least == 0.0 && most == 0.0;
    let value = if cheap && margin == 0.0 {
        0.0_f64.max(lower).min(upper)
    } else if least >= margin {
        lower
    } else if most <= -margin {
        upper
    } else {
        return None;
    };
    value.is_finite().then_some(value)
}

/// Least and largest reduced cost of a column, leaving one row out.
fn reduced_cost(
    work: &WorkingProgram,
    column: usize,
    multiplier: impl Fn(usize) -> [f64; 2],
    without: Option<usize>,
) -> [f64; 2] {
    let mut range = [work.linear[column]; 2];
    for (row, a) in work.column(column).filter(|(row, _)| Some(*row) != without) {
        let [p, q] = multiplier(row).map(|y| if y == 0.0 { 0.0 } else { a * y });
        range[0] += p.min(q);
        range[1] += p.max(q);
        if range == [f64::NEG_INFINITY, f64::INFINITY] {
            break;
        }
    }
    range
}

/// Least and largest slope that the curvature of the objective adds to the cost of a column within
/// the bounds; of both signs also the rounding of the sum. For a column with two values it is that
/// from one to the other.
fn slopes(work: &WorkingProgram, column: usize) -> [f64; 2] {
    let (mut range, mut size) = ([0.0; 2], work.linear[column].abs());
    let [lower, upper] = [work.lower[column], work.upper[column]];
    let has_two_values = work.integral[column] && upper - lower == 1.0;
    for (&other, &p) in &work.quadratic[column] {
        let ends = match other == column && has_two_values {
            true => [0.5 * (lower + upper); 2],
            false => [work.lower[other], work.upper[other]],
        };
        let [low, high] = term_ends(p, ends);
        range = [range[0] + low, range[1] + high];
        size += low.abs().max(high.abs());
    }
    // Terms that do not cancel leave the sign of the sum.
    let cost = work.linear[column];
    let rounding = if size.is_finite() { CURVED_ROUNDING * size } else { 0.0 };
    let is_mixed = |end: f64| end != 0.0 && end.is_finite() && (end < 0.0) != (cost < 0.0);
    [
        range[0] - if is_mixed(range[0]) || range[0] < 0.0 { rounding } else { 0.0 },
        range[1] + if is_mixed(range[1]) || range[1] > 0.0 { rounding } else { 0.0 },
    ]
}

/// The size of a reduced cost's finite terms, at least that of the cost.
fn scale(work: &WorkingProgram, column: usize, multiplier: impl Fn(usize) -> [f64; 2]) -> f64 {
    let terms = work.column(column).flat_map(|(row, a)| {
        multiplier(row).map(|y| if y.is_finite() { (a * y).abs() } else { 0.0 })
    });
    terms.fold(work.linear[column].abs().max(1e-6), f64::max)
}

/// Bounds of the multipliers of every optimum: signs, then the reduced costs of continuous columns
/// that miss a bound.
fn multipliers(work: &WorkingProgram) -> Vec<[f64; 2]> {
    let sign = signs(work);
    let mut bounds: Vec<[f64; 2]> = (0..work.rows.len()).map(sign).collect();
    let open: Vec<usize> = work
        .live_columns()
        .into_iter()
        .filter(|&j| {
            let missing = work.lower[j].is_infinite() || work.upper[j].is_infinite();
            missing && !work.integral[j] && work.is_straight(j)
        })
        .collect();
    for _ in 0..MAX_MULTIPLIER_ROUNDS {
        let mut changed = false;
        for &column in &open {
            // d <= 0 without a lower bound, d >= 0 without an upper one.
            let limits = [
                if work.upper[column].is_infinite() { 0.0 } else { f64::NEG_INFINITY },
                if work.lower[column].is_infinite() { 0.0 } else { f64::INFINITY },
            ];
            for (row, a) in work.column(column) {
                let rest = reduced_cost(work, column, |i| bounds[i], Some(row));
                let [p, q] = implied_ends(a, [limits[0] - rest[1], limits[1] - rest[0]]);
                // Loosened by a rounding; quotients that are not numbers compare false.
                let rounding = |value: f64| 1e-9 * value.abs().max(1.0);
                if p.is_finite() && p - rounding(p) > bounds[row][0] {
                    (bounds[row][0], changed) = (p - rounding(p), true);
                }
                if q.is_finite() && q + rounding(q) < bounds[row][1] {
                    (bounds[row][1], changed) = (q + rounding(q), true);
                }
            }
        }
        if !changed {
            break;
        }
    }
    bounds
}
