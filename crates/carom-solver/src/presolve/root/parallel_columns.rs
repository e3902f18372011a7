//! Parallel columns.
//!
//! Takes two columns of which one is a multiple of the other, including the cost; leaves one column
//! (Andersen and Andersen, Presolving in linear programming, Mathematical Programming 71, 1995).
//!
//! Rows and objective depend only on `x_j + r x_k`, which becomes one column. This is exact for
//! continuous pairs, and for integral ones with `r = 1` or `r = -1`.

use super::postsolve::{Restored, Undo};
use super::working_program::WorkingProgram;
use crate::activity::term_ends;
use crate::presolve::parallel::{self, Patterns, is_multiple};

/// A column that was `ratio` times another one.
#[derive(Debug)]
struct ParallelColumn {
    column: usize,
    kept: usize,
    ratio: f64,
    integral: bool,
    /// Bounds of the column and of the kept one before the merge.
    bounds: [f64; 2],
    kept_bounds: [f64; 2],
}

pub(super) fn apply(work: &mut WorkingProgram) -> usize {
    let mut seen = Patterns::new(work.uses.len());
    work.each_column(work.live_columns(), |work, column| {
        if work.is_held(column) || !work.is_straight(column) || work.uses[column].is_empty() {
            return 0;
        }
        let bucket = seen.bucket(work.uses[column].iter().copied());
        let kept =
            seen.candidates(bucket).find_map(|other| Some((other, ratio(work, column, other)?)));
        let Some((kept, ratio)) = kept else {
            seen.insert(column, bucket);
            return 0;
        };
        merge(work, column, kept, ratio);
        1
    })
}

/// The factor from `other` to `column`, or `None` if they cannot be merged.
fn ratio(work: &WorkingProgram, column: usize, other: usize) -> Option<f64> {
    if work.uses[column] != work.uses[other] {
        return None;
    }
    let values = |column| work.column(column).map(|(_, a)| a);
    let ratio = parallel::ratio(values(column).zip(values(other)))?;
    let same_cost = is_multiple(work.linear[column], work.linear[other], ratio);
    let kinds = match (work.integral[column], work.integral[other]) {
        (false, false) => true,
        (true, true) => ratio.abs() == 1.0,
        _ => false,
    };
    (same_cost && kinds).then_some(ratio)
}

fn merge(work: &mut WorkingProgram, column: usize, kept: usize, ratio: f64) {
    let bounds = [work.lower[column], work.upper[column]];
    let kept_bounds = [work.lower[kept], work.upper[kept]];
    let [least, most] = term_ends(ratio, bounds);
    work.lower[kept] += least;
    work.upper[kept] += most;
    let ends = [least, most, work.lower[kept], work.upper[kept]];
    let rounding =
        f64::EPSILON * ends.into_iter().filter(|end| end.is_finite()).map(f64::abs).sum::<f64>();
    work.column_noise[kept] += ratio.abs() * work.column_noise[column] + rounding;
    work.spread[kept] += ratio.abs() * work.spread[column];
    work.drop_column(column);
    let integral = work.integral[kept];
    work.push(ParallelColumn { column, kept, ratio, integral, bounds, kept_bounds });
}

impl Undo for ParallelColumn {
    /// Splits the sum: the kept column takes what it can, nearest to 0, the other one the rest.
    fn primal(&self, x: &mut [f64]) {
        let sum = x[self.kept];
        // What the kept column may be so that the column stays within its bounds.
        let (p, q) = (sum - self.ratio * self.bounds[0], sum - self.ratio * self.bounds[1]);
        let (mut low, mut high) = (p.min(q), p.max(q));
        low = low.max(self.kept_bounds[0]);
        high = high.min(self.kept_bounds[1]);
        if self.integral {
            (low, high) = (low.round(), high.round());
        }
        let own = 0.0_f64.max(low).min(high);
        x[self.kept] = own;
        x[self.column] = (sum - own) / self.ratio;
    }

    fn dual(&self, all: &mut Restored) {
        all.d[self.column] = self.ratio * all.d[self.kept];
    }
}
