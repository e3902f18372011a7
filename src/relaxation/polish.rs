//! Moves an interior-point solution onto its equalities.
//!
//! An interior-point answer satisfies equalities to about 1e-8 relative; over the hundreds of
//! steps of a plan such residuals add up. The polished point is the nearest one, in a norm that
//! weighs columns by their distance to the bounds, that satisfies `A_E x = b_E` to rounding.

use faer::linalg::solvers::Solve;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Col, Side};

use crate::presolve::Reduced;

/// Polishes `x` in place: clips it to the box and removes equality residuals. Leaves `x` alone
/// where the equalities are too many or too degenerate to factorise.
pub fn polish(program: &Reduced, x: &mut [f64]) {
    for (value, (&lower, &upper)) in x.iter_mut().zip(program.lower.iter().zip(&program.upper)) {
        *value = value.clamp(lower, upper);
    }
    let equal = |i: &usize| program.row_lower[*i] == program.row_upper[*i];
    let equalities: Vec<usize> = (0..program.rows.len()).filter(equal).collect();
    if equalities.is_empty() {
        return;
    }
    let scale: Vec<f64> = x
        .iter()
        .enumerate()
        .map(|(j, &v)| {
            let room = (v - program.lower[j]).min(program.upper[j] - v).clamp(0.0, 1.0);
            // A column at its bound may still move by rounding.
            (room * room).max(1e-12)
        })
        .collect();
    let Some(normal) = normal_matrix(program, &equalities, &scale) else { return };
    let Ok(factor) = normal.sp_cholesky(Side::Lower) else { return };
    let mut best = x.to_vec();
    let mut best_residual = f64::INFINITY;
    for _ in 0..4 {
        let residual = Col::from_fn(equalities.len(), |e| {
            let (columns, values) = program.rows.vector(equalities[e]);
            let activity: f64 = columns.iter().zip(values).map(|(&j, &a)| a * x[j]).sum();
            program.row_upper[equalities[e]] - activity
        });
        let size = residual.iter().fold(0.0_f64, |m, r| m.max(r.abs()));
        if size.is_nan() || size >= best_residual {
            break;
        }
        (best_residual, best) = (size, x.to_vec());
        let multiplier = factor.solve(&residual);
        for (e, &i) in equalities.iter().enumerate() {
            let (columns, values) = program.rows.vector(i);
            for (&j, &a) in columns.iter().zip(values) {
                x[j] += scale[j] * a * multiplier[e];
            }
        }
    }
    x.copy_from_slice(&best);
}

/// `A_E D A_E'` with a trace of regularisation, or nothing when it would be too dense.
fn normal_matrix(
    program: &Reduced,
    equalities: &[usize],
    scale: &[f64],
) -> Option<SparseColMat<usize, f64>> {
    const MOST_ENTRIES: usize = 4_000_000;
    let mut by_column: Vec<Vec<(usize, f64)>> = vec![Vec::new(); scale.len()];
    for (e, &i) in equalities.iter().enumerate() {
        let (columns, values) = program.rows.vector(i);
        columns.iter().zip(values).for_each(|(&j, &a)| by_column[j].push((e, a)));
    }
    if by_column.iter().map(|c| c.len() * c.len()).sum::<usize>() > MOST_ENTRIES {
        return None;
    }
    let mut entries = Vec::new();
    let mut largest = 0.0_f64;
    for (column, &d) in by_column.iter().zip(scale) {
        for &(e, a) in column {
            for &(f, b) in column.iter().filter(|(f, _)| *f <= e) {
                let entry = d * a * b;
                entries.push(Triplet::new(e, f, entry));
                largest = largest.max(entry.abs());
            }
        }
    }
    for e in 0..equalities.len() {
        entries.push(Triplet::new(e, e, 1e-14 * largest));
    }
    SparseColMat::try_new_from_triplets(equalities.len(), equalities.len(), &entries).ok()
}
