//! How large the columns of a program are, without regard to their units.
//!
//! Bounds say it first, and rows that leave half of them at most. Other columns follow from rows:
//! if all other terms of a row are known, the last one is about as large as the largest of them and
//! the limits. The sum of all would grow along dynamics. Rounding aside, sizes of a program in
//! other units are the same in these units, in any order of rows and columns.

use crate::activity::{RowActivity, implied_ends, term_ends};
use crate::presolve::root::working_program::WorkingProgram;
use crate::tolerance::finite_size;

/// The number of times that rows narrow bounds: they may be far wider than what a program means.
const NARROWING_ROUNDS: usize = 3;

/// How often all rows are looked at because no row has a single unknown column. Columns that are
/// still unknown then keep their units.
const MOST_STALLS: usize = 50;

/// By column, the magnitude that its values have at most; `None` where nothing is known.
pub(super) fn sizes(work: &WorkingProgram) -> Vec<Option<f64>> {
    let count = work.uses.len();
    let bounds = narrowed_bounds(work);
    let mut search = SizeSearch {
        work,
        size: bounds.iter().enumerate().map(|(j, bounds)| own_size(work, j, bounds)).collect(),
        unknown: vec![0; work.rows.len()],
        found: vec![f64::INFINITY; count],
        first: 0,
    };
    search.run();
    search.size
}

/// The size that bounds tell.
fn own_size(work: &WorkingProgram, j: usize, [lower, upper]: &[f64; 2]) -> Option<f64> {
    let size = lower.abs().max(upper.abs());
    match size.is_finite() {
        true => Some(size),
        false => work.integral[j].then_some(1.0),
    }
}

/// The bounds of columns, as narrow as rows leave them. Missing ones are those that a row implies
/// by bounds that are there, and no further ones.
fn narrowed_bounds(work: &WorkingProgram) -> Vec<[f64; 2]> {
    let mut bounds: Vec<[f64; 2]> =
        work.lower.iter().zip(&work.upper).map(|(&lower, &upper)| [lower, upper]).collect();
    for round in 0..NARROWING_ROUNDS {
        // All rows of a round see the same bounds, so that their order does not matter.
        let mut narrow = bounds.clone();
        for (row, entries) in work.rows.iter().enumerate() {
            let [mut least, mut most] = [RowActivity::default(); 2];
            for &(j, a) in entries {
                let [low, high] = term_ends(a, bounds[j]);
                least.add(low);
                most.add(high);
            }
            let limits = [work.row_lower[row], work.row_upper[row]];
            for &(j, a) in entries.iter().filter(|(j, _)| !work.integral[*j]) {
                let [low, high] = term_ends(a, bounds[j]);
                let below = most.room(high, limits[0]).unwrap_or(f64::NEG_INFINITY);
                let above = least.room(low, limits[1]).unwrap_or(f64::INFINITY);
                let [lower, upper] = implied_ends(a, [below, above]);
                narrow[j] = [narrow[j][0].max(lower), narrow[j][1].min(upper)];
            }
        }
        let mut is_over = true;
        for (old, new) in bounds.iter_mut().zip(&narrow) {
            let (before, after) = (old[1] - old[0], new[1] - new[0]);
            let is_new = round == 0 && before.is_infinite() && after.is_finite();
            if after >= 0.0 && (is_new || before.is_finite() && after <= 0.5 * before) {
                is_over &= before == 0.0;
                *old = *new;
            }
        }
        if is_over {
            break;
        }
    }
    bounds
}

/// A search for sizes, in waves, so that the order of rows and columns does not matter.
struct SizeSearch<'a> {
    work: &'a WorkingProgram,
    size: Vec<Option<f64>>,
    /// By row, the columns whose sizes are unknown.
    unknown: Vec<usize>,
    /// By column, the smallest size that a row of this wave tells.
    found: Vec<f64>,
    /// All columns before this one are known.
    first: usize,
}

impl SizeSearch<'_> {
    fn run(&mut self) {
        for (row, entries) in self.work.rows.iter().enumerate() {
            self.unknown[row] = entries.iter().filter(|(j, _)| self.size[*j].is_none()).count();
        }
        let all = |search: &Self, wanted: &dyn Fn(usize) -> bool| {
            (0..search.unknown.len()).filter(|&row| wanted(search.unknown[row])).collect()
        };
        let mut wave: Vec<usize> = all(self, &|unknown| unknown == 1);
        let mut stalls = 0;
        while stalls < MOST_STALLS {
            let mut known = self.find(&wave);
            if known.is_empty() {
                stalls += 1;
                known = self.find(&all(self, &|unknown| unknown > 1));
            }
            if known.is_empty() {
                known = self.costs();
            }
            if known.is_empty() {
                known = self.any();
            }
            if known.is_empty() {
                return;
            }
            wave.clear();
            for j in known {
                for &row in &self.work.uses[j] {
                    self.unknown[row] -= 1;
                    if self.unknown[row] == 1 {
                        wave.push(row);
                    }
                }
            }
        }
    }

    /// Sets the sizes of columns that some rows tell; returns these columns.
    fn find(&mut self, rows: &[usize]) -> Vec<usize> {
        let mut known = Vec::new();
        for &row in rows {
            let entries = &self.work.rows[row];
            let limits = [self.work.row_lower[row], self.work.row_upper[row]];
            let limit = finite_size(limits[0]).max(finite_size(limits[1]));
            let terms = entries.iter().map(|&(j, a)| a.abs() * self.size[j].unwrap_or(0.0));
            let largest = terms.fold(limit, f64::max);
            if largest == 0.0 {
                continue;
            }
            for &(j, a) in entries.iter().filter(|(j, _)| self.size[*j].is_none()) {
                if self.found[j].is_infinite() {
                    known.push(j);
                }
                self.found[j] = self.found[j].min(largest / a.abs());
            }
        }
        known.iter().for_each(|&j| self.size[j] = Some(self.found[j]));
        known
    }

    /// Sets the sizes of unknown columns with which they cost as much as 1; returns these columns.
    fn costs(&mut self) -> Vec<usize> {
        let mut known = Vec::new();
        for (j, size) in self.size.iter_mut().enumerate().filter(|(_, size)| size.is_none()) {
            let curvature = self.work.quadratic[j].get(&j).copied().unwrap_or(0.0);
            let cost = curvature.abs().sqrt().max(self.work.linear[j].abs());
            if cost > 0.0 && !self.work.uses[j].is_empty() {
                *size = Some(1.0 / cost);
                known.push(j);
            }
        }
        known
    }

    /// Sets the size of the first unknown column to 1, on which others depend; returns this column.
    fn any(&mut self) -> Vec<usize> {
        while self.size.get(self.first).is_some_and(Option::is_some) {
            self.first += 1;
        }
        let first = self.size.get_mut(self.first).map(|size| *size = Some(1.0));
        first.map(|()| self.first).into_iter().collect()
    }
}
