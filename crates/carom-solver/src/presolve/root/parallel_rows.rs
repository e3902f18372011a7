//! Parallel rows.
//!
//! Takes two rows of which one is a multiple of the other; leaves one row with the tighter limits
//! of both (Tomlin and Welch, Finding duplicate rows in a linear programming model, Operations
//! Research Letters 5, 1986).

use super::postsolve::{Restored, Undo};
use super::working_program::{Infeasible, WorkingProgram};
use crate::activity::implied_ends;
use crate::presolve::parallel::{self, Patterns};

/// A row that was `ratio` times another one.
#[derive(Debug)]
struct ParallelRow {
    row: usize,
    kept: usize,
    ratio: f64,
    /// Whether the lower, or the upper, limit of the kept row is now this row's.
    gives: [bool; 2],
}

pub(super) fn apply(work: &mut WorkingProgram) -> Result<usize, Infeasible> {
    let mut seen = Patterns::new(work.rows.len());
    work.each_row(|work, row| {
        if work.rows[row].is_empty() {
            return Ok(0);
        }
        let bucket = seen.bucket(work.rows[row].iter().map(|&(j, _)| j));
        let kept =
            seen.candidates(bucket).find_map(|other| Some((other, ratio(work, row, other)?)));
        let Some((kept, ratio)) = kept else {
            seen.insert(row, bucket);
            return Ok(0);
        };
        let [lower, upper] = implied_ends(ratio, [work.row_lower[row], work.row_upper[row]]);
        let gives = [lower > work.row_lower[kept], upper < work.row_upper[kept]];
        work.row_lower[kept] = work.row_lower[kept].max(lower);
        work.row_upper[kept] = work.row_upper[kept].min(upper);
        work.row_noise[kept] = work.row_noise[kept].max(work.row_noise[row] / ratio.abs());
        work.add_rounding(kept, 0.0);
        work.settle_row(kept)?;
        work.drop_row(row);
        work.push(ParallelRow { row, kept, ratio, gives });
        Ok(1)
    })
}

/// The factor from `other` to `row`, or `None` if they are not parallel.
fn ratio(work: &WorkingProgram, row: usize, other: usize) -> Option<f64> {
    let (one, two) = (&work.rows[row], &work.rows[other]);
    let same = one.len() == two.len() && one.iter().zip(two).all(|(a, b)| a.0 == b.0);
    same.then(|| parallel::ratio(one.iter().zip(two).map(|(a, b)| (a.1, b.1))))?
}

impl Undo for ParallelRow {
    fn dual(&self, all: &mut Restored) {
        let y = all.y[self.kept];
        if (y > 0.0 && self.gives[1]) || (y < 0.0 && self.gives[0]) {
            all.y[self.row] = y / self.ratio;
            all.y[self.kept] = 0.0;
        }
    }
}
