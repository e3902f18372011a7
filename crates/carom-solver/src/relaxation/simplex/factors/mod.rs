//! Factors of a basis, and their update by an exchange of columns.
//!
//! The basis is the product of a lower and an upper triangle. An exchange puts a column into the
//! upper triangle, moves its row and column to the end, and eliminates the row by a row
//! transformation (Forrest and Tomlin, Updated triangular factors of the basis to maintain sparsity
//! in the product form simplex method).
//!
//! A slot of the basis has the number of the row in which its column has its pivot, so that results
//! need no permutation.

mod buckets;
mod elimination;
mod lists;
mod reach;

use super::parameters::{MAX_PIVOT_DIFFERENCE, MAX_UPDATES, MIN_UPDATES, ROWS_PER_UPDATE};
use super::sparse::{SparseVector, TINY_ENTRY};
use elimination::{Triangles, eliminate};
use lists::Lists;
use reach::{GONE, ReachSearch, TriangularFactor};

/// The share of the past in what is expected of the next solve.
const MEMORY: f64 = 0.9;

/// The purpose of a solve: solves for the same purpose have results of similar density.
#[derive(Debug, Clone, Copy)]
pub(super) enum SolveFor {
    /// A column in the basis.
    Column,
    /// A row of the inverse.
    Row,
    /// Edge weights.
    Weights,
    /// Columns that jump, a point or multipliers.
    Sum,
}

#[derive(Debug, Clone, Default)]
pub(super) struct Factors {
    lower_columns: Lists,
    lower_rows: Lists,
    /// Rows with entries in these lists, in the order of their pivots.
    lower_order: [Vec<u32>; 2],
    /// Row transformations: a row, and the multiples of others that are added to it.
    updated: Vec<u32>,
    updates: Lists,
    update_count: usize,
    upper_columns: Lists,
    upper_rows: Lists,
    pivots: Vec<f64>,
    inverse: Vec<f64>,
    /// Rows by the order of their pivots, and the place of each there.
    order: Vec<u32>,
    place: Vec<u32>,
    /// Entries of the triangles when they were fresh.
    fresh_entries: usize,
    /// The entering column between the triangles, and the leaving row there.
    spike: Vec<(u32, f64)>,
    leaving: Vec<(u32, f64)>,
    /// By [`SolveFor`], the density of results lately: between the triangles and behind them.
    density: [[f64; 2]; 4],
    work: Vec<f64>,
    reach: ReachSearch,
}

impl Factors {
    /// Factorises columns, which are as many as rows or fewer. Returns the factors, and by row (and
    /// slot) the column that has its pivot there; `None` is the column with the only entry -1 in
    /// that row, which stands in for columns that are missing or depend on others.
    pub(super) fn new(rows: usize, columns: &[(&[usize], &[f64])]) -> (Self, Vec<Option<usize>>) {
        let (triangles, column_of) = eliminate(rows, columns);
        let Triangles { lower, lower_order, upper, pivots, order, .. } = triangles;
        let mut place = vec![0; rows];
        order.iter().enumerate().for_each(|(k, &row)| place[row as usize] = k as u32);
        let lower_rows = lower.transposed();
        let has_entries = |row: &&u32| !lower_rows.indices(**row as usize).is_empty();
        let by_row = order.iter().filter(has_entries).copied().collect();
        let factors = Factors {
            fresh_entries: lower.entry_count() + upper.entry_count() + rows,
            lower_rows,
            upper_rows: upper.transposed(),
            lower_columns: lower,
            upper_columns: upper,
            lower_order: [lower_order, by_row],
            inverse: pivots.iter().map(|pivot| 1.0 / pivot).collect(),
            pivots,
            order,
            place,
            ..Factors::default()
        };
        (factors, column_of)
    }

    /// Whether there are no factors yet.
    pub(super) fn is_empty(&self) -> bool {
        self.pivots.is_empty()
    }

    /// The number of exchanges since the basis was factorised.
    pub(super) fn exchanges(&self) -> usize {
        self.update_count
    }

    /// Whether exchanges have made the factors so long that fresh ones are quicker.
    pub(super) fn is_worn(&self) -> bool {
        let entries = self.upper_columns.entry_count() + self.updates.entry_count();
        let entries = entries + self.lower_columns.entry_count();
        let rows = self.pivots.len();
        self.update_count >= MAX_UPDATES + rows / ROWS_PER_UPDATE
            || (self.update_count >= MIN_UPDATES && entries > 2 * self.fresh_entries + rows)
    }

