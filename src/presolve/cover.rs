//! Lifted cover cuts.
//!
//! In a row `sum a_j x_j <= b` over binaries, columns whose coefficients exceed `b` together (a
//! *cover*) cannot all be 1. Columns outside the cover take part with the number of its largest
//! members that they outweigh (Balas 1975). Whole points are never cut off: coefficients and limits
//! of the cuts are small whole numbers, and a set counts as a cover only if it exceeds the row's
//! limit by more than what an accepted point may miss the row by.

use super::domain::Domain;
use crate::program::{Program, Row};
use crate::tolerance;

/// Least number of open binaries in a row that is looked at, and the most.
const SIZES: std::ops::RangeInclusive<usize> = 3..=2000;

/// Least violation of a cut, in its own unit.
const VIOLATION: f64 = 1e-2;

/// By how much a cover must exceed the limit of a row of ordinary size, in the row's unit: ten times
/// what an accepted point may miss it by.
const EXCESS: f64 = 10.0 * tolerance::FEASIBILITY;

/// A binary of a knapsack row, complemented where its coefficient is negative.
#[derive(Clone, Copy)]
struct Item {
    column: usize,
    weight: f64,
    /// Its value at the point, complemented like the column.
    value: f64,
    complemented: bool,
}

/// Cover cuts that a point violates, at most two a row (one a side).
#[must_use]
pub fn separate_covers(program: &Program, domain: &Domain, point: &[f64]) -> Vec<Row> {
    let rows = (0..program.row_count()).filter(|&row| program.switch[row].is_none());
    let sides = rows.flat_map(|row| [(row, 1.0), (row, -1.0)]);
    sides.filter_map(|(row, sign)| separate(program, domain, point, row, sign)).collect()
}

/// A cut from one side of a row, `sign * row <= limit`.
fn separate(
    program: &Program,
    domain: &Domain,
    point: &[f64],
    row: usize,
    sign: f64,
) -> Option<Row> {
    let limit = sign * if sign > 0.0 { program.row_upper[row] } else { program.row_lower[row] };
    let (columns, values) = program.row(row);
    if !limit.is_finite() || columns.len() < *SIZES.start() {
        return None;
    }
    let (mut capacity, mut size, mut items) = (limit, limit.abs(), Vec::new());
    for (&column, &a) in columns.iter().zip(values) {
        let a = sign * a;
        let [lower, upper] = domain.bounds(column);
        if program.integral[column] && lower == 0.0 && upper == 1.0 {
            let complemented = a < 0.0;
            capacity -= a.min(0.0);
            let value = if complemented { 1.0 - point[column] } else { point[column] };
            items.push(Item {
                column,
                weight: a.abs(),
                value: value.clamp(0.0, 1.0),
                complemented,
            });
        } else {
            // What the column takes at least.
            capacity -= (a * lower).min(a * upper);
        }
        size += a.abs() * lower.abs().max(upper.abs());
    }
    if !size.is_finite() || !SIZES.contains(&items.len()) {
        return None;
    }
    let margin = (1e-9 * size).max(EXCESS * tolerance::row_scale(size, limit));
    let cover = minimal_cover(&mut items, capacity + margin)?;
    let cut = lifted(&items, cover);
    let activity: f64 = cut.iter().map(|(item, a)| a * item.value).sum();
    let members = cut.iter().take(cover).count() as f64;
    (activity > members - 1.0 + VIOLATION).then(|| to_row(&cut, members - 1.0))
}

/// Sorts the members of a minimal cover to the front, the heaviest first; returns their number.
fn minimal_cover(items: &mut [Item], capacity: f64) -> Option<usize> {
    let cost = |item: &Item| (1.0 - item.value) / item.weight;
    items.sort_by(|a, b| cost(a).total_cmp(&cost(b)).then(a.column.cmp(&b.column)));
    let (mut weight, mut count) = (0.0, 0);
    while weight <= capacity {
        weight += items.get(count)?.weight;
        count += 1;
    }
    // Members that are not needed leave, the least used first.
    items[..count].sort_by(|a, b| b.value.total_cmp(&a.value).then(a.column.cmp(&b.column)));
    let mut k = count;
    while k > 0 {
        k -= 1;
        if weight - items[k].weight > capacity {
            weight -= items[k].weight;
            items[k..count].rotate_left(1);
            count -= 1;
        }
    }
    let heaviest = |a: &Item, b: &Item| b.weight.total_cmp(&a.weight).then(a.column.cmp(&b.column));
    items[..count].sort_by(heaviest);
    (count >= 2).then_some(count)
}

/// The cover's members with coefficient 1, then the lifted columns with theirs.
fn lifted(items: &[Item], cover: usize) -> Vec<(Item, f64)> {
    let mut cut: Vec<(Item, f64)> = items[..cover].iter().map(|&item| (item, 1.0)).collect();
    for &item in &items[cover..] {
        // How many of the heaviest members it outweighs together.
        let (mut heaviest, mut count) = (0.0, 0.0);
        for member in &items[..cover] {
            heaviest += member.weight;
            // Rounding of the sum must not lift too far.
            if heaviest * (1.0 + 1e-12) > item.weight {
                break;
            }
            count += 1.0;
        }
        if count > 0.0 {
            cut.push((item, count));
        }
    }
    cut
}

/// The cut `sum <= limit` in the program's columns.
fn to_row(cut: &[(Item, f64)], mut limit: f64) -> Row {
    let mut terms = Vec::with_capacity(cut.len());
    for (item, a) in cut {
        if item.complemented {
            limit -= a;
            terms.push((item.column, -a));
        } else {
            terms.push((item.column, *a));
        }
    }
    terms.sort_by_key(|t| t.0);
    Row { terms, lower: f64::NEG_INFINITY, upper: limit, switch: None }
}
