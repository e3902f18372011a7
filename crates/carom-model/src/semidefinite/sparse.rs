//! Sparse Cholesky factors with their residuals.
//!
//! The factorisation goes row by row ("up-looking": Davis, Direct Methods for Sparse Linear
//! Systems, chapter 4), along the elimination tree.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

use super::scaled::{Factored, INVERSE_ITERATIONS, Scaled, is_covered};
use crate::sum::Sum;

const NONE: usize = usize::MAX;

/// A triangle by columns, each column sorted by row.
struct Triangle {
    start: Vec<usize>,
    index: Vec<usize>,
    value: Vec<f64>,
}

impl Triangle {
    /// From entries `(row, column, value)`.
    fn new(n: usize, entries: impl Iterator<Item = (usize, usize, f64)> + Clone) -> Self {
        let mut start = vec![0; n + 1];
        entries.clone().for_each(|(_, column, _)| start[column + 1] += 1);
        (0..n).for_each(|k| start[k + 1] += start[k]);
        let mut next = start.clone();
        let mut both = vec![(0, 0.0); start[n]];
        for (row, column, value) in entries {
            both[next[column]] = (row, value);
            next[column] += 1;
        }
        (0..n).for_each(|k| both[start[k]..start[k + 1]].sort_unstable_by_key(|entry| entry.0));
        let (index, value) = both.into_iter().unzip();
        Triangle { start, index, value }
    }

    fn column(&self, k: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.start[k]..self.start[k + 1];
        self.index[range.clone()].iter().copied().zip(self.value[range].iter().copied())
    }
}

/// An order of elimination with little fill, and how many products the factor sums up; `None` if
/// there is no memory for it.
pub(super) fn order(matrix: &Scaled) -> Option<(Vec<usize>, f64)> {
    let n = matrix.diagonal.len();
    let upper = Triangle::new(n, matrix.pairs.iter().copied());
    let pattern = SymbolicSparseColMatRef::new_checked(n, n, &upper.start, None, &upper.index);
    let scratch = amd::order_maybe_unsorted_scratch::<usize>(n, upper.index.len());
    let mut memory = MemBuffer::try_new(scratch).ok()?;
    let (mut order, mut eliminated) = (vec![0; n], vec![0; n]);
    let control = amd::Control::default();
    let stack = MemStack::new(&mut memory);
    let work =
        amd::order_maybe_unsorted(&mut order, &mut eliminated, pattern, control, stack).ok()?;
    Some((order, work.n_mult_subs_ldl))
}

/// Factorises a matrix in some order; see `block::factor`.
pub(super) fn factor(matrix: &Scaled, order: &[usize], room: &[f64]) -> Factored {
    let n = order.len();
    let mut place = vec![0; n];
    order.iter().enumerate().for_each(|(k, &j)| place[j] = k);
    let diagonal = (0..n).map(|k| (k, k, matrix.diagonal[order[k]]));
    let pairs = matrix.pairs.iter().map(|&(i, j, a)| (place[i], place[j], a));
    let upper = pairs.clone().map(|(i, j, a)| (i.min(j), i.max(j), a));
    let lower = pairs.map(|(i, j, a)| (i.max(j), i.min(j), a));
    let upper = Triangle::new(n, upper.chain(diagonal.clone()));
    let lower = Triangle::new(n, lower.chain(diagonal));
    let back = |vector: Vec<f64>| -> Vec<f64> { (0..n).map(|j| vector[place[j]]).collect() };
    let factor = match Factor::of(&upper) {
        Ok(factor) => factor,
        Err(vector) => return Factored::Weak(back(vector)),
    };
    let missed = back(factor.missed(&lower));
    if is_covered(matrix, &missed, room) {
        return Factored::Covered;
    }
    Factored::Weak(back(factor.weakest()))
}

/// A lower triangle `L`, the diagonal first in each column.
struct Factor(Triangle);

impl Factor {
    /// `L` with `L L' = A` up to rounding, from the upper triangle of `A`; otherwise a vector that
    /// `A` turns back.
    fn of(upper: &Triangle) -> Result<Self, Vec<f64>> {
        let n = upper.start.len() - 1;
        let parent = elimination_tree(upper);
        let (mut seen, mut row) = (vec![NONE; n], Vec::with_capacity(n));
        let mut start = vec![0; n + 1];
        for k in 0..n {
            write_row(upper, &parent, k, &mut seen, &mut row);
            row.iter().for_each(|&j| start[j + 1] += 1);
            start[k + 1] += 1;
        }
        (0..n).for_each(|k| start[k + 1] += start[k]);
        let mut next = start.clone();
        let (mut index, mut value) = (vec![0; start[n]], vec![0.0; start[n]]);
        let mut x = vec![0.0; n];
        seen.fill(NONE);
        for k in 0..n {
            write_row(upper, &parent, k, &mut seen, &mut row);
            upper.column(k).for_each(|(i, a)| x[i] = a);
            let mut pivot = std::mem::take(&mut x[k]);
            for &j in &row {
                let entry = std::mem::take(&mut x[j]) / value[start[j]];
                for p in start[j] + 1..next[j] {
                    x[index[p]] -= value[p] * entry;
                }
                pivot -= entry * entry;
                (index[next[j]], value[next[j]]) = (k, entry);
                next[j] += 1;
            }
            // NaN is no pivot.
            if pivot.is_nan() || pivot <= 0.0 {
                // The steps of the others that make the most of one of this.
                let mut vector = vec![0.0; n];
                for &j in &row {
                    vector[j] = -value[next[j] - 1];
                    next[j] -= 1;
                }
                solve_transposed(k, (&start, &next), (&index, &value), &mut vector);
                vector[k] = 1.0;
                return Err(vector);
            }
            (index[next[k]], value[next[k]]) = (k, pivot.sqrt());
            next[k] += 1;
        }
        Ok(Factor(Triangle { start, index, value }))
    }

