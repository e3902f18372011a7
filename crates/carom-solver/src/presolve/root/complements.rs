//! Complements.
//!
//! Takes binaries that stand for "off": `1 - x` of those that rows over binaries speak of; leaves
//! the binaries of these rows as "on", in "exactly one of these" and "at least one of these".
//!
//! `x + y - z = 0` may be a sum of alternatives as it is meant, or "exactly one of `x`, `y` and
//! `1 - z`", and `z >= x + y - 1` a conjunction. So a program stays as it is if all of its rows may
//! be meant so. Otherwise binaries are turned around of which more of these rows have the
//! complement than have them.

use super::postsolve::{ColumnMeaning, Restored, Undo};
use super::working_program::WorkingProgram;
use std::collections::BTreeMap;

/// The shortest rows that are looked at: rows over two binaries are implications either way.
const LEAST_TERMS: usize = 3;

/// The longest rows that are looked at.
const MOST_TERMS: usize = 1000;

/// A column that was replaced by `shift` less itself.
#[derive(Debug)]
struct Complement {
    column: usize,
    shift: f64,
}

pub(super) fn apply(work: &mut WorkingProgram) -> usize {
    // By row, the sign with which its complements have negative coefficients; 0 for other rows.
    let mut sign = vec![0.0; work.rows.len()];
    let mut is_complemented = false;
    for row in work.live_rows() {
        if work.is_late(work.rows[row].len()) {
            return 0;
        }
        if let Some((own, complements)) = choice(work, row) {
            sign[row] = own;
            // All but one: a conjunction.
            let most = if work.is_equality(row) { usize::MAX } else { work.rows[row].len() - 2 };
            is_complemented |= (2..=most).contains(&complements);
        }
    }
    if !is_complemented {
        return 0;
    }
    let mut changes = 0;
    for column in work.live_columns() {
        if !work.is_binary(column) || work.is_held(column) || work.is_late(work.uses[column].len())
        {
            continue;
        }
        let vote =
            |(row, a): (usize, f64)| if sign[row] == 0.0 { 0.0 } else { (sign[row] * a).signum() };
        if work.column(column).map(vote).sum::<f64>() < 0.0 {
            complement(work, column);
            changes += 1;
        }
    }
    changes
}

/// Whether a row says "exactly one" or "at least one" of some binaries and complements of binaries:
/// the sign with which complements have negative coefficients, and their number.
fn choice(work: &WorkingProgram, row: usize) -> Option<(f64, usize)> {
    let entries = &work.rows[row];
    let &(_, first) = entries.first()?;
    let fits = (LEAST_TERMS..=MOST_TERMS).contains(&entries.len())
        && entries.iter().all(|&(j, a)| a.abs() == first.abs() && work.is_binary(j));
    if !fits {
        return None;
    }
    [1.0, -1.0].into_iter().find_map(|sign| {
        let count = entries.iter().filter(|(_, a)| sign * a < 0.0).count();
        let least = if sign > 0.0 { work.row_lower[row] } else { -work.row_upper[row] };
        (least == first.abs() * (1.0 - count as f64)).then_some((sign, count))
    })
}

/// Replaces a column between finite bounds by their sum less the column.
pub(super) fn complement(work: &mut WorkingProgram, column: usize) {
    let shift = work.lower[column] + work.upper[column];
    for row in work.uses[column].clone() {
        if let Ok(at) = work.rows[row].binary_search_by_key(&column, |&(j, _)| j) {
            let a = work.rows[row][at].1;
            work.rows[row][at].1 = -a;
            work.shift_row(row, a * shift);
        }
    }
    work.add_to_objective(work.linear[column], shift);
    work.linear[column] = -work.linear[column];
    let mut products = std::mem::take(&mut work.quadratic[column]);
    for (&other, product) in &mut products {
        if other == column {
            work.shift_objective(0.5 * *product * shift * shift);
            work.linear[column] -= *product * shift;
        } else {
            work.linear[other] += *product * shift;
            *product = -*product;
            work.quadratic[other].insert(column, *product);
        }
    }
    work.quadratic[column] = products;
    work.push(Complement { column, shift });
}

impl Undo for Complement {
    fn primal(&self, x: &mut [f64]) {
        x[self.column] = self.shift - x[self.column];
    }

    fn restate(&self, meanings: &mut [ColumnMeaning]) {
        meanings[self.column].put(-1.0, self.shift);
    }

    fn carry(&self, known: &mut BTreeMap<usize, f64>) {
        known.entry(self.column).and_modify(|value| *value = self.shift - *value);
    }

    fn dual(&self, all: &mut Restored) {
        all.d[self.column] = -all.d[self.column];
    }
}
