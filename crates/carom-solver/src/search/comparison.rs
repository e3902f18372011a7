//! The comparison of a strengthened program with the original at accepted points.
//!
//! Before the search, big-Ms are tightened, costs are bent, cuts are added, and bounds are probed.
//! All of that must keep every point with whole integers. An accepted point satisfies the model. A
//! strengthened program that excludes it, or makes it dearer, was derived wrongly, and none of its
//! bounds can be believed.
//!
//! Accepted points miss rows by up to the tolerance, and what is derived from rows multiplies what
//! they miss. The margins below are far above that, and far below what a wrong rule does.

use super::task::SolveTask;
use crate::presolve::Domain;
use crate::program::{Cone, Program};

/// By how much an accepted point may miss a strengthened row or a bound, in units of the largest
/// coefficient, and relative to the sum of its terms (no unit).
const COEFFICIENT_MISS: f64 = 1e-4;
const TERMS_MISS: f64 = 1e-8;

/// The same for rows and bounds of a program with cones, which make the root of a miss.
const ROOTED_MISS: [f64; 2] = [0.125 * COEFFICIENT_MISS * COEFFICIENT_MISS, 1e-13];

/// By how much a value of the objective may be off, relative to the sum of its terms (no unit).
const OBJECTIVE_ROUNDING: f64 = 1e-9;

/// An error of a strengthened program about an accepted point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Contradiction {
    /// Its objective is higher in the strengthened program than in the original.
    Objective,
    /// The row excludes it.
    Row(usize),
    /// The bounds of the column exclude it.
    Column(usize),
    /// A cut that was found at a node excludes it.
    NodeCut,
}

/// Compares the program of a task, and the bounds of its root, with the exact program at an
/// accepted point. `None` if they agree, or if the task has no exact program.
pub(super) fn contradiction(
    task: &SolveTask<'_>,
    root: &Domain,
    x: &[f64],
) -> Option<Contradiction> {
    let exact = task.exact?;
    let program = task.program;
    let excluded = |j: &usize| {
        is_outside(exact.integral[*j], root.bounds(*j), x[*j], COEFFICIENT_MISS)
            && !is_explained(exact, *j, root.bounds(*j), x[*j])
    };
    if let Some(j) = (0..x.len()).find(excluded) {
        return (!is_excluded(exact, x)).then_some(Contradiction::Column(j));
    }
    if std::ptr::eq(exact, program) {
        return None;
    }
    if let Some(row) = (0..program.row_count())
        .find(|&row| is_missed(program, row, x, [COEFFICIENT_MISS, TERMS_MISS]))
    {
        return (!is_excluded(exact, x)).then_some(Contradiction::Row(row));
    }
    is_dearer(program, exact, x, task.options.feasibility).then_some(Contradiction::Objective)
}

/// Whether bounds exclude a value by more than `allowed` of its size, or of 1.
fn is_outside(is_integral: bool, [lower, upper]: [f64; 2], value: f64, allowed: f64) -> bool {
    let miss = (lower - value).max(value - upper);
    miss > if is_integral { 0.5 } else { allowed * value.abs().max(1.0) }
}

/// Whether a column misses derived bounds by no more than columns miss their own, because an
/// equation gives its value as that of others with far larger coefficients.
fn is_explained(exact: &Program, column: usize, [lower, upper]: [f64; 2], value: f64) -> bool {
    let (below, above) = (lower - value, value - upper);
    let own = if below > above { exact.lower[column] } else { exact.upper[column] };
    let explains = |row: usize| {
        let (columns, values) = exact.row(row);
        let own = columns.iter().zip(values).find(|(j, _)| **j == column);
        let largest = values.iter().fold(0.0_f64, |most, a| most.max(a.abs()));
        exact.row_lower[row] == exact.row_upper[row]
            && own.is_some_and(|(_, a)| below.max(above) * a.abs() <= COEFFICIENT_MISS * largest)
    };
    !exact.integral[column] && own.is_infinite() && (0..exact.row_count()).any(explains)
}

/// Whether the exact program itself excludes an accepted point, which then tells nothing about what
/// was derived from it. Presolve makes equations of rows that hold as equations at an optimum, and
/// expressions in cones are columns of which the model knows nothing: a point that the model
/// accepts need not satisfy either.
pub(super) fn is_excluded(exact: &Program, x: &[f64]) -> bool {
    let has_cones = !exact.cones.is_empty();
    let miss = if has_cones { ROOTED_MISS } else { [COEFFICIENT_MISS, TERMS_MISS] };
    let is_outside =
        |j| is_outside(exact.integral[j], [exact.lower[j], exact.upper[j]], x[j], miss[0]);
    (0..x.len()).any(is_outside)
        || (0..exact.row_count()).any(|row| is_missed(exact, row, x, miss))
        || exact.cones.iter().any(|cone| is_cone_missed(cone, x))
}

/// Whether a point misses a cone by so much that bounds from it may be missed: by the root of what
/// the head is missed by, times twice its size.
fn is_cone_missed(cone: &Cone, x: &[f64]) -> bool {
    let size = cone.columns.iter().fold(1.0_f64, |size, &j| size.max(x[j].abs()));
    8.0 * cone.miss(x) * size > COEFFICIENT_MISS * COEFFICIENT_MISS
}

/// Whether a point misses a row.
fn is_missed(
    program: &Program,
    row: usize,
    x: &[f64],
    [of_coefficient, of_terms]: [f64; 2],
) -> bool {
    let (columns, values) = program.row(row);
    let (mut sum, mut size, mut largest) = (0.0, 0.0, 0.0_f64);
    for (&j, &a) in columns.iter().zip(values) {
        let value = x[j];
        sum += a * value;
        size += (a * value).abs();
        largest = largest.max(a.abs());
    }
    let (lower, upper) = (program.row_lower[row], program.row_upper[row]);
    let limit = if lower - sum > sum - upper { lower } else { upper };
    let miss = (lower - sum).max(sum - upper);
    miss > of_coefficient * largest + of_terms * (size + limit.abs())
}

/// Whether the strengthened objective is above the exact one by more than the point's violations
/// and rounding explain.
fn is_dearer(program: &Program, exact: &Program, x: &[f64], feasibility: f64) -> bool {
    let excess = program.objective(x) - exact.objective(x);
    if excess <= 0.0 {
        return false;
    }
    let (gradients, mut size) = ([program, exact].map(|p| p.gradient(x)), 0.0);
    let [strong, plain] = &gradients;
    for (j, value) in x.iter().enumerate() {
        let slope = if exact.integral[j] { 0.0 } else { (strong[j] - plain[j]).abs() };
        size += 10.0 * feasibility * slope;
        size += OBJECTIVE_ROUNDING * (strong[j].abs() + plain[j].abs()) * value.abs();
    }
    excess > size + OBJECTIVE_ROUNDING * (program.offset.abs() + exact.offset.abs() + 1.0)
}
