//! Lineality: directions along which neither rows nor the objective change.
//!
//! Takes columns that can be shifted together without changing any row or the objective; leaves one
//! of them fixed at 0, and the others without bounds.
//!
//! Rows over potentials of a tour, or over start times of a schedule, depend only on differences.
//! If `Ad = 0`, `q'd = 0` and `Pd = 0` for a direction `d` (in the lineality space), every point
//! can be shifted along `d` and stays feasible with the same objective. So one column of the
//! direction can be fixed at 0, and propagation bounds the others, which could otherwise take
//! values of any size.
//!
//! If a point is shifted, the other columns of the direction move further out (see
//! `WorkingProgram::spread`).
//!
//! The columns of a direction must have no bounds, or only bounds that one sense of the direction
//! moves away from, such as non-negative potentials. These bounds are dropped, and postsolve shifts
//! the point until they hold. Integral columns are shifted by integers.
//!
//! The directions come from an exact elimination: if a result is not exact in a float, its columns
//! are left alone.

use std::collections::BTreeMap;

use super::fixed_columns::fix;
use super::postsolve::{Restored, Undo};
use super::singleton_rows;
use super::working_program::{Infeasible, Sparse, WorkingProgram};
use crate::program::Program;
use crate::solver::StopToken;
use crate::sum::{exact_product, exact_sum};

/// The largest number of entries that the elimination visits, as a multiple of the initial ones.
const ELIMINATION_WORK: usize = 50;

/// Bounds that were dropped, and the direction that leaves them behind.
#[derive(Debug)]
struct Shifted {
    direction: Sparse,
    /// Lower and upper bound of each column of the direction.
    bounds: Vec<[f64; 2]>,
    /// Whether only whole steps are allowed.
    whole: bool,
}

/// The directions of a program along whose sense neither the objective nor a row over several
/// columns changes, and no bound is run into. The first column of each is in no later one, and has
/// the entry 1 or -1.
pub(crate) fn shifts(program: &Program, token: &StopToken) -> Vec<Sparse> {
    let is_open = |j: usize| program.lower[j].is_infinite() || program.upper[j].is_infinite();
    if !(0..program.column_count()).any(is_open) {
        return Vec::new();
    }
    let mut work = WorkingProgram::new(program, token);
    match work.each_row(singleton_rows::apply) {
        Ok(_) => fix_all(&mut work),
        Err(Infeasible) => Vec::new(),
    }
}

pub(super) fn apply(work: &mut WorkingProgram) -> usize {
    fix_all(work).len()
}

/// Fixes the first columns of all directions that it can be done for, and returns these.
fn fix_all(work: &mut WorkingProgram) -> Vec<Sparse> {
    let mut fixed = Vec::new();
    // Free columns first: bounds on one side may hide what can be done without touching them.
    for most in [0, 1] {
        let count =
            |j: usize| [work.lower[j], work.upper[j]].into_iter().filter(|b| b.is_finite()).count();
        let open: Vec<bool> = (0..work.uses.len())
            .map(|j| work.column_alive[j] && !work.is_held(j) && count(j) <= most)
            .collect();
        if !open.contains(&true) || work.is_late(0) {
            continue;
        }
        for direction in Elimination::new(work, open).directions(work) {
            fixed.extend(fix_along(work, direction));
        }
    }
    fixed
}

/// Fixes the first column of a direction, unless both senses of the direction run into bounds.
/// Returns the sense that does not.
fn fix_along(work: &mut WorkingProgram, mut direction: Sparse) -> Option<Sparse> {
    let leaves = |j: usize, d: f64| {
        let (lower, upper) = (work.lower[j].is_finite(), work.upper[j].is_finite());
        (!lower || d > 0.0) && (!upper || d < 0.0)
    };
    let first = direction[0].0;
    if !direction.iter().all(|&(j, d)| leaves(j, d)) {
        direction.iter_mut().for_each(|(_, d)| *d = -*d);
        if !direction.iter().all(|&(j, d)| leaves(j, d)) {
            return None;
        }
    }
    let moves = direction.clone();
    let bounds: Vec<[f64; 2]> =
        direction.iter().map(|&(j, _)| [work.lower[j], work.upper[j]]).collect();
    if bounds.iter().flatten().any(|bound| bound.is_finite()) {
        for &(j, _) in &direction {
            (work.lower[j], work.upper[j]) = (f64::NEG_INFINITY, f64::INFINITY);
        }
        let whole = direction.iter().any(|&(j, _)| work.integral[j]);
        work.push(Shifted { direction, bounds, whole });
    }
    let spread = work.spread[first];
    moves.iter().for_each(|&(j, d)| work.spread[j] += d.abs() * spread);
    fix(work, first, 0.0);
    Some(moves)
}

