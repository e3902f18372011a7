//! Moves an interior-point solution onto the rows that it violates.
//!
//! An interior-point answer satisfies rows to about 1e-8 relative; over the hundreds of steps of a
//! plan such residuals add up, and in rows with large coefficients they are large. The polished
//! point is the nearest one, in a norm that weighs columns by their distance to the bounds, that
//! satisfies the equalities and the violated inequalities up to rounding. Columns that would leave
//! the box are held at their bounds, newly violated rows are added, and the point is moved again.

use faer::linalg::solvers::Solve;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Col, Side};

use crate::presolve::{Compressed, Reduced};
use crate::program::Program;
use crate::solver::StopToken;
use crate::sum::Sum;
use crate::tolerance::largest_magnitude;

/// The largest number of moves.
const MAX_MOVES: usize = 8;

/// Squared weight of a column at its bound, which may still move by rounding, and of one that is
/// held there.
const WEIGHT_AT_BOUND: f64 = 1e-12;
const WEIGHT_OF_HELD: f64 = 1e-20;

/// Polishes `x` in place: clips it to the box and removes the residuals of equalities and of
/// violated inequalities. Leaves `x` unchanged if these are too many or too degenerate to
/// factorise. Stops early if the token is over.
pub fn polish(program: &Reduced, x: &mut [f64], token: &StopToken) {
    let mut held = vec![false; x.len()];
    clip(program, x, &mut held);
    held.fill(false);
    let mut active: Vec<(usize, f64)> = Vec::with_capacity(program.rows.len());
    let mut is_active = vec![false; program.rows.len()];
    let mut moved = Vec::with_capacity(x.len());
    for _ in 0..MAX_MOVES {
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
        moved.clear();
        moved.extend_from_slice(x);
        let left_box = clip(program, x, &mut held);
        let settled = active.len() == known && !left_box;
        if settled || token.is_over() || !move_onto(program, &active, &held, x) {
            // Held columns that moved have moved by rounding only.
            x.copy_from_slice(&moved);
            return;
        }
    }
}

/// Polishes the continuous columns of a point of a program, the integral ones as they are.
///
/// A reduced program omits columns that are fixed or implied up to rounding. In a row with large
/// coefficients, their error may exceed the tolerance of the row, so here every column moves.
pub(crate) fn polish_leaf(program: &Program, point: &mut [f64], token: &StopToken) {
    let columns: Vec<usize> =
        (0..program.column_count()).filter(|&j| !program.integral[j]).collect();
    let mut position = vec![usize::MAX; program.column_count()];
    columns.iter().enumerate().for_each(|(k, &j)| position[j] = k);
    let pick = |from: &[f64]| columns.iter().map(|&j| from[j]).collect();
    let mut reduced = Reduced {
        lower: pick(&program.lower),
        upper: pick(&program.upper),
        rows: Compressed { start: vec![0], ..Compressed::default() },
        ..Reduced::default()
    };
    for row in 0..program.row_count() {
        let mut limits = [program.row_lower[row], program.row_upper[row]].map(Sum::new);
        let (index, entries) = program.row(row);
        for (&j, &a) in index.iter().zip(entries) {
            if program.integral[j] {
                limits.iter_mut().for_each(|limit| limit.add_product(-a, point[j]));
            } else {
                reduced.rows.index.push(position[j]);
                reduced.rows.value.push(a);
            }
        }
        if reduced.rows.index.len() > reduced.rows.start[reduced.rows.len()] {
            reduced.row_lower.push(limits[0].value());
            reduced.row_upper.push(limits[1].value());
            reduced.rows.start.push(reduced.rows.index.len());
        }
    }
    let mut x: Vec<f64> = pick(point);
    polish(&reduced, &mut x, token);
    columns.iter().zip(x).for_each(|(&j, v)| point[j] = v);
}

/// Moves `x` onto the limits of the given rows; `false` if that cannot be computed.
fn move_onto(program: &Reduced, active: &[(usize, f64)], held: &[bool], x: &mut [f64]) -> bool {
    let weight = |(j, &v): (usize, &f64)| {
        let room = (v - program.lower[j]).min(program.upper[j] - v).clamp(0.0, 1.0);
        if held[j] { WEIGHT_OF_HELD } else { (room * room).max(WEIGHT_AT_BOUND) }
    };
    let scale: Vec<f64> = x.iter().enumerate().map(weight).collect();
    let Some(normal) = normal_matrix(program, active, &scale) else { return false };
    let Ok(factor) = normal.sp_cholesky(Side::Lower) else { return false };
    let mut best = x.to_vec();
    let mut least = f64::INFINITY;
    let mut multiplier = Col::zeros(active.len());
    for _ in 0..4 {
        let miss = |e: usize| active[e].1 - activity(program, active[e].0, x);
        (0..active.len()).for_each(|e| multiplier[e] = miss(e));
        let size = largest_magnitude(multiplier.iter());
        if size.is_nan() || size >= least {
            break;
        }
        least = size;
        best.copy_from_slice(x);
        factor.solve_in_place(&mut multiplier);
        for (e, &(i, _)) in active.iter().enumerate() {
            let (columns, values) = program.rows.vector(i);
            for (&j, &a) in columns.iter().zip(values) {
                x[j] += scale[j] * a * multiplier[e];
            }
        }
    }
    x.copy_from_slice(&best);
    true
}

fn activity(program: &Reduced, row: usize, x: &[f64]) -> f64 {
    let (columns, values) = program.rows.vector(row);
    let mut sum = Sum::default();
    columns.iter().zip(values).for_each(|(&j, &a)| sum.add_product(a, x[j]));
    sum.value()
}

/// Clips `x` to the box and holds the columns that were outside; `true` if there was a new one.
fn clip(program: &Reduced, x: &mut [f64], held: &mut [bool]) -> bool {
    let mut new = false;
    for (j, value) in x.iter_mut().enumerate() {
        let inside = value.clamp(program.lower[j], program.upper[j]);
        if inside != *value && !held[j] {
            (held[j], new) = (true, true);
        }
        *value = inside;
    }
    new
}

/// `A D A'` over the active rows with a slight regularisation, or `None` if it would be too dense.
fn normal_matrix(
    program: &Reduced,
    active: &[(usize, f64)],
    scale: &[f64],
) -> Option<SparseColMat<usize, f64>> {
    const MAX_NORMAL_ENTRIES: usize = 4_000_000;
    let entries = active.iter().map(|&(i, _)| program.rows.vector(i).0.len()).sum();
    let mut rows = Compressed::with_capacity(active.len(), entries);
    for &(i, _) in active {
        let (columns, values) = program.rows.vector(i);
        rows.push(columns.iter().copied().zip(values.iter().copied()));
    }
    let by_column = rows.transposed(scale.len());
    let products = (0..scale.len()).map(|j| by_column.entries(j).len().pow(2)).sum::<usize>();
    if products > MAX_NORMAL_ENTRIES {
        return None;
    }
    let mut entries = Vec::with_capacity(products + active.len());
    let mut diagonal = vec![0.0_f64; active.len()];
    for (j, &d) in scale.iter().enumerate() {
        for (e, a) in by_column.entries(j) {
            for (f, b) in by_column.entries(j).filter(|(f, _)| *f <= e) {
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
