//! How steep a quadratic objective is at least: a diagonal matrix below `P`.
//!
//! If `P - diag(s)` is positive semidefinite, the objective grows by at least `s_j d_j^2 / 2` for
//! each column, whatever the others do. So a column without bounds cannot run away, and proofs need
//! no radius for it. Principal submatrices inherit `s`.

use std::sync::OnceLock;

use faer::{Mat, Side};

use super::Program;

/// The largest number of columns with products whose matrix is factorised.
const MAX_FACTORISED_COLUMNS: usize = 200;

/// The smallest steepness that is used, as a part of the diagonal (no unit).
const MIN_STEEPNESS: f64 = 1e-9;

/// The parts of the diagonal that are tried, as parts of the smallest squared pivot, which no
/// eigenvalue falls short of by much.
const DIAGONAL_PARTS: [f64; 3] = [0.1, 1e-3, 1e-5];

impl Program {
    /// `s >= 0` such that `P - diag(s)` is positive semidefinite, one entry a column; 0 where
    /// nothing is known.
    pub fn steepness(&self) -> &[f64] {
        self.steepness.get_or_init(|| find(self))
    }

    /// Takes note of further columns without curvature.
    pub(super) fn extend_steepness(&mut self) {
        if let Some(mut known) = self.steepness.take() {
            known.resize(self.column_count(), 0.0);
            self.steepness = OnceLock::from(known);
        }
    }
}

fn find(program: &Program) -> Vec<f64> {
    let n = program.column_count();
    let is_linked = |j: &usize| {
        let (rows, entries) = program.quadratic_column(*j);
        rows.iter().zip(entries).any(|(i, p)| i != j && *p != 0.0)
    };
    let mut steepness: Vec<f64> = (0..n).map(|j| program.quadratic_entry(j, j).max(0.0)).collect();
    let linked: Vec<usize> = (0..n).filter(is_linked).collect();
    if linked.is_empty() {
        return steepness;
    }
    let part = least_part(program, &linked, &steepness).unwrap_or(0.0);
    linked.iter().for_each(|&j| steepness[j] *= part);
    steepness
}

/// A part of the diagonal that may be taken off the matrix of some columns; `None` if there is
/// none.
fn least_part(program: &Program, columns: &[usize], diagonal: &[f64]) -> Option<f64> {
    let k = columns.len();
    if k > MAX_FACTORISED_COLUMNS || columns.iter().any(|&j| diagonal[j] <= 0.0) {
        return None;
    }
    let mut position = vec![usize::MAX; program.column_count()];
    columns.iter().enumerate().for_each(|(c, &j)| position[j] = c);
    // Powers of two scale without rounding.
    let scale = |j: usize| (-0.5 * diagonal[j].log2()).round().exp2();
    let mut matrix = Mat::<f64>::zeros(k, k);
    for (c, &j) in columns.iter().enumerate() {
        let (rows, entries) = program.quadratic_column(j);
        for (&i, &p) in rows.iter().zip(entries).filter(|(_, p)| **p != 0.0) {
            matrix[(position[i], c)] += p * scale(i) * scale(j);
        }
    }
    // A result outside the range of floats proves nothing.
    if matrix.col_iter().any(|column| column.iter().any(|entry| !entry.is_finite())) {
        return None;
    }
    let factor = |matrix: &Mat<f64>| {
        let factor = matrix.llt(Side::Lower).ok()?;
        (0..k).all(|r| factor.L()[(r, r)].is_normal()).then_some(factor)
    };
    let whole = factor(&matrix)?;
    let least = (0..k).map(|r| whole.L()[(r, r)].powi(2)).fold(f64::INFINITY, f64::min);
    // A factor in floats is that of a matrix whose entries differ by this much, relative to the
    // diagonal (Higham, Accuracy and Stability of Numerical Algorithms, theorem 10.3); twice, for
    // the subtraction.
    let size = k as f64;
    let rounding = 2.0 * size * (size + 2.0) * f64::EPSILON;
    DIAGONAL_PARTS
        .iter()
        .map(|part| part * least)
        .take_while(|part| *part > MIN_STEEPNESS)
        .find_map(|part| {
            let mut rest = matrix.clone();
            (0..k).for_each(|r| rest[(r, r)] *= 1.0 - part);
            factor(&rest).map(|_| 0.5 * part - rounding)
        })
}
