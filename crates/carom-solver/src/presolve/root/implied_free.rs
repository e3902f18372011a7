//! Implied free columns.
//!
//! Takes a column whose rows imply its bounds, and an equality among them; leaves the program
//! without both (Achterberg, Bixby, Gu, Rothberg and Weninger, Presolve reductions in mixed integer
//! programming, INFORMS Journal on Computing 32, 2020). An integral column has to be a whole
//! multiple of integral ones.
//!
//! Rows of a curved program keep their columns longer, because bounds of states and inputs say more
//! to propagation than sums of many terms; so do columns that a whole one bounds.

use super::substitute::{is_stable, substitute};
use super::working_program::WorkingProgram;
use crate::presolve::coefficients::is_whole;
use crate::presolve::parameters::IMPLIED;

/// The size of an equality and a column that one replaces by the other.
#[derive(Debug, Clone, Copy)]
struct Limits {
    /// The largest number of terms of an equality that replaces a column.
    terms: usize,
    /// The largest number of rows of a column that is replaced.
    rows: usize,
    /// The largest number of entries that one substitution may add to the matrix.
    fill: isize,
}

/// In any program.
const ANY: Limits = Limits { terms: 6, rows: 4, fill: 0 };
/// In a linear program.
const LINEAR: Limits = Limits { terms: 8, rows: 10, fill: 10 };

impl Limits {
    fn allow(self, work: &WorkingProgram, column: usize, row: usize) -> bool {
        work.rows[row].len() <= self.terms
            && work.uses[column].len() <= self.rows
            && fill(work, column, row) <= self.fill
    }
}

pub(super) fn apply(work: &mut WorkingProgram, row: usize) -> usize {
    let most = if work.is_linear { LINEAR } else { ANY };
    if !work.is_equality(row) || !(2..=most.terms).contains(&work.rows[row].len()) {
        return 0;
    }
    let candidates = work.rows[row].iter().map(|&(j, _)| j);
    let chosen = candidates
        .filter(|&j| {
            work.is_straight(j)
                && (!work.integral[j] && ANY.allow(work, j, row)
                    || work.is_linear
                        && (!work.integral[j] || follows_integers(work, j, row))
                        && LINEAR.allow(work, j, row)
                        && !has_variable_bound(work, j))
                && is_stable(work, j, row)
                && is_implied_free(work, j)
        })
        .min_by_key(|&j| (fill(work, j, row), j));
    let Some(column) = chosen else { return 0 };
    substitute(work, column, row, false);
    1
}

/// Whether a row bounds a continuous column by a whole one, which cuts start from.
fn has_variable_bound(work: &WorkingProgram, column: usize) -> bool {
    let is_bound = |row: &usize| {
        let entries = &work.rows[*row];
        entries.len() == 2 && entries.iter().any(|&(j, _)| j != column && work.integral[j])
    };
    !work.integral[column] && work.uses[column].iter().any(is_bound)
}

/// Whether a column is whole where the others of an equality are.
fn follows_integers(work: &WorkingProgram, column: usize, row: usize) -> bool {
    let pivot = work.coefficient(row, column);
    let whole = |&(j, a): &(usize, f64)| work.integral[j] && is_whole(a / pivot);
    is_whole(work.row_lower[row] / pivot) && work.rows[row].iter().all(whole)
}

/// The most entries that a substitution can add, less those that it takes away.
fn fill(work: &WorkingProgram, column: usize, row: usize) -> isize {
    let entries = |i: usize| work.rows[i].iter();
    let others = work.uses[column].iter().filter(|&&other| other != row);
    let added: usize = others
        .map(|&other| {
            let new = |&&(j, _): &&(usize, f64)| j != column && work.coefficient(other, j) == 0.0;
            entries(row).filter(new).count()
        })
        .sum();
    added as isize - (work.rows[row].len() + work.uses[column].len() - 1) as isize
}

/// Whether each bound of a column follows from one of its rows and the bounds of other columns.
fn is_implied_free(work: &WorkingProgram, column: usize) -> bool {
    let (lower, upper) = (work.lower[column], work.upper[column]);
    let mut needs = [lower.is_finite(), upper.is_finite()];
    for &row in &work.uses[column] {
        if !needs[0] && !needs[1] {
            break;
        }
        let (implied, rest) = work.implied_bounds(row, column);
        let margin = IMPLIED * rest.scale / work.coefficient(row, column).abs();
        needs[0] &= implied[0] < lower - margin.min(IMPLIED);
        needs[1] &= implied[1] > upper + margin.min(IMPLIED);
    }
    !needs[0] && !needs[1]
}