    /// Solves `B x = b` in place, and keeps what an exchange needs if `b` is the entering column.
    pub(super) fn solve(&mut self, v: &mut SparseVector, purpose: SolveFor) {
        let [between, behind] = self.density[purpose as usize];
        let triangle = TriangularFactor {
            lists: &self.lower_columns,
            inverse: None,
            order: &self.lower_order[0],
            is_backward: false,
            is_partial: true,
        };
        triangle.solve(v, between, &mut self.reach);
        for (k, &row) in self.updated.iter().enumerate() {
            let (index, value) = self.updates.get(k);
            let sum: f64 = index.iter().zip(value).map(|(&i, a)| a * v.value[i as usize]).sum();
            if sum != 0.0 {
                v.add(row as usize, sum);
            }
        }
        self.note(purpose, 0, v);
        if matches!(purpose, SolveFor::Column) {
            self.spike.clear();
            self.spike.extend(v.index.iter().map(|&i| (i, v.value[i as usize])));
            // Row transformations may have listed a place twice.
            self.spike.sort_unstable_by_key(|e| e.0);
            self.spike.dedup_by_key(|e| e.0);
        }
        let triangle = TriangularFactor {
            lists: &self.upper_columns,
            inverse: Some(&self.inverse),
            order: &self.order,
            is_backward: true,
            is_partial: false,
        };
        triangle.solve(v, behind, &mut self.reach);
        self.note(purpose, 1, v);
    }

    /// Solves `B'y = c` in place, and keeps what an exchange needs if `c` is the slot that leaves.
    pub(super) fn solve_transposed(&mut self, v: &mut SparseVector, purpose: SolveFor) {
        let [between, behind] = self.density[purpose as usize];
        let triangle = TriangularFactor {
            lists: &self.upper_rows,
            inverse: Some(&self.inverse),
            order: &self.order,
            is_backward: false,
            is_partial: false,
        };
        triangle.solve(v, between, &mut self.reach);
        if matches!(purpose, SolveFor::Row) {
            self.leaving.clear();
            self.leaving.extend(v.index.iter().map(|&i| (i, v.value[i as usize])));
        }
        self.note(purpose, 0, v);
        for (k, &row) in self.updated.iter().enumerate().rev() {
            let value = v.value[row as usize];
            if value != 0.0 {
                let (index, multiples) = self.updates.get(k);
                index.iter().zip(multiples).for_each(|(&i, a)| v.add(i as usize, a * value));
            }
        }
        let triangle = TriangularFactor {
            lists: &self.lower_rows,
            inverse: None,
            order: &self.lower_order[1],
            is_backward: true,
            is_partial: true,
        };
        triangle.solve(v, behind, &mut self.reach);
        self.note(purpose, 1, v);
    }

    fn note(&mut self, purpose: SolveFor, part: usize, v: &SparseVector) {
        let density = &mut self.density[purpose as usize][part];
        *density = MEMORY * *density + (1.0 - MEMORY) * v.density();
    }

    /// Exchanges the column of a slot for the one that was solved for last, which is `pivot` there
    /// in terms of the basis; the slot's row must have been solved for last. Returns `false` if the
    /// factors are of no more use.
    pub(super) fn exchange(&mut self, slot: usize, pivot: f64) -> bool {
        let row = slot as u32;
        let old = self.pivots[slot];
        let new = old * pivot;
        // The new pivot, as the eliminated entry of the row.
        let mut other = 0.0;
        self.work.resize(self.pivots.len(), 0.0);
        for &(i, a) in &self.spike {
            self.work[i as usize] = a;
        }
        let multiples = self.leaving.iter().map(|&(i, a)| (i, a * old));
        let multiples = multiples.filter(|e| e.0 != row && e.1.abs() > TINY_ENTRY);
        self.updated.push(row);
        self.updates.append(multiples);
        let (index, value) = self.updates.get(self.updated.len() - 1);
        for (&i, a) in index.iter().zip(value) {
            other += a * self.work[i as usize];
        }
        other += self.work[slot];
        for &(i, _) in &self.spike {
            self.work[i as usize] = 0.0;
        }
        for &column in self.upper_rows.indices(slot) {
            self.upper_columns.remove(column as usize, row);
        }
        self.upper_rows.clear(slot);
        for &i in self.upper_columns.indices(slot) {
            self.upper_rows.remove(i as usize, row);
        }
        let entries =
            || self.spike.iter().copied().filter(|e| e.0 != row && e.1.abs() > TINY_ENTRY);
        entries().for_each(|(i, a)| self.upper_rows.push(i as usize, row, a));
        self.upper_columns.replace(slot, entries());
        (self.pivots[slot], self.inverse[slot]) = (new, 1.0 / new);
        self.order[self.place[slot] as usize] = GONE;
        self.place[slot] = self.order.len() as u32;
        self.order.push(row);
        self.update_count += 1;
        (new - other).abs() <= MAX_PIVOT_DIFFERENCE * new.abs().max(other.abs())
    }
}