    /// The sums of the magnitudes in each row of `A - L L'`, from the lower triangle of `A`.
    fn missed(&self, lower: &Triangle) -> Vec<f64> {
        let Factor(factor) = self;
        let n = factor.start.len() - 1;
        let mut sums = vec![Sum::default(); n];
        let mut touched: Vec<usize> = Vec::new();
        let mut is_touched = vec![false; n];
        let mut missed = vec![0.0; n];
        // The rounding of an entry, which is a sum with twice the digits; rows of `L` have squares
        // that sum up to 4.
        let mut terms = vec![0_usize; n];
        factor.index.iter().for_each(|&row| terms[row] += 1);
        let most = terms.into_iter().max().unwrap_or(0) as f64;
        let rounding = 16.0 * ((most + 4.0) * f64::EPSILON).powi(2);
        // By row: the columns whose next entry is in it, as linked lists.
        let (mut first, mut link) = (vec![NONE; n], vec![NONE; n]);
        let mut next: Vec<usize> = factor.start[..n].to_vec();
        for j in 0..n {
            let mut touch = |i: usize, is_touched: &mut Vec<bool>| {
                if !is_touched[i] {
                    is_touched[i] = true;
                    touched.push(i);
                }
            };
            for (i, a) in lower.column(j) {
                touch(i, &mut is_touched);
                sums[i].add(a);
            }
            (link[j], first[j]) = (first[j], j);
            let mut column = first[j];
            while column != NONE {
                let (begin, end) = (next[column], factor.start[column + 1]);
                let entry = -factor.value[begin];
                for p in begin..end {
                    let i = factor.index[p];
                    touch(i, &mut is_touched);
                    sums[i].add_product(factor.value[p], entry);
                }
                let following = link[column];
                next[column] = begin + 1;
                if begin + 1 < end {
                    let row = factor.index[begin + 1];
                    (link[column], first[row]) = (first[row], column);
                }
                column = following;
            }
            for i in touched.drain(..) {
                let rest = std::mem::take(&mut sums[i]).value().abs() + rounding;
                is_touched[i] = false;
                missed[i] += rest;
                if i != j {
                    missed[j] += rest;
                }
            }
        }
        missed.iter_mut().for_each(|sum| *sum *= 1.0 + (n as f64 + 4.0) * f64::EPSILON);
        missed
    }

    /// A vector that the matrix makes about as short as it can.
    fn weakest(&self) -> Vec<f64> {
        let Factor(Triangle { start, index, value }) = self;
        let n = start.len() - 1;
        let ends = &start[1..];
        let mut vector: Vec<f64> = (0..n).map(|k| 1.0 + 0.5 * (k as f64).sin()).collect();
        for _ in 0..INVERSE_ITERATIONS {
            for j in 0..n {
                vector[j] /= value[start[j]];
                for p in start[j] + 1..ends[j] {
                    vector[index[p]] -= value[p] * vector[j];
                }
            }
            solve_transposed(n, (start, ends), (index, value), &mut vector);
            let size = vector.iter().fold(f64::MIN_POSITIVE, |m, v| m.max(v.abs()));
            vector.iter_mut().for_each(|v| *v /= size);
        }
        vector
    }
}

/// Solves `L' x = b` in place, with the first `k` rows and columns of `L`, whose columns end at
/// `ends`.
fn solve_transposed(
    k: usize,
    (start, ends): (&[usize], &[usize]),
    (index, value): (&[usize], &[f64]),
    x: &mut [f64],
) {
    for j in (0..k).rev() {
        let below = start[j] + 1..ends[j];
        let sum: f64 = below.map(|p| value[p] * x[index[p]]).sum();
        x[j] = (x[j] - sum) / value[start[j]];
    }
}

/// By column, the row of the first entry below the diagonal of its factor.
fn elimination_tree(upper: &Triangle) -> Vec<usize> {
    let n = upper.start.len() - 1;
    let (mut parent, mut ancestor) = (vec![NONE; n], vec![NONE; n]);
    for k in 0..n {
        for (row, _) in upper.column(k) {
            let mut i = row;
            while i != NONE && i < k {
                let next = std::mem::replace(&mut ancestor[i], k);
                if next == NONE {
                    parent[i] = k;
                }
                i = next;
            }
        }
    }
    parent
}

/// Writes the columns of a row of the factor, without the diagonal, each before its ancestors.
fn write_row(
    upper: &Triangle,
    parent: &[usize],
    k: usize,
    seen: &mut [usize],
    row: &mut Vec<usize>,
) {
    row.clear();
    seen[k] = k;
    for (start, _) in upper.column(k) {
        let mut i = start;
        while i < k && seen[i] != k {
            seen[i] = k;
            row.push(i);
            i = parent[i];
        }
    }
    // Ancestors have larger numbers.
    row.sort_unstable();
}
