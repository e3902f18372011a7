//! Singleton rows.
//!
//! Takes rows with one column; leaves its bounds (Brearley, Mitra and Williams, Analysis of
//! mathematical programming problems prior to applying the simplex algorithm, Mathematical
//! Programming 8, 1975). Empty rows are checked and dropped.

use super::postsolve::{Restored, Undo};
use super::working_program::{Infeasible, WorkingProgram};
use crate::activity::{implied_ends, term_ends};
use crate::presolve::parameters::{CONTRADICTION, IMPLIED};
use crate::tolerance::{self, finite_size};

#[derive(Debug)]
struct SingletonRow {
    row: usize,
    column: usize,
    coefficient: f64,
    /// Whether the lower, or the upper, bound of the column is the row's.
    gives: [bool; 2],
}

pub(super) fn apply(work: &mut WorkingProgram, row: usize) -> Result<usize, Infeasible> {
    match work.rows[row][..] {
        [] => {
            let (lower, upper) = (work.row_lower[row], work.row_upper[row]);
            let missed = lower.max(-upper);
            if missed > (CONTRADICTION * missed.abs().max(1.0)).max(work.row_noise[row]) {
                return Err(Infeasible);
            }
            work.drop_row(row);
        }
        [(column, _)] if work.given[column] => return Ok(0),
        [(column, a)] => {
            // A side that the column's bounds violate by rounding only is dropped, however small
            // its coefficient is: `1e-17 z <= 0` does not fix a binary.
            let [least, most] = term_ends(a, [work.lower[column], work.upper[column]]);
            let noise = work.row_noise[row];
            let margin = |limit: f64| IMPLIED.max(4.0 * f64::EPSILON * limit.abs()).max(noise);
            let (mut lower, mut upper) = (work.row_lower[row], work.row_upper[row]);
            if least >= lower - margin(lower) {
                lower = f64::NEG_INFINITY;
            }
            if most <= upper + margin(upper) {
                upper = f64::INFINITY;
            }
            [lower, upper] = implied_ends(a, [lower, upper]);
            let gives = [lower > work.lower[column], upper < work.upper[column]];
            let rounding = f64::EPSILON * finite_size(lower).max(finite_size(upper));
            let noise = noise / a.abs() + rounding;
            if work.integral[column] {
                // A whole value must satisfy the row itself: 0 is near 2e-7, and violates
                // `1e8 z >= 20`.
                let tolerated = tolerance::INTEGRALITY.min(tolerance::FEASIBILITY / a.abs());
                (lower, upper) = whole_bounds([lower, upper], tolerated.max(noise));
            }
            work.intersect(column, [lower, upper], noise)?;
            work.drop_row(row);
            if !work.integral[column] && (gives[0] || gives[1]) {
                work.push(SingletonRow { row, column, coefficient: a, gives });
            }
        }
        _ => return Ok(0),
    }
    Ok(1)
}

/// The whole numbers within some bounds, up to a slack.
fn whole_bounds([lower, upper]: [f64; 2], slack: f64) -> (f64, f64) {
    ((lower - slack).ceil(), (upper + slack).floor())
}

impl Undo for SingletonRow {
    fn dual(&self, all: &mut Restored) {
        let d = all.d[self.column];
        if (d > 0.0 && self.gives[0]) || (d < 0.0 && self.gives[1]) {
            all.y[self.row] = -d / self.coefficient;
            all.d[self.column] = 0.0;
        }
    }
}
