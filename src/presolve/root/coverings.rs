//! Coverings: "exactly one" that may as well be "at least one".
//!
//! If nothing but `z_1 + ... + z_n = 1` keeps binaries from falling, and falling costs nothing, a point
//! with several of them at 1 stays one when all but the first of these fall. The equality is then
//! written as `>= 1`: that is what selectors of disjunctions look like. Fewer bases are degenerate then,
//! which saves the dual simplex method iterations. Under a curved objective, which it is not used for,
//! the equality stays, because it propagates more. Multipliers are not restored: programs with integers
//! have none.

use super::postsolve::{Restored, Undo};
use super::work::Work;

/// Fewer terms are doubletons, which replace a column.
const MIN_COVERING_TERMS: usize = 3;

#[derive(Debug)]
struct Covering {
    columns: Vec<usize>,
}

impl Undo for Covering {
    fn primal(&self, x: &mut [f64]) {
        let chosen = self.columns.iter().position(|&j| x[j] > 0.5);
        for (k, &j) in self.columns.iter().enumerate() {
            if chosen.is_some_and(|chosen| chosen != k) {
                x[j] = 0.0;
            }
        }
    }

    fn dual(&self, _all: &mut Restored) {}
}

pub(super) fn apply(work: &mut Work, row: usize) -> usize {
    let is_one = work.row_lower[row] == 1.0 && work.row_upper[row] == 1.0;
    if !is_one || work.is_curved() || work.rows[row].len() < MIN_COVERING_TERMS {
        return 0;
    }
    if !work.rows[row].iter().all(|&(column, a)| a == 1.0 && may_fall(work, column, row)) {
        return 0;
    }
    let columns = work.rows[row].iter().map(|e| e.0).collect();
    work.undos.push(Box::new(Covering { columns }));
    work.row_upper[row] = f64::INFINITY;
    1
}

/// Whether a binary may fall as far as its cost and all rows but one are concerned.
fn may_fall(work: &Work, column: usize, except: usize) -> bool {
    work.integral[column]
        && !work.given[column]
        && [work.lower[column], work.upper[column]] == [0.0, 1.0]
        && work.is_straight(column)
        && work.linear[column] >= 0.0
        && work.uses[column].iter().filter(|&&row| row != except).all(|&row| {
            let falls = work.coefficient(row, column) > 0.0;
            let limit = if falls { work.row_lower[row] } else { work.row_upper[row] };
            limit.is_infinite()
        })
}
