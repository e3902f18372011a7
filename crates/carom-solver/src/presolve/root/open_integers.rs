//! Open integers: integers without a bound on some side that are in equalities over whole numbers.
//!
//! Takes an equality over whole numbers with open integers; leaves the program without one of them,
//! or the equality with smaller coefficients (Pugh, The Omega test: a fast and practical integer
//! programming algorithm for dependence analysis, Proceedings of Supercomputing, 1991).
//!
//! A tree over such integers may have no end: of `6 x - 3 y = 4 z + 1` with a binary `z` every
//! relaxation of `z = 1` has a point, and no bound of `x` or `y` ever excludes them all. So the
//! equality is solved: an integer whose coefficient divides all others is substituted. Where there
//! is none, the integers are combined as in Euclid's algorithm: for the one with the least
//! coefficient `p` another one stands, `z = x_p + sum k_j x_j`, which leaves the others their
//! remainders, or nothing. At the end one open integer is left, which the others decide: the
//! equality tells its residue class, and other equalities have its multiples instead of integers
//! that nothing bounds. Other rules may have divided the equality, so it is multiplied first, until
//! its numbers are whole again.

use std::collections::BTreeMap;

use super::cones::add_row;
use super::postsolve::{Restored, Undo};
use super::substitute::{is_stable, substitute};
use super::units::scale_row;
use super::working_program::{Sparse, WorkingProgram};
use crate::activity::{RowActivity, term_ends};
use crate::presolve::parameters::FEW_ROUNDINGS;

/// The longest equalities, and most rows of an integer that is replaced.
const LONGEST_EQUALITY: usize = 12;
const MOST_COLUMN_ROWS: usize = 12;

/// Most open integers of a program: more come from large programs, whose bounds follow in other
/// ways.
const MAX_OPEN_INTEGERS: usize = 64;

/// The largest coefficient of an equality.
const MAX_COEFFICIENT: f64 = 1e9;

/// The largest multiple of its least coefficient by which an equality may have been divided.
const MOST_MULTIPLE: u32 = 60;

/// Passes over the rows that look for bounds.
const BOUND_PASSES: usize = 10;

/// `x_column = z - terms`, where `z` has taken the place of the column.
#[derive(Debug)]
struct Recombined {
    column: usize,
    terms: Sparse,
    /// The row that keeps the bounds of `x_column`.
    row: Option<usize>,
}

pub(super) fn apply(work: &mut WorkingProgram) -> usize {
    let Some(mut is_open) = open_columns(work) else { return 0 };
    for row in work.live_rows() {
        mark_whole(work, row);
    }
    let mut changes = 0;
    for row in work.live_rows() {
        make_whole(work, row);
        while !work.is_late(work.rows[row].len()) && solve(work, &mut is_open, row) {
            changes += 1;
        }
        close(work, &mut is_open, row);
    }
    changes
}

/// Marks a column as integral that an equality makes a multiple of an integer.
fn mark_whole(work: &mut WorkingProgram, row: usize) {
    let [first, second] = work.rows[row][..] else { return };
    let (integer, other) = match [first, second].map(|(j, _)| work.integral[j]) {
        [true, false] => (first, second),
        [false, true] => (second, first),
        _ => return,
    };
    let is_multiple = |a: f64| a % other.1 == 0.0;
    if work.is_equality(row) && is_multiple(integer.1) && is_multiple(work.row_lower[row]) {
        work.integral[other.0] = true;
    }
}