impl Undo for Shifted {
    fn primal(&self, x: &mut [f64]) {
        let mut step = 0.0_f64;
        for (&(j, d), &[lower, upper]) in self.direction.iter().zip(&self.bounds) {
            let bound = if d > 0.0 { lower } else { upper };
            step = if bound.is_finite() { step.max((bound - x[j]) / d) } else { step };
        }
        let step = if self.whole { step.ceil() } else { step };
        self.direction.iter().for_each(|&(j, d)| x[j] += step * d);
    }

    /// No column of the direction presses on a bound, and all reduced costs are 0.
    fn dual(&self, _: &mut Restored) {}
}

/// The directions `d` over some columns along which neither rows nor objective change.
///
/// Each row says `a'd = 0`. It expresses one column by the others, with which the column is
/// replaced everywhere; columns that are not expressed are the parameters of the directions.
struct Elimination {
    /// Columns whose entry of `d` may be other than 0.
    open: Vec<bool>,
    /// Each expressed column as a combination of parameters.
    expressed: Vec<Option<BTreeMap<usize, f64>>>,
    /// Columns whose expressions may have a parameter.
    users: Vec<Vec<usize>>,
    /// Entries that may still be looked at.
    left: usize,
}

impl Elimination {
    fn new(work: &WorkingProgram, open: Vec<bool>) -> Self {
        let columns = (0..open.len()).filter(|&j| open[j]);
        let entries: usize = columns.map(|j| work.uses[j].len()).sum();
        Elimination {
            expressed: vec![None; open.len()],
            users: vec![Vec::new(); open.len()],
            open,
            left: ELIMINATION_WORK * (entries + 1),
        }
    }

    /// A basis; in each direction the first column belongs to no other one, and has the entry 1.
    fn directions(mut self, work: &mut WorkingProgram) -> Vec<Sparse> {
        let mut rows = self.rows(work);
        // Short ones first: they express columns without filling the others.
        rows.sort_by_key(Vec::len);
        for row in rows {
            let before = self.left;
            self.eliminate(work, &row);
            if self.left == 0 || work.is_late(before - self.left) {
                return Vec::new();
            }
        }
        let parameters = (0..self.open.len()).filter(|&j| self.open[j]);
        let parameters: Vec<usize> = parameters.filter(|&j| self.expressed[j].is_none()).collect();
        let mut directions = Vec::with_capacity(parameters.len());
        for j in parameters {
            if work.is_late(self.users[j].len()) {
                break;
            }
            directions.push(self.direction(j));
        }
        directions
    }

    /// Counts entries that are looked at.
    fn spend(&mut self, entries: usize) {
        self.left = self.left.saturating_sub(entries);
    }

    /// The linear forms that must not change: rows, costs and gradients over open columns, without
    /// the columns that a row by itself keeps from moving.
    fn rows(&mut self, work: &WorkingProgram) -> Vec<Sparse> {
        let open = |&(j, _): &(usize, f64)| self.open[j];
        let count = |row: &Sparse| row.iter().filter(|entry| open(entry)).count();
        let mut counts: Vec<usize> = work.rows.iter().map(count).collect();
        let mut single: Vec<usize> = (0..counts.len()).filter(|&i| counts[i] == 1).collect();
        while let Some(i) = single.pop() {
            let Some(&(j, _)) = work.rows[i].iter().find(|(j, _)| self.open[*j]) else { continue };
            self.open[j] = false;
            for &i in &work.uses[j] {
                counts[i] -= 1;
                single.extend((counts[i] == 1).then_some(i));
            }
        }
        let open = |&(j, _): &(usize, f64)| self.open[j];
        let rows = work.rows.iter().map(|row| row.iter().copied().filter(open).collect());
        let cost = work.linear.iter().copied().enumerate().filter(|(_, q)| *q != 0.0);
        let curved = work.quadratic.iter().map(|row| {
            let entries = row.iter().map(|(&j, &p)| (j, p));
            entries.filter(open).collect()
        });
        let all = rows.chain(curved).chain([cost.filter(open).collect()]);
        all.filter(|row: &Sparse| !row.is_empty()).collect()
    }

