//! Functions as the header of a log states them, and points that are near a program.

use crate::elementary::Elementary;
use crate::spatial::{Shape, SpatialProgram};

/// By how much a point may miss rows, bounds and functions to be stated in a log (no unit): less
/// than the checker allows.
const MOST_MISS: f64 = 5e-4;

/// The functions of a program, a line each.
pub(super) fn functions(program: &SpatialProgram) -> Vec<String> {
    let line = |result: usize, shape: &Shape| match shape {
        Shape::Bilinear([a, b]) => format!("{result} product {a} {b}"),
        Shape::Quotient([a, b]) => format!("{result} quotient {a} {b}"),
        Shape::Elementary { function: Elementary::Own(own), of } => {
            let name = Elementary::Own(own.clone()).to_string();
            let name: String = name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
            format!("{result} own {of} {name}")
        }
        Shape::Elementary { function, of } => format!("{result} {function} {of}"),
    };
    program.terms.iter().map(|term| line(term.result, &term.shape)).collect()
}

/// Whether a point misses nothing by more than a checker allows.
pub(super) fn is_near(of: &SpatialProgram, x: &[f64]) -> bool {
    let program = &of.program;
    let is_within = |value: f64, lower: f64, upper: f64| {
        value >= lower - MOST_MISS && value <= upper + MOST_MISS
    };
    let columns = (0..program.column_count()).all(|j| {
        let is_whole = !program.integral[j] || (x[j] - x[j].round()).abs() <= MOST_MISS;
        is_whole && is_within(x[j], program.lower[j], program.upper[j])
    });
    let row = |i: usize| {
        let (columns, values) = program.row(i);
        let sum: f64 = columns.iter().zip(values).map(|(&j, a)| a * x[j]).sum();
        is_within(sum, program.row_lower[i], program.row_upper[i])
    };
    columns
        && (0..program.row_count()).all(row)
        && of.terms.iter().all(|term| (x[term.result] - term.value(x)).abs() <= MOST_MISS)
}