/// Multiplies an equality by the number that makes its numbers whole, if there is a small one.
fn make_whole(work: &mut WorkingProgram, row: usize) {
    let terms = &work.rows[row];
    let is_over_integers = terms.iter().all(|&(j, _)| work.integral[j]);
    let least = terms.iter().map(|(_, a)| a.abs()).fold(f64::INFINITY, f64::min);
    if !work.is_equality(row)
        || !is_over_integers
        || terms.is_empty()
        || is_whole_equality(work, row)
    {
        return;
    }
    let right = work.row_lower[row];
    let numbers = || terms.iter().map(|(_, a)| *a).chain([right]);
    let is_near = |value: f64| (value - value.round()).abs() <= FEW_ROUNDINGS * value.abs();
    let makes_whole = |factor: &f64| numbers().all(|a| is_near(a * factor));
    let factors = (1..=MOST_MULTIPLE).map(|k| f64::from(k) / least);
    let Some(factor) = { factors }.find(makes_whole) else { return };
    scale_row(work, row, factor);
    let whole = work.rows[row].iter().map(|&(j, a)| (j, a.round())).collect();
    let right = work.row_lower[row].round();
    work.set_row(row, whole);
    (work.row_lower[row], work.row_upper[row]) = (right, right);
}

/// An equality with one open integer bounds it by the others.
fn close(work: &WorkingProgram, is_open: &mut [bool], row: usize) {
    if !work.row_alive[row] || !work.is_equality(row) {
        return;
    }
    let mut open = work.rows[row].iter().map(|&(j, _)| j).filter(|&j| is_open[j]);
    if let (Some(last), None) = (open.next(), open.next()) {
        is_open[last] = false;
    }
}

/// The integers that no rows and bounds of others bound on both sides; `None` if there are none or
/// many.
fn open_columns(work: &mut WorkingProgram) -> Option<Vec<bool>> {
    let is_infinite = |[lower, upper]: [f64; 2]| lower.is_infinite() || upper.is_infinite();
    let mut bounds: Vec<[f64; 2]> =
        work.lower.iter().zip(&work.upper).map(|(&lower, &upper)| [lower, upper]).collect();
    let candidates = |bounds: &[[f64; 2]]| -> Vec<usize> {
        let columns = work.live_columns().into_iter();
        columns.filter(|&j| work.integral[j] && is_infinite(bounds[j])).collect()
    };
    if candidates(&bounds).is_empty() {
        return None;
    }
    for _ in 0..BOUND_PASSES {
        let mut is_news = false;
        for row in work.live_rows() {
            if work.is_late(work.rows[row].len()) {
                return None;
            }
            is_news |= bound_infinite(work, row, &mut bounds);
        }
        if !is_news {
            break;
        }
    }
    let columns = work.live_columns().into_iter();
    let open: Vec<usize> =
        columns.filter(|&j| work.integral[j] && is_infinite(bounds[j])).collect();
    if open.is_empty() || open.len() > MAX_OPEN_INTEGERS {
        return None;
    }
    let mut is_open = vec![false; bounds.len()];
    open.into_iter().for_each(|j| is_open[j] = true);
    Some(is_open)
}

/// Finds finite bounds of columns without them that a row implies; `true` if there are any.
fn bound_infinite(work: &WorkingProgram, row: usize, bounds: &mut [[f64; 2]]) -> bool {
    let terms = &work.rows[row];
    let mut activity = [RowActivity::default(); 2];
    for &(j, a) in terms {
        let ends = term_ends(a, bounds[j]);
        activity.iter_mut().zip(ends).for_each(|(activity, end)| activity.add(end));
    }
    let mut is_news = false;
    for (k, limit) in [work.row_upper[row], work.row_lower[row]].into_iter().enumerate() {
        if limit.is_infinite() {
            continue;
        }
        for &(j, a) in terms {
            // The smallest activity and the upper limit bound a term from above.
            let side = usize::from((k == 0) == (a > 0.0));
            let rest = activity[k].without(term_ends(a, bounds[j])[k]);
            let Some(rest) = rest.filter(|_| bounds[j][side].is_infinite()) else { continue };
            bounds[j][side] = (limit - rest) / a;
            is_news = true;
        }
        if is_news {
            // The sums are those of the bounds before.
            return true;
        }
    }
    is_news
}

