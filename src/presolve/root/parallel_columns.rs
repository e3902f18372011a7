//! Columns that are multiples of another one, cost included, are merged into it.
//!
//! `x_j + r x_k` is one column as far as rows and objective can tell. Continuous pairs, and integral
//! ones with `r = 1` or `r = -1`, lose nothing by it.

use super::parallel_rows::PARALLEL;
use super::patterns::Patterns;
use super::postsolve::{Restored, Undo};
use super::work::Work;

/// A column that was `ratio` times another one.
#[derive(Debug)]
struct ParallelColumn {
    column: usize,
    twin: usize,
    ratio: f64,
    integral: bool,
    /// Bounds of the column and of its twin before.
    bounds: [f64; 2],
    twin_bounds: [f64; 2],
}

pub(super) fn apply(work: &mut Work) -> usize {
    let mut seen = Patterns::new(work.uses.len());
    let mut changes = 0;
    for column in work.live_columns() {
        if work.is_late(work.uses[column].len()) {
            break;
        }
        if !work.is_straight(column) || work.uses[column].is_empty() {
            continue;
        }
        let fingerprint = Patterns::fingerprint(work.uses[column].iter().copied());
        let twin = seen
            .candidates(fingerprint)
            .find_map(|other| Some((other, ratio(work, column, other)?)));
        match twin {
            Some((twin, ratio)) => {
                merge(work, column, twin, ratio);
                changes += 1;
            }
            None => seen.note(column, fingerprint),
        }
    }
    changes
}

/// The factor from `other` to `column`, when they can be merged.
fn ratio(work: &Work, column: usize, other: usize) -> Option<f64> {
    if work.uses[column] != work.uses[other] {
        return None;
    }
    let (one, two) = (work.column(column), work.column(other));
    let ratio = one.first()?.1 / two.first()?.1;
    let close = |a: f64, b: f64| (a - ratio * b).abs() <= PARALLEL * a.abs();
    let parallel = one.iter().zip(&two).all(|(a, b)| close(a.1, b.1));
    let same_cost = close(work.linear[column], work.linear[other]);
    let kinds = match (work.integral[column], work.integral[other]) {
        (false, false) => true,
        (true, true) => ratio.abs() == 1.0,
        _ => false,
    };
    (parallel && same_cost && kinds).then_some(ratio)
}

fn merge(work: &mut Work, column: usize, twin: usize, ratio: f64) {
    let bounds = [work.lower[column], work.upper[column]];
    let twin_bounds = [work.lower[twin], work.upper[twin]];
    let (p, q) = (ratio * bounds[0], ratio * bounds[1]);
    work.lower[twin] += p.min(q);
    work.upper[twin] += p.max(q);
    work.drop_column(column);
    let integral = work.integral[twin];
    work.push(ParallelColumn { column, twin, ratio, integral, bounds, twin_bounds });
}

impl Undo for ParallelColumn {
    /// Splits the sum: the twin takes what it can, nearest to 0, the column the rest.
    fn primal(&self, x: &mut [f64]) {
        let sum = x[self.twin];
        // What the twin may be so that the column stays within its bounds.
        let (p, q) = (sum - self.ratio * self.bounds[0], sum - self.ratio * self.bounds[1]);
        let (mut low, mut high) = (p.min(q), p.max(q));
        low = low.max(self.twin_bounds[0]);
        high = high.min(self.twin_bounds[1]);
        if self.integral {
            (low, high) = (low.round(), high.round());
        }
        let own = 0.0_f64.max(low).min(high);
        x[self.twin] = own;
        x[self.column] = (sum - own) / self.ratio;
    }

    fn dual(&self, all: &mut Restored) {
        all.d[self.column] = self.ratio * all.d[self.twin];
    }
}
