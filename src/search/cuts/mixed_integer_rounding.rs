//! Mixed-integer rounding of aggregated rows (Marchand and Wolsey 2001).
//!
//! A row is an equality with a slack. Continuous columns far from their bounds are eliminated with
//! further rows, up to a few; each aggregate is rounded in both directions (`rounding`).

use std::collections::BTreeMap;

use super::cut::{Cut, reach};
use super::rounding::{Substitutes, round};
use crate::presolve::Domain;
use crate::program::Program;
use crate::solver::StopToken;

/// Most rows of an aggregate.
pub const ROWS: usize = 6;

/// Longest aggregate, in entries.
const LONGEST: usize = 300;

/// Most rows from which aggregates are started.
const STARTS: usize = 2000;

/// Distance from its bounds below which a column is not worth eliminating.
const NEAR: f64 = 1e-6;

/// Accuracy to which the coefficients of a row are taken to be known, relative to its largest.
const ACCURACY: f64 = 1e-10;

/// An aggregate `sum of terms = right side`; terms past the columns are slacks of rows.
#[derive(Debug, Clone)]
pub(super) struct Aggregate {
    pub(super) terms: BTreeMap<usize, f64>,
    pub(super) right: f64,
    /// How accurately the coefficients are known: rows that nearly cancel leave little else.
    pub(super) noise: f64,
    /// The sum over its rows of the largest magnitude of a term or side, with what has cancelled.
    pub(super) size: f64,
}

/// Cuts by rounding that a point violates, from aggregates of at most `rows` rows.
pub fn mixed_integer_rounding_cuts(
    program: &Program,
    domain: &Domain,
    x: &[f64],
    rows: usize,
    token: &StopToken,
) -> Vec<Cut> {
    let substitutes = Substitutes::new(program, domain, x);
    let mut cuts = Vec::new();
    for start in (0..program.row_count()).take(STARTS) {
        let Some(mut aggregate) = equality(program, domain, start, x) else { continue };
        let mut used = vec![start];
        loop {
            if token.spend(100 * aggregate.terms.len()) {
                return cuts;
            }
            cuts.extend(best_rounding(program, domain, x, &substitutes, &aggregate));
            if used.len() >= rows || aggregate.terms.len() > LONGEST {
                break;
            }
            let Some((column, row)) = next(program, &substitutes, &aggregate, x, &used) else {
                break;
            };
            let Some(other) = equality(program, domain, row, x) else { break };
            eliminate(&mut aggregate, column, other);
            used.push(row);
        }
    }
    cuts
}

/// A row with its slack: `a'x + s = upper`, or `-a'x + s = -lower` if that side is nearer.
fn equality(program: &Program, domain: &Domain, row: usize, x: &[f64]) -> Option<Aggregate> {
    let (columns, values) = program.row(row);
    let (lower, upper) = (program.row_lower[row], program.row_upper[row]);
    if columns.is_empty() || (lower.is_infinite() && upper.is_infinite()) {
        return None;
    }
    let sign = slack_sign(program, row, x);
    let terms = columns.iter().zip(values).map(|(&j, &a)| (j, sign * a));
    let mut terms: BTreeMap<usize, f64> = terms.collect();
    if lower != upper {
        terms.insert(program.column_count() + row, 1.0);
    }
    let noise = ACCURACY * values.iter().fold(0.0_f64, |most, a| most.max(a.abs()));
    let right = if sign > 0.0 { upper } else { -lower };
    let reaches =
        columns.iter().zip(values).map(|(&j, a)| a.abs() * reach(domain, j).max(x[j].abs()));
    let size = reaches.fold(right.abs(), f64::max);
    Some(Aggregate { terms, right, noise, size })
}

/// Which side of a row its slack is measured from: `1` for the upper one.
pub(super) fn slack_sign(program: &Program, row: usize, x: &[f64]) -> f64 {
    let (lower, upper) = (program.row_lower[row], program.row_upper[row]);
    let activity = program.activity(row, x);
    if upper - activity <= activity - lower { 1.0 } else { -1.0 }
}

/// The better of the roundings of an aggregate and of its negative.
fn best_rounding(
    program: &Program,
    domain: &Domain,
    x: &[f64],
    substitutes: &Substitutes,
    aggregate: &Aggregate,
) -> Option<Cut> {
    let rounded = [1.0, -1.0].into_iter().filter_map(|sign| {
        let terms = aggregate.terms.iter().map(|(&k, a)| (k, sign * a)).collect();
        let one = Aggregate { terms, right: sign * aggregate.right, ..*aggregate };
        round(program, domain, x, substitutes, &one)
    });
    rounded.max_by(|a, b| a.depth(x).total_cmp(&b.depth(x)))
}

/// The continuous column to eliminate, and the row to do it with.
fn next(
    program: &Program,
    substitutes: &Substitutes,
    aggregate: &Aggregate,
    x: &[f64],
    used: &[usize],
) -> Option<(usize, usize)> {
    let n = program.column_count();
    let mut open: Vec<(usize, f64)> = aggregate
        .terms
        .keys()
        .filter(|&&j| j < n && !program.integral[j])
        .map(|&j| (j, substitutes.distance(j)))
        .filter(|(_, distance)| *distance > NEAR)
        .collect();
    open.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    open.into_iter().find_map(|(column, _)| {
        let rows = program.column(column).0.iter().copied();
        let fit = rows.filter(|row| !used.contains(row) && is_fit(program, *row));
        let best = fit.min_by(|&a, &b| {
            let slack = |row| slack(program, row, x);
            let length = |row: usize| program.row(row).0.len();
            slack(a).total_cmp(&slack(b)).then(length(a).cmp(&length(b))).then(a.cmp(&b))
        });
        best.map(|row| (column, row))
    })
}

/// Whether a row can be aggregated: it has a limit, and is no variable bound, which is put in anyway.
fn is_fit(program: &Program, row: usize) -> bool {
    let whole = |&j: &usize| program.integral[j];
    let columns = program.row(row).0;
    let variable_bound = columns.len() == 2 && columns.iter().any(whole);
    let limited = program.row_lower[row].is_finite() || program.row_upper[row].is_finite();
    limited && !variable_bound
}

/// The slack of a row at a point; slight ones count as none.
fn slack(program: &Program, row: usize, x: &[f64]) -> f64 {
    let activity = program.activity(row, x);
    let slack = (program.row_upper[row] - activity).min(activity - program.row_lower[row]);
    if slack <= NEAR { 0.0 } else { slack }
}

fn eliminate(aggregate: &mut Aggregate, column: usize, other: Aggregate) {
    let (Some(&a), Some(&b)) = (aggregate.terms.get(&column), other.terms.get(&column)) else {
        return;
    };
    let factor = -a / b;
    for (k, value) in other.terms {
        let entry = aggregate.terms.entry(k).or_insert(0.0);
        let size = entry.abs().max((factor * value).abs());
        *entry += factor * value;
        if entry.abs() <= 1e-12 * size {
            aggregate.terms.remove(&k);
        }
    }
    aggregate.terms.remove(&column);
    aggregate.right += factor * other.right;
    aggregate.noise += factor.abs() * other.noise;
    aggregate.size += factor.abs() * other.size;
}
