//! Mixed-integer rounding of aggregated rows.
//!
//! Takes a relaxed point and the rows of a program; leaves cuts that the point violates (Marchand
//! and Wolsey, Aggregation and mixed integer rounding to solve MIPs, Operations Research 49, 2001).
//!
//! A row is an equality with a slack. Continuous columns far from their bounds are eliminated with
//! further rows, up to a few; each aggregate is rounded in both directions (`rounding`).

use super::cut::Cut;
use super::parameters::CUTS;
use super::rounding::{Aggregate, Rounder};
use super::separated_point::SeparatedPoint;
use crate::presolve::Domain;
use crate::program::Program;
use crate::solver::StopToken;
use crate::tolerance::largest_magnitude;

/// Most rows of an aggregate.
pub const MOST_ROWS: usize = 6;

/// Cuts by rounding that a point violates, from aggregates of at most `rows` rows.
pub fn mixed_integer_rounding_cuts(
    program: &Program,
    domain: &Domain,
    x: &[f64],
    rows: usize,
    token: &StopToken,
) -> Vec<Cut> {
    let point = &SeparatedPoint::new(program, domain, x);
    let (mut cuts, mut rounder) = (Vec::new(), Rounder::default());
    let (mut aggregate, mut other) = (Aggregate::default(), Aggregate::default());
    let (mut sum, mut open, mut used) = (Vec::new(), Vec::new(), Vec::new());
    for start in (0..program.row_count()).take(CUTS.start_rows) {
        if !aggregate.set_to_row(point, start) {
            continue;
        }
        let rows = if is_loose(point, start, &aggregate) { 1 } else { rows };
        used.clear();
        used.push(start);
        loop {
            if token.spend(100 * aggregate.terms.len()) {
                return cuts;
            }
            cuts.extend(best_rounding(point, &aggregate, &mut rounder));
            if used.len() >= rows || aggregate.terms.len() > CUTS.aggregate_entries {
                break;
            }
            let Some((column, row)) = next(point, &aggregate, &used, &mut open) else { break };
            if !other.set_to_row(point, row) {
                break;
            }
            aggregate.eliminate(column, &other, &mut sum);
            used.push(row);
        }
    }
    cuts
}

/// Whether the slack of an aggregate's first row is so large that other rows hardly make a cut of
/// it.
fn is_loose(point: &SeparatedPoint<'_>, row: usize, aggregate: &Aggregate) -> bool {
    let largest = largest_magnitude(aggregate.terms.iter().map(|term| term.1));
    point.slack(row) > CUTS.start_slack * largest
}

/// The better of the roundings of an aggregate and of its negative.
pub(super) fn best_rounding(
    point: &SeparatedPoint<'_>,
    aggregate: &Aggregate,
    rounder: &mut Rounder,
) -> Option<Cut> {
    let rounded = [1.0, -1.0].into_iter().filter_map(|sign| rounder.round(point, aggregate, sign));
    rounded.max_by(|a, b| a.depth(point.x).total_cmp(&b.depth(point.x)))
}

/// The continuous column to eliminate, and the row to do it with.
fn next(
    point: &SeparatedPoint<'_>,
    aggregate: &Aggregate,
    used: &[usize],
    open: &mut Vec<(usize, f64)>,
) -> Option<(usize, usize)> {
    let program = point.program;
    let n = program.column_count();
    let keys = aggregate.terms.iter().map(|&(key, _)| key);
    let columns = keys.filter(|&j| j < n && !program.integral[j]);
    let distances = columns.map(|j| (j, point.distance(j)));
    open.clear();
    open.extend(distances.filter(|(_, distance)| *distance > CUTS.bound_distance));
    open.sort_unstable_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    open.iter().find_map(|&(column, _)| {
        let rows = program.column(column).0.iter().copied();
        let fit = rows.filter(|row| !used.contains(row) && point.is_fit(*row));
        let best = fit.min_by(|&a, &b| {
            let length = |row: usize| program.row(row).0.len();
            let slack = |row| slack(point, row);
            slack(a).total_cmp(&slack(b)).then(length(a).cmp(&length(b))).then(a.cmp(&b))
        });
        best.map(|row| (column, row))
    })
}

/// The slack of a row at the point; slight ones count as none.
fn slack(point: &SeparatedPoint<'_>, row: usize) -> f64 {
    let slack = point.slack(row);
    if slack <= CUTS.bound_distance { 0.0 } else { slack }
}

impl Aggregate {
    /// Becomes a row with its slack: `a'x + s = upper`, or `-a'x + s = -lower` if that side is
    /// nearer; `false` if it has none.
    pub(super) fn set_to_row(&mut self, point: &SeparatedPoint<'_>, row: usize) -> bool {
        let program = point.program;
        let (columns, values) = program.row(row);
        let (lower, upper) = (program.row_lower[row], program.row_upper[row]);
        if columns.is_empty() || (lower.is_infinite() && upper.is_infinite()) {
            return false;
        }
        let sign = point.slack_sign(row);
        self.terms.clear();
        self.terms.extend(columns.iter().zip(values).map(|(&j, &a)| (j, sign * a)));
        if lower != upper {
            self.terms.push((program.column_count() + row, 1.0));
        }
        self.noise = CUTS.row_accuracy * largest_magnitude(values);
        self.right = if sign > 0.0 { upper } else { -lower };
        let reaches = columns.iter().zip(values).map(|(&j, a)| a.abs() * point.reach(j));
        self.size = reaches.fold(self.right.abs(), f64::max);
        self.rows.clear();
        self.rows.push((row, 1.0));
        true
    }

    /// Eliminates a column with another aggregate; `sum` is memory.
    pub(super) fn eliminate(
        &mut self,
        column: usize,
        other: &Aggregate,
        sum: &mut Vec<(usize, f64)>,
    ) {
        let coefficient = |of: &Aggregate| {
            let place = of.terms.binary_search_by_key(&column, |&(key, _)| key);
            place.ok().map(|place| of.terms[place].1)
        };
        let (Some(a), Some(b)) = (coefficient(self), coefficient(other)) else { return };
        let factor = -a / b;
        sum.clear();
        let (mut own, mut more) = (self.terms.iter().peekable(), other.terms.iter().peekable());
        while let Some(key) = smaller(own.peek(), more.peek()) {
            let old = own.next_if(|term| term.0 == key).map_or(0.0, |term| term.1);
            let new = more.next_if(|term| term.0 == key).map_or(0.0, |term| factor * term.1);
            let total = old + new;
            // What is left of two terms that cancel is rounding.
            let cancelled = new != 0.0 && total.abs() <= 1e-12 * old.abs().max(new.abs());
            if key != column && !cancelled {
                sum.push((key, total));
            }
        }
        std::mem::swap(&mut self.terms, sum);
        self.right += factor * other.right;
        self.noise += factor.abs() * other.noise;
        self.size += factor.abs() * other.size;
        self.rows.extend(other.rows.iter().map(|&(row, a)| (row, factor * a)));
    }
}

/// The smaller key of two terms.
fn smaller(a: Option<&&(usize, f64)>, b: Option<&&(usize, f64)>) -> Option<usize> {
    a.into_iter().chain(b).map(|term| term.0).min()
}
