//! Factors of a basis, and the factors that its exchanges append to them.
//!
//! Most columns of a basis can be ordered into a triangle: one by one those with a single entry in
//! the rows that are left, then those that are alone in a row. What remains, the nucleus, is small
//! and is eliminated densely. The triangles are the columns themselves, without fill.

use super::parameters::MIN_FACTOR_PIVOT;
use crate::presolve::Compressed;

/// The row and the slot of a pivot, and its value.
#[derive(Debug, Clone, Copy)]
struct Pivot {
    row: usize,
    slot: usize,
    value: f64,
}

/// The slots and rows that keep columns from being a basis.
#[derive(Debug)]
pub(super) struct Deficit {
    /// Slots of columns that depend on others.
    pub(super) slots: Vec<usize>,
    /// Rows without a pivot.
    pub(super) rows: Vec<usize>,
}

#[derive(Debug, Default)]
pub(super) struct Factors {
    columns: Compressed,
    /// Columns with one entry in the rows after theirs.
    upper: Vec<Pivot>,
    /// Columns that are alone in their row among those after them.
    lower: Vec<Pivot>,
    /// Rows of the nucleus, in the order of its elimination, and its slots.
    rows: Vec<usize>,
    slots: Vec<usize>,
    /// The nucleus, eliminated, by rows.
    dense: Vec<f64>,
    /// Exchanges: the slot, and the entering column in the basis before.
    exchanges: Vec<usize>,
    entering: Compressed,
}

impl Factors {
    /// Factorises the columns of a basis.
    ///
    /// # Errors
    ///
    /// The deficit, if the columns are no basis.
    pub(super) fn new(columns: Compressed, rows: usize) -> Result<Self, Deficit> {
        let mut factors =
            Factors { entering: Compressed::with_capacity(0, 0), ..Factors::default() };
        let by_row = columns.transposed(rows);
        let mut open_row = vec![true; rows];
        let mut open_slot = vec![true; columns.len()];
        let mut count: Vec<usize> =
            (0..columns.len()).map(|k| columns.entries(k).count()).collect();
        let mut queue: Vec<usize> = (0..columns.len()).filter(|&k| count[k] == 1).collect();
        while let Some(slot) = queue.pop() {
            let Some((row, value)) = columns.entries(slot).find(|e| open_row[e.0]) else {
                continue;
            };
            if value.abs() < MIN_FACTOR_PIVOT {
                continue;
            }
            (open_row[row], open_slot[slot]) = (false, false);
            factors.upper.push(Pivot { row, slot, value });
            for (other, _) in by_row.entries(row).filter(|e| open_slot[e.0]) {
                count[other] -= 1;
                if count[other] == 1 {
                    queue.push(other);
                }
            }
        }
        let open =
            |row: usize, open_slot: &[bool]| by_row.entries(row).filter(|e| open_slot[e.0]).count();
        let mut count: Vec<usize> =
            (0..rows).map(|i| if open_row[i] { open(i, &open_slot) } else { 0 }).collect();
        let mut queue: Vec<usize> = (0..rows).filter(|&i| count[i] == 1).collect();
        while let Some(row) = queue.pop() {
            let found = by_row.entries(row).find(|e| open_slot[e.0]);
            let Some((slot, value)) = found.filter(|e| e.1.abs() >= MIN_FACTOR_PIVOT) else {
                continue;
            };
            (open_row[row], open_slot[slot]) = (false, false);
            factors.lower.push(Pivot { row, slot, value });
            for (other, _) in columns.entries(slot).filter(|e| open_row[e.0]) {
                count[other] -= 1;
                if count[other] == 1 {
                    queue.push(other);
                }
            }
        }
        factors.rows = (0..rows).filter(|&i| open_row[i]).collect();
        factors.slots = (0..columns.len()).filter(|&k| open_slot[k]).collect();
        factors.columns = columns;
        factors.eliminate(rows)?;
        Ok(factors)
    }

    /// Eliminates the nucleus.
    fn eliminate(&mut self, rows: usize) -> Result<(), Deficit> {
        let (height, width) = (self.rows.len(), self.slots.len());
        let mut position = vec![usize::MAX; rows];
        self.rows.iter().enumerate().for_each(|(k, &i)| position[i] = k);
        self.dense = vec![0.0; height * width];
        for (c, &slot) in self.slots.iter().enumerate() {
            for (i, a) in self.columns.entries(slot).filter(|e| position[e.0] != usize::MAX) {
                self.dense[position[i] * width + c] += a;
            }
        }
        let mut dependent = Vec::new();
        let mut done = 0;
        for c in 0..width {
            let size = |r: usize, dense: &[f64]| dense[r * width + c].abs();
            let best = (done..height)
                .max_by(|&a, &b| size(a, &self.dense).total_cmp(&size(b, &self.dense)));
            let Some(best) = best.filter(|&r| size(r, &self.dense) >= MIN_FACTOR_PIVOT) else {
                dependent.push(self.slots[c]);
                continue;
            };
            if best != done {
                self.rows.swap(best, done);
                for k in 0..width {
                    self.dense.swap(best * width + k, done * width + k);
                }
            }
            let (head, tail) = self.dense.split_at_mut((done + 1) * width);
            let pivot_row = &head[done * width..];
            for row in tail.chunks_exact_mut(width).filter(|row| row[c] != 0.0) {
                let factor = row[c] / pivot_row[c];
                row[c] = factor;
                let rest = row[c + 1..].iter_mut().zip(&pivot_row[c + 1..]);
                rest.for_each(|(a, b)| *a -= factor * b);
            }
            done += 1;
        }
        if done == height && done == width {
            return Ok(());
        }
        Err(Deficit { slots: dependent, rows: self.rows[done..].to_vec() })
    }

