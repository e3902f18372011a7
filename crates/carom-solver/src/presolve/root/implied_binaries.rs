//! Implied binaries.
//!
//! Takes continuous columns between 0 and 1 that are whole in some optimum; leaves them as binaries
//! (Achterberg, Bixby, Gu, Rothberg and Weninger, Presolve reductions in mixed integer programming,
//! INFORMS Journal on Computing 32, 2020). Their upper bound may be implied by a row, as that of
//! `x <= z`.
//!
//! If nothing but rows over integers keeps a column from rising, and its cost lets it rise, it can
//! be where the first of these rows holds it, which is a whole number. Multipliers are not
//! restored: programs with integers have none. So a column that stands for
//! a conjunction, `x <= z_1` and `x <= z_2`, is a binary: rows over it say "at least one of these".

use super::units::{is_power, scale_column};
use super::working_program::WorkingProgram;
use crate::presolve::coefficients::is_whole;

pub(super) fn apply(work: &mut WorkingProgram) -> usize {
    // A continuous program stays one.
    if !work.live_columns().iter().any(|&j| work.integral[j]) {
        return 0;
    }
    work.each_column(work.live_columns(), make_whole)
}

fn make_whole(work: &mut WorkingProgram, column: usize) -> usize {
    let open = work.lower[column] == 0.0
        && !work.integral[column]
        && !work.is_held(column)
        && work.is_straight(column);
    if !open || work.uses[column].is_empty() {
        return 0;
    }
    let Some(unit) = unit(work, column) else { return 0 };
    let cost = work.linear[column];
    let whole = (cost <= 0.0 && ends_whole(work, column, unit, true))
        || (cost >= 0.0 && ends_whole(work, column, unit, false));
    if whole {
        if unit != 1.0 {
            scale_column(work, column, 1.0 / unit);
        }
        (work.integral[column], work.upper[column]) = (true, 1.0);
    }
    usize::from(whole)
}

/// The largest value of a column that may be 0 or this: 1 or, in other units, a power of two.
fn unit(work: &WorkingProgram, column: usize) -> Option<f64> {
    let upper = work.upper[column];
    if upper == 1.0 || upper > 1.0 && is_at_most_one(work, column) {
        return Some(1.0);
    }
    is_power(upper).then_some(upper)
}

/// Whether a single row keeps a column from exceeding 1.
fn is_at_most_one(work: &WorkingProgram, column: usize) -> bool {
    work.uses[column].iter().any(|&row| work.implied_bounds(row, column).0[1] <= 1.0)
}

/// Whether all rows that keep a column from rising, or from falling, hold it at whole multiples of
/// its unit.
fn ends_whole(work: &WorkingProgram, column: usize, unit: f64, rises: bool) -> bool {
    work.uses[column].iter().all(|&row| {
        let a = work.coefficient(row, column);
        let limit = if (a > 0.0) == rises { work.row_upper[row] } else { work.row_lower[row] };
        let others = || work.rows[row].iter().filter(|e| e.0 != column);
        let a = unit * a;
        limit.is_infinite()
            || (is_whole(limit / a) && others().all(|&(j, b)| work.integral[j] && is_whole(b / a)))
    })
}
