//! Moves an interior-point solution onto the rows that it misses.
//!
//! An interior-point answer satisfies rows to about 1e-8 relative; over the hundreds of steps of a
//! plan such residuals add up, and in rows with large coefficients they are large. The polished
//! point is the nearest one, in a norm that weighs columns by their distance to the bounds, that
//! satisfies the equalities and the missed inequalities to rounding. Where that leaves the box by a
//! hair, clipping and moving alternate, which converges to a point that misses neither.

use faer::linalg::solvers::Solve;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Col, Side};

use crate::presolve::Reduced;

/// A residual below this, in units of the row's largest coefficient, is none.
const NEGLIGIBLE: f64 = 1e-13;

/// Most alternations between box and equalities.
const ALTERNATIONS: usize = 20;

/// Most rounds in which inequalities that the last round came to miss are added.
const ROUNDS: usize = 4;

/// Polishes `x` in place: clips it to the box and removes the residuals of equalities and of missed
/// inequalities. Leaves `x` alone where these are too many or too degenerate to factorise.
pub fn polish(program: &Reduced, x: &mut [f64]) {
    clip(program, x);
    let mut active: Vec<(usize, f64)> = Vec::new();
    let mut is_active = vec![false; program.rows.len()];
    for _ in 0..ROUNDS {
        let known = active.len();
        for (row, is_active) in is_active.iter_mut().enumerate() {
            let (lower, upper) = (program.row_lower[row], program.row_upper[row]);
            let activity = activity(program, row, x);
            let missed = lower == upper || activity < lower || activity > upper;
            if missed && !*is_active {
                *is_active = true;
                active.push((row, if activity < lower { lower } else { upper }));
            }
        }
        if active.len() == known || !move_onto(program, &active, x) {
            return;
        }
    }
}

/// Moves `x` onto the limits of the given rows; `false` where that cannot be computed.
fn move_onto(program: &Reduced, active: &[(usize, f64)], x: &mut [f64]) -> bool {
    let scale: Vec<f64> = x
        .iter()
        .enumerate()
        .map(|(j, &v)| {
            let room = (v - program.lower[j]).min(program.upper[j] - v).clamp(0.0, 1.0);
            // A column at its bound may still move by rounding.
            (room * room).max(1e-12)
        })
        .collect();
    let Some(normal) = normal_matrix(program, active, &scale) else { return false };
    let Ok(factor) = normal.sp_cholesky(Side::Lower) else { return false };
    let residual = |x: &[f64]| {
        let miss = |e: usize| active[e].1 - activity(program, active[e].0, x);
        Col::from_fn(active.len(), miss)
    };
    let units: Vec<f64> = active.iter().map(|&(i, _)| largest(program, i)).collect();
    let size = |residual: &Col<f64>| {
        residual.iter().zip(&units).fold(0.0_f64, |m, (r, unit)| m.max(r.abs() / unit))
    };
    let project = |x: &mut [f64], residual: &Col<f64>| {
        let multiplier = factor.solve(residual);
        for (e, &(i, _)) in active.iter().enumerate() {
            let (columns, values) = program.rows.vector(i);
            for (&j, &a) in columns.iter().zip(values) {
                x[j] += scale[j] * a * multiplier[e];
            }
        }
    };
    let mut best = x.to_vec();
    let mut least = f64::INFINITY;
    for _ in 0..4 {
        let residual = residual(x);
        let size = size(&residual);
        if size.is_nan() || size >= least {
            break;
        }
        (least, best) = (size, x.to_vec());
        project(x, &residual);
    }
    x.copy_from_slice(&best);
    // Inside the box as well, if the rows allow it.
    for _ in 0..ALTERNATIONS {
        clip(program, x);
        let residual = residual(x);
        if size(&residual) <= (2.0 * least).max(NEGLIGIBLE) {
            return true;
        }
        project(x, &residual);
    }
    x.copy_from_slice(&best);
    true
}

fn activity(program: &Reduced, row: usize, x: &[f64]) -> f64 {
    let (columns, values) = program.rows.vector(row);
    columns.iter().zip(values).map(|(&j, &a)| a * x[j]).sum()
}

/// Largest coefficient of a row.
fn largest(program: &Reduced, row: usize) -> f64 {
    program.rows.vector(row).1.iter().fold(f64::MIN_POSITIVE, |m, a| m.max(a.abs()))
}

fn clip(program: &Reduced, x: &mut [f64]) {
    for (value, (&lower, &upper)) in x.iter_mut().zip(program.lower.iter().zip(&program.upper)) {
        *value = value.clamp(lower, upper);
    }
}

/// `A D A'` over the active rows with a trace of regularisation, or nothing when it would be too
/// dense.
fn normal_matrix(
    program: &Reduced,
    active: &[(usize, f64)],
    scale: &[f64],
) -> Option<SparseColMat<usize, f64>> {
    const MOST_ENTRIES: usize = 4_000_000;
    let mut by_column: Vec<Vec<(usize, f64)>> = vec![Vec::new(); scale.len()];
    for (e, &(i, _)) in active.iter().enumerate() {
        let (columns, values) = program.rows.vector(i);
        columns.iter().zip(values).for_each(|(&j, &a)| by_column[j].push((e, a)));
    }
    if by_column.iter().map(|c| c.len() * c.len()).sum::<usize>() > MOST_ENTRIES {
        return None;
    }
    let mut entries = Vec::new();
    let mut diagonal = vec![0.0_f64; active.len()];
    for (column, &d) in by_column.iter().zip(scale) {
        for &(e, a) in column {
            for &(f, b) in column.iter().filter(|(f, _)| *f <= e) {
                let entry = d * a * b;
                entries.push(Triplet::new(e, f, entry));
                if e == f {
                    diagonal[e] += entry;
                }
            }
        }
    }
    // Relative to each row: rows may have very different units.
    entries.extend(diagonal.iter().enumerate().map(|(e, d)| Triplet::new(e, e, 1e-14 * d)));
    SparseColMat::try_new_from_triplets(active.len(), active.len(), &entries).ok()
}