/// Takes one open integer out of an equality, or replaces one; `false` if nothing is left to do.
fn solve(work: &mut WorkingProgram, is_open: &mut [bool], row: usize) -> bool {
    if !work.row_alive[row] || !is_whole_equality(work, row) {
        return false;
    }
    let terms = work.rows[row].clone();
    let free = |j: usize| {
        is_open[j]
            && !work.is_held(j)
            && work.is_straight(j)
            && work.uses[j].len() <= MOST_COLUMN_ROWS
    };
    let open: Vec<(usize, f64)> = terms.iter().copied().filter(|&(j, _)| free(j)).collect();
    let by_size = |a: &&(usize, f64), b: &&(usize, f64)| {
        let uses = |j: usize| work.uses[j].len();
        a.1.abs().total_cmp(&b.1.abs()).then(uses(a.0).cmp(&uses(b.0)))
    };
    let Some(&(column, pivot)) = open.iter().min_by(by_size) else { return false };
    let is_multiple = |a: f64| a % pivot == 0.0;
    if terms.iter().all(|&(_, a)| is_multiple(a)) && is_multiple(work.row_lower[row]) {
        if !is_stable(work, column, row) {
            return false;
        }
        substitute(work, column, row, true);
        return true;
    }
    let quotients = open.iter().filter(|(j, _)| *j != column);
    let quotients = quotients.map(|&(j, a)| (j, (a / pivot).round()));
    let quotients: Sparse = quotients.filter(|(_, k)| *k != 0.0).collect();
    if quotients.is_empty() {
        return false;
    }
    recombine(work, column, quotients);
    is_open[column] = true;
    true
}

fn is_whole_equality(work: &WorkingProgram, row: usize) -> bool {
    let is_whole = |a: f64| a == a.round() && a.abs() <= MAX_COEFFICIENT;
    let terms = &work.rows[row];
    work.is_equality(row)
        && is_whole(work.row_lower[row])
        && (2..=LONGEST_EQUALITY).contains(&terms.len())
        && terms.iter().all(|&(j, a)| work.integral[j] && is_whole(a))
}

/// Lets `z = x_column + quotients` take the place of a column.
fn recombine(work: &mut WorkingProgram, column: usize, terms: Sparse) {
    for row in work.uses[column].clone() {
        let a = work.coefficient(row, column);
        let mut entries: BTreeMap<usize, f64> = work.rows[row].iter().copied().collect();
        for &(j, k) in &terms {
            *entries.entry(j).or_insert(0.0) -= a * k;
        }
        work.set_row(row, entries.into_iter().filter(|(_, a)| *a != 0.0).collect());
    }
    let cost = work.linear[column];
    for &(j, k) in &terms {
        work.linear[j] -= cost * k;
    }
    let bounds = [work.lower[column], work.upper[column]];
    let open = [f64::NEG_INFINITY, f64::INFINITY];
    [work.lower[column], work.upper[column]] = open;
    work.spread[column] += terms.iter().map(|&(j, k)| k.abs() * work.spread[j]).sum::<f64>();
    let row = (bounds != open).then(|| {
        let mut entries: Sparse = terms.iter().map(|&(j, k)| (j, -k)).collect();
        entries.push((column, 1.0));
        entries.sort_unstable_by_key(|entry| entry.0);
        add_row(work, entries, bounds)
    });
    work.push(Recombined { column, terms, row });
}

impl Undo for Recombined {
    fn primal(&self, x: &mut [f64]) {
        let sum: f64 = self.terms.iter().map(|&(j, k)| k * x[j]).sum();
        x[self.column] = (x[self.column] - sum).round();
    }

    fn carry(&self, known: &mut BTreeMap<usize, f64>) {
        let Some(own) = known.remove(&self.column) else { return };
        let terms = self.terms.iter().map(|&(j, k)| Some(k * known.get(&j)?));
        if let Some(sum) = terms.sum::<Option<f64>>() {
            known.insert(self.column, own + sum);
        }
    }

    fn dual(&self, all: &mut Restored) {
        let of_new = all.d[self.column];
        self.terms.iter().for_each(|&(j, k)| all.d[j] += k * of_new);
        if let Some(row) = self.row {
            all.d[self.column] -= all.y[row];
            all.y[row] = 0.0;
        }
    }
}
