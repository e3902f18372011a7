//! Activities of rows over the bounds of the program, and the bounds that a row implies.

use super::working_program::WorkingProgram;
use crate::activity::{implied_ends, term_ends};
use crate::presolve::coefficients::is_exact;
use crate::tolerance::finite_size;

/// Least and largest value of a sum over some bounds; infinite ends included.
#[derive(Debug, Clone, Copy)]
pub(super) struct ActivityRange {
    pub(super) least: f64,
    pub(super) most: f64,
    /// The largest magnitude of a finite term.
    pub(super) scale: f64,
    /// The same of terms that are not exact, whose coefficients or columns may have been rounded.
    pub(super) soft: f64,
    /// The largest error of either end from rounding.
    pub(super) noise: f64,
}

impl WorkingProgram {
    /// The activity of some terms over the bounds.
    pub(super) fn range<'a>(&self, terms: impl Iterator<Item = &'a (usize, f64)>) -> ActivityRange {
        let mut range = ActivityRange { least: 0.0, most: 0.0, scale: 1.0, soft: 1.0, noise: 0.0 };
        for &(j, a) in terms {
            let exact = self.integral[j] && is_exact(a);
            let [low, high] = term_ends(a, [self.lower[j], self.upper[j]]);
            range.least += low;
            range.most += high;
            let size = finite_size(low).max(finite_size(high));
            range.scale = range.scale.max(size);
            range.soft = if exact { range.soft } else { range.soft.max(size) };
            range.noise += a.abs() * self.column_noise[j];
        }
        range
    }

    /// The bounds that a row implies for one of its columns, and the activity of its other terms.
    pub(super) fn implied_bounds(&self, row: usize, column: usize) -> ([f64; 2], ActivityRange) {
        let rest = self.range(self.rows[row].iter().filter(|(j, _)| *j != column));
        let limits = [self.row_lower[row] - rest.most, self.row_upper[row] - rest.least];
        (implied_ends(self.coefficient(row, column), limits), rest)
    }
}
