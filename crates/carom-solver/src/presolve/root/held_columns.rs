//! Held columns: columns that only one row keeps from moving.
//!
//! Takes this row, if it is an inequality; leaves it as an equality, and a continuous column
//! without the bound that the equality implies.
//!
//! If a column's cost and all of its rows but one let it fall, some optimum has it where that row
//! or its bound stops it. If the row does so before the bound, the row holds with equality, and
//! other rules can replace the column: from `x <= z`, where nothing else keeps `z` up, follows
//! `z = x`. Multipliers are restored in continuous programs; those with integers have none.

use super::working_program::WorkingProgram;
use crate::activity::implied_ends;
use crate::presolve::coefficients::is_whole;
use crate::presolve::parameters::IMPLIED;
use crate::tolerance;

pub(super) fn apply(work: &mut WorkingProgram, column: usize) -> usize {
    if work.is_held(column) || !work.is_straight(column) {
        return 0;
    }
    let cost = work.linear[column];
    let falls = cost >= 0.0 && hold(work, column, false);
    usize::from(falls || (cost <= 0.0 && hold(work, column, true)))
}

/// Makes the only row that keeps a column from falling, or from rising, an equality. Returns
/// whether there is one.
fn hold(work: &mut WorkingProgram, column: usize, rises: bool) -> bool {
    let sign = if rises { -1.0 } else { 1.0 };
    let mut holding = None;
    for &row in &work.uses[column] {
        let a = sign * work.coefficient(row, column);
        let limit = if a > 0.0 { work.row_lower[row] } else { work.row_upper[row] };
        if limit.is_finite() {
            if holding.is_some() {
                return false;
            }
            holding = Some((row, limit));
        }
    }
    let Some((row, limit)) = holding.filter(|&(row, _)| !work.is_equality(row)) else {
        return false;
    };
    let a = work.coefficient(row, column);
    let whole = |&(j, b): &(usize, f64)| work.integral[j] && is_whole(b / a);
    let fits = !work.integral[column]
        || (is_whole(limit / a) && work.rows[row].iter().filter(|e| e.0 != column).all(whole));
    // `x = (limit - rest) / a` stays inside its bound.
    let rest = work.range(work.rows[row].iter().filter(|e| e.0 != column));
    let [end, far] = implied_ends(a, [limit - rest.most, limit - rest.least]);
    // Rounding, and no part of the terms: between terms of 9e9 a billionth is 9. Where rounding
    // itself is more than a bound may be missed by, nothing is known.
    let margin = IMPLIED.max(4.0 * f64::EPSILON * rest.scale / a.abs());
    if margin > tolerance::FEASIBILITY {
        return false;
    }
    let inside =
        if rises { far <= work.upper[column] + margin } else { end >= work.lower[column] - margin };
    if !(fits && inside) {
        return false;
    }
    (work.row_lower[row], work.row_upper[row]) = (limit, limit);
    if !work.integral[column] {
        // The row implies it, and gets its multiplier.
        let bound = if rises { &mut work.upper[column] } else { &mut work.lower[column] };
        *bound = if rises { f64::INFINITY } else { f64::NEG_INFINITY };
    }
    true
}