    /// The product `a'd` as a combination of parameters, and whether it is exact.
    fn expand(&mut self, row: &[(usize, f64)]) -> (BTreeMap<usize, f64>, bool) {
        let (mut sum, mut exact) = (BTreeMap::new(), true);
        for &(j, a) in row {
            match &self.expressed[j] {
                Some(terms) => {
                    self.left = self.left.saturating_sub(terms.len());
                    exact &= add(&mut sum, a, terms);
                }
                None => exact &= add(&mut sum, a, &BTreeMap::from([(j, 1.0)])),
            }
        }
        sum.retain(|&j, value| self.open[j] && (*value != 0.0 || !exact));
        (sum, exact)
    }

    /// Expresses a column by a row, or closes what the row keeps from moving.
    fn eliminate(&mut self, work: &WorkingProgram, row: &[(usize, f64)]) {
        let (sum, exact) = self.expand(row);
        self.spend(1 + row.len() + sum.len());
        // A continuous column where there is one: an integral one needs whole steps.
        let mut pivots: Vec<(bool, usize, usize)> =
            sum.keys().map(|&j| (work.integral[j], self.users[j].len(), j)).collect();
        pivots.sort_unstable();
        let mut best = None;
        for (_, _, j) in pivots {
            // An expression is as long as the sum.
            self.spend(sum.len());
            best = expression(work, &sum, j, sum[&j]).map(|terms| (j, terms));
            if best.is_some() || self.left == 0 {
                break;
            }
        }
        let Some((column, terms)) = best.filter(|_| exact && sum.len() > 1) else {
            sum.keys().for_each(|&j| self.open[j] = false);
            return;
        };
        let mut users = std::mem::take(&mut self.users[column]);
        users.sort_unstable();
        users.dedup();
        // Every list of users gets these.
        self.spend(users.len() * (1 + terms.len()));
        for &user in &users {
            let Some(own) = &mut self.expressed[user] else { continue };
            let Some(factor) = own.remove(&column) else { continue };
            self.left = self.left.saturating_sub(terms.len());
            if !add(own, factor, &terms) {
                own.keys().for_each(|&j| self.open[j] = false);
            }
            own.retain(|_, value| *value != 0.0);
        }
        users.push(column);
        terms.keys().for_each(|&j| self.users[j].extend(&users));
        self.expressed[column] = Some(terms);
    }

    fn direction(&self, parameter: usize) -> Sparse {
        let mut users = self.users[parameter].clone();
        users.sort_unstable();
        users.dedup();
        let entry = |user: usize| Some((user, *self.expressed[user].as_ref()?.get(&parameter)?));
        [(parameter, 1.0)].into_iter().chain(users.into_iter().filter_map(entry)).collect()
    }
}

/// The column `j` with the coefficient `a`, expressed by the others of `sum = 0`; `None` if factors
/// do not fit into a float, or if whole steps of integral columns would not be whole ones of `j`.
fn expression(
    work: &WorkingProgram,
    sum: &BTreeMap<usize, f64>,
    j: usize,
    a: f64,
) -> Option<BTreeMap<usize, f64>> {
    let others = sum.iter().filter(|(k, _)| **k != j);
    let factor = |(&k, &b): (&usize, &f64)| {
        let factor = -b / a;
        let whole = !work.integral[j] || (work.integral[k] && factor == factor.round());
        let exact = factor.is_finite() && exact_product(factor, a) == (-b, 0.0);
        (whole && exact).then_some((k, factor))
    };
    others.map(factor).collect()
}

/// Adds `factor` times the terms to a sum; whether nothing was rounded.
fn add(sum: &mut BTreeMap<usize, f64>, factor: f64, terms: &BTreeMap<usize, f64>) -> bool {
    let mut exact = true;
    for (&k, &b) in terms {
        let entry = sum.entry(k).or_insert(0.0);
        let (product, lost) = exact_product(factor, b);
        let (total, rest) = exact_sum(*entry, product);
        exact &= lost == 0.0 && rest == 0.0 && total.is_finite();
        *entry = total;
    }
    exact
}
