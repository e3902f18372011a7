//! Programs with cones, loosened by a part of what accepted points may miss.
//!
//! Cones that only touch each other, or a bound, have no multipliers: what multipliers prove comes
//! ever closer to the optimum while they grow, until rounding ends that. Loosened, the program has
//! points inside all of its cones. What is proved for it holds for the program as well, and its
//! points are accepted.

use super::borderline::size;
use crate::presolve::{FIXED, Reduced};
use crate::program::ConeShape;
use crate::tolerance::{FEASIBILITY, SMALL_UNIT};

/// A program whose points contain those of another one: rows, bounds and heads of cones are wider
/// by a share of what points may miss.
///
/// # Arguments
///
/// * `x`: a point that tells how large columns without bounds are.
pub fn loosened(program: &Reduced, x: &[f64], share: f64) -> Reduced {
    let allowed = |size: f64| share * FEASIBILITY * if size < SMALL_UNIT { size } else { 1.0 };
    let mut wide = program.clone();
    for row in 0..program.rows.len() {
        let (lower, upper) = (program.row_lower[row], program.row_upper[row]);
        if lower < upper {
            wide.row_lower[row] -= allowed(size(program, x, row, lower));
            wide.row_upper[row] += allowed(size(program, x, row, upper));
        }
    }
    for (lower, upper) in wide.lower.iter_mut().zip(&mut wide.upper) {
        let reach = lower.abs().max(upper.abs());
        *lower -= allowed(reach);
        *upper += allowed(reach);
    }
    let mut defining = defining_rows(program);
    for cone in &mut wide.cones {
        for entry in &mut cone.entries[..cone.shape.head()] {
            if entry.place == FIXED {
                // `|tail| <= head` may be a row of squares.
                if cone.shape == ConeShape::Norm && entry.value > 0.0 {
                    let by = 0.5 * share * FEASIBILITY * entry.value.min(1.0 / entry.value);
                    entry.value += by;
                    wide.slack[entry.column] += by;
                }
            } else if let Some((row, a)) = defining[entry.place].take() {
                let by = allowed(size(program, x, row, program.row_upper[row]));
                // `... + a column = limit`, whose column may be larger.
                wide.row_lower[row] += a * by;
                wide.row_upper[row] += a * by;
                wide.upper[entry.place] += by;
            }
        }
    }
    wide
}

/// By column, the equation that gives its value, with its coefficient, if the column may be larger
/// as far as the cost, all other rows and the cones are concerned.
fn defining_rows(program: &Reduced) -> Vec<Option<(usize, f64)>> {
    let n = program.columns.len();
    let mut found = vec![None; n];
    let mut may_grow: Vec<bool> = program.linear.iter().map(|cost| *cost == 0.0).collect();
    for row in 0..program.rows.len() {
        let (lower, upper) = (program.row_lower[row], program.row_upper[row]);
        let (columns, values) = program.rows.vector(row);
        for (&j, &a) in columns.iter().zip(values) {
            if lower == upper {
                may_grow[j] &= found[j].is_none();
                found[j] = Some((row, a));
            } else {
                let limit = if a > 0.0 { upper } else { lower };
                may_grow[j] &= limit.is_infinite();
            }
        }
    }
    for entry in program.cones.iter().flat_map(|cone| cone.tail()) {
        if entry.place != FIXED {
            may_grow[entry.place] = false;
        }
    }
    for j in 0..n {
        let (rows, entries) = program.quadratic.vector(j);
        for (&i, _) in rows.iter().zip(entries).filter(|(_, p)| **p != 0.0) {
            (may_grow[i], may_grow[j]) = (false, false);
        }
    }
    (0..n).map(|j| found[j].filter(|_| may_grow[j])).collect()
}
