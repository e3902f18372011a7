//! Rows that are multiples of another one are merged into it.

use super::Infeasible;
use super::patterns::Patterns;
use super::postsolve::{Restored, Undo};
use super::work::Work;

/// Relative difference up to which two quotients of coefficients count as equal.
pub(super) const PARALLEL: f64 = 1e-13;

/// A row that was `ratio` times another one.
#[derive(Debug)]
struct ParallelRow {
    row: usize,
    twin: usize,
    ratio: f64,
    /// Whether the lower, or the upper, limit of the twin is now this row's.
    gives: [bool; 2],
}

pub(super) fn apply(work: &mut Work) -> Result<usize, Infeasible> {
    let mut seen = Patterns::new(work.rows.len());
    let mut changes = 0;
    for row in work.live_rows() {
        if work.is_late(work.rows[row].len()) {
            break;
        }
        if work.rows[row].is_empty() {
            continue;
        }
        let fingerprint = Patterns::fingerprint(work.rows[row].iter().map(|&(j, _)| j));
        let twin =
            seen.candidates(fingerprint).find_map(|other| Some((other, ratio(work, row, other)?)));
        let Some((twin, ratio)) = twin else {
            seen.note(row, fingerprint);
            continue;
        };
        let (p, q) = (work.row_lower[row] / ratio, work.row_upper[row] / ratio);
        let (lower, upper) = (p.min(q), p.max(q));
        let gives = [lower > work.row_lower[twin], upper < work.row_upper[twin]];
        work.row_lower[twin] = work.row_lower[twin].max(lower);
        work.row_upper[twin] = work.row_upper[twin].min(upper);
        work.settle_row(twin)?;
        work.drop_row(row);
        work.push(ParallelRow { row, twin, ratio, gives });
        changes += 1;
    }
    Ok(changes)
}

/// The factor from `other` to `row`, when there is one.
fn ratio(work: &Work, row: usize, other: usize) -> Option<f64> {
    let (one, two) = (&work.rows[row], &work.rows[other]);
    let ratio = one.first()?.1 / two.first()?.1;
    let parallel = |(a, b): (&(usize, f64), &(usize, f64))| {
        a.0 == b.0 && (a.1 - ratio * b.1).abs() <= PARALLEL * a.1.abs()
    };
    (one.len() == two.len() && one.iter().zip(two).all(parallel)).then_some(ratio)
}

impl Undo for ParallelRow {
    fn primal(&self, _: &mut [f64]) {}

    fn dual(&self, all: &mut Restored) {
        let y = all.y[self.twin];
        if (y > 0.0 && self.gives[1]) || (y < 0.0 && self.gives[0]) {
            all.y[self.row] = y / self.ratio;
            all.y[self.twin] = 0.0;
        }
    }
}