    /// The number of exchanges since the basis was factorised.
    pub(super) fn exchanges(&self) -> usize {
        self.exchanges.len()
    }

    /// Solves `B x = b`; `b` is used up.
    pub(super) fn solve(&self, b: &mut [f64], x: &mut [f64]) {
        let take = |pivot: &Pivot, b: &mut [f64], x: &mut [f64]| {
            let value = b[pivot.row] / pivot.value;
            x[pivot.slot] = value;
            if value != 0.0 {
                let others = self.columns.entries(pivot.slot).filter(|e| e.0 != pivot.row);
                others.for_each(|(i, a)| b[i] -= a * value);
            }
        };
        self.lower.iter().for_each(|pivot| take(pivot, b, x));
        let size = self.rows.len();
        if size > 0 {
            let mut part: Vec<f64> = self.rows.iter().map(|&i| b[i]).collect();
            for r in 0..size {
                let row = &self.dense[r * size..r * size + r];
                part[r] -= dot(row, &part[..r]);
            }
            for r in (0..size).rev() {
                let row = &self.dense[r * size..(r + 1) * size];
                part[r] = (part[r] - dot(&row[r + 1..], &part[r + 1..])) / row[r];
            }
            for (&slot, value) in self.slots.iter().zip(part) {
                x[slot] = value;
                if value != 0.0 {
                    self.columns.entries(slot).for_each(|(i, a)| b[i] -= a * value);
                }
            }
        }
        self.upper.iter().rev().for_each(|pivot| take(pivot, b, x));
        for (k, &slot) in self.exchanges.iter().enumerate() {
            if x[slot] != 0.0 {
                let own = self.entering.entries(k).find(|e| e.0 == slot).map_or(1.0, |e| e.1);
                let value = x[slot] / own;
                self.entering.entries(k).for_each(|(i, a)| x[i] -= a * value);
                x[slot] = value;
            }
        }
    }

    /// Solves `B'y = c`; `c` is used up.
    pub(super) fn solve_transposed(&self, c: &mut [f64], y: &mut [f64]) {
        for (k, &slot) in self.exchanges.iter().enumerate().rev() {
            let (mut sum, mut own) = (c[slot], 1.0);
            for (i, a) in self.entering.entries(k) {
                if i == slot {
                    own = a;
                } else {
                    sum -= a * c[i];
                }
            }
            c[slot] = sum / own;
        }
        y.fill(0.0);
        let left = |slot: usize, y: &[f64]| -> f64 {
            c[slot] - self.columns.entries(slot).map(|(i, a)| a * y[i]).sum::<f64>()
        };
        // The entry of the pivot's own row is zero before it is set.
        self.upper.iter().for_each(|p| y[p.row] = left(p.slot, y) / p.value);
        let size = self.rows.len();
        if size > 0 {
            let mut part: Vec<f64> = self.slots.iter().map(|&slot| left(slot, y)).collect();
            for r in 0..size {
                let row = &self.dense[r * size..(r + 1) * size];
                part[r] /= row[r];
                let value = part[r];
                if value != 0.0 {
                    let rest = part[r + 1..].iter_mut().zip(&row[r + 1..]);
                    rest.for_each(|(v, a)| *v -= value * a);
                }
            }
            for r in (0..size).rev() {
                let row = &self.dense[r * size..r * size + r];
                let (rest, value) = part.split_at_mut(r);
                rest.iter_mut().zip(row).for_each(|(v, a)| *v -= value[0] * a);
            }
            self.rows.iter().zip(part).for_each(|(&i, v)| y[i] = v);
        }
        self.lower.iter().rev().for_each(|p| y[p.row] = left(p.slot, y) / p.value);
    }

    /// Appends an exchange of the column in a slot, for one that is `entering` in this basis.
    pub(super) fn exchange(&mut self, slot: usize, entering: &[f64]) {
        self.exchanges.push(slot);
        let entries = entering.iter().copied().enumerate();
        self.entering.push(entries.filter(|e| e.1.abs() > 1e-14 || e.0 == slot));
    }
}

/// Length from which a product is summed in several parts, so that its terms need not wait for each
/// other.
const LONG: usize = 48;
const LANES: usize = 8;

/// The product of two vectors of one length.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    if a.len() < LONG {
        return a.iter().zip(b).map(|(a, b)| a * b).sum();
    }
    let mut sums = [0.0; LANES];
    let (a_parts, b_parts) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest = a_parts.remainder().iter().zip(b_parts.remainder());
    let rest: f64 = rest.map(|(a, b)| a * b).sum();
    for (a, b) in a_parts.zip(b_parts) {
        for k in 0..LANES {
            sums[k] += a[k] * b[k];
        }
    }
    sums.iter().sum::<f64>() + rest
}
