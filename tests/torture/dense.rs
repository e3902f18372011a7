//! Dense quadratic programs over columns with two values and a few others: convex or not
//! over the former, of full or low rank, with rows over some or all of them.
//!
//! Squares have negative weights only over columns with two values, and a product of one of these
//! with another column is a difference of squares; so the program is convex for each
//! assignment, and the oracle takes it as it is.

use carom::prelude::VariableKind;

use super::families::{BINARY, sign};
use super::generator::Random;
use crate::common::case::{Case, Column, Line, Square};
use crate::common::quadratic_program::dot;

pub(super) fn program(seed: u64) -> Case {
    let r = &mut Random::new(seed);
    let (two, others) = (3 + r.below(6), [0, 0, 1, 2, 3][r.below(5)]);
    let mut columns: Vec<Column> = (0..two).map(|_| column_with_two_values(r)).collect();
    for _ in 0..others {
        let lower = f64::from(r.within(-6, 3));
        let (kind, width) = match r.chance(0.15) {
            true => (VariableKind::Integer, 2),
            false => (VariableKind::Continuous, r.within(1, 8)),
        };
        columns.push(Column { kind, lower, upper: lower + f64::from(width) });
    }
    let n = columns.len();
    let mut squares = Vec::new();
    for _ in 0..1 + r.below(n + 1) {
        squares.push(square(r, n, n));
    }
    // Curvature of its own for each column, of any sign.
    let is_ridged = r.chance(0.4);
    for j in 0..if is_ridged { two } else { 0 } {
        let weight = 0.5 * f64::from(r.within(-12, 12));
        squares.push(Square { weight, coefficients: unit(n, &[j]), constant: 0.0 });
    }
    if r.chance(0.5) {
        for _ in 0..1 + r.below(3) {
            let Square { weight, coefficients, constant } = square(r, n, two);
            squares.push(Square { weight: -weight, coefficients, constant });
        }
    }
    if others > 0 && r.chance(0.3) {
        for _ in 0..1 + r.below(3) {
            // 2 b x = (b + x)^2 - b^2 - x^2
            let (b, x) = (r.below(two), two + r.below(others));
            let weight = 0.5 * f64::from(r.within(1, 6)) * sign(r);
            for (weight, columns) in [(weight, &[b, x][..]), (-weight, &[b]), (-weight, &[x])] {
                squares.push(Square { weight, coefficients: unit(n, columns), constant: 0.0 });
            }
        }
    }
    let scale = [1.0, 4.0, 16.0][r.below(3)];
    let linear = (0..n).map(|_| scale * 0.5 * f64::from(r.within(-9, 9))).collect();
    let anchor: Vec<f64> = columns
        .iter()
        .map(|column| if r.chance(0.5) { column.lower } else { column.upper })
        .collect();
    let lines = (0..r.below(4)).filter_map(|_| line(r, &columns, two, &anchor)).collect();
    let constant = f64::from(r.within(-9, 9));
    let maximize = r.chance(0.5);
    let mut case =
        Case { columns, lines, switches: Vec::new(), squares, linear, constant, maximize };
    if r.chance(0.1) {
        move_away(r, &mut case, two);
    }
    case
}

/// Moves the origins of some columns with two values, so that terms cancel. Of squares of numbers that
/// are further away, the last digits are rounding.
fn move_away(r: &mut Random, case: &mut Case, two: usize) {
    for j in 0..two {
        if case.columns[j].kind == VariableKind::Binary || r.chance(0.3) {
            continue;
        }
        let by = f64::from(r.within(-9, 9)) * 10.0_f64.powi(r.within(0, 2));
        let column = &mut case.columns[j];
        (column.lower, column.upper) = (column.lower + by, column.upper + by);
        for square in &mut case.squares {
            square.constant -= by * square.coefficients[j];
        }
        for line in &mut case.lines {
            let by = by * line.coefficients[j];
            (line.lower, line.upper) = (line.lower + by, line.upper + by);
        }
        case.constant -= by * case.linear[j];
    }
}

fn column_with_two_values(r: &mut Random) -> Column {
    if r.chance(0.7) {
        return BINARY;
    }
    let lower = f64::from(r.within(-4, 4));
    Column { kind: VariableKind::Integer, lower, upper: lower + 1.0 }
}

/// A square over most of the first columns.
fn square(r: &mut Random, n: usize, first: usize) -> Square {
    let mut coefficients = vec![0.0; n];
    for a in coefficients.iter_mut().take(first) {
        *a = if r.chance(0.8) { f64::from(r.within(-4, 4)) } else { 0.0 };
    }
    let weight = 2.0_f64.powi(r.within(-3, 2));
    Square { weight, coefficients, constant: f64::from(r.within(-3, 3)) }
}

fn unit(n: usize, columns: &[usize]) -> Vec<f64> {
    let mut coefficients = vec![0.0; n];
    columns.iter().for_each(|&j| coefficients[j] = 1.0);
    coefficients
}

/// A knapsack, a cover, a number of columns, an equation or a mixed row, near what a point has.
fn line(r: &mut Random, columns: &[Column], two: usize, anchor: &[f64]) -> Option<Line> {
    let n = columns.len();
    let mut coefficients = vec![0.0; n];
    let kind = r.below(5);
    let count = if kind == 4 { n } else { two };
    for a in coefficients.iter_mut().take(count) {
        *a = match kind {
            0 | 1 => f64::from(r.within(0, 9)),
            2 => 1.0,
            _ => f64::from(r.within(-3, 3)),
        };
    }
    let (at, off) = (dot(&coefficients, anchor), f64::from(r.within(-1, 3)));
    let (lower, upper) = match kind {
        0 => (f64::NEG_INFINITY, at + off),
        1 => (at - off, f64::INFINITY),
        2 | 3 if r.chance(0.6) => (at, at),
        _ if r.chance(0.5) => (at - off.abs(), at + off.abs()),
        _ => (f64::NEG_INFINITY, at + off),
    };
    let is_empty = coefficients.iter().all(|a| *a == 0.0);
    (!is_empty).then_some(Line { coefficients, lower, upper, scale: 1.0 })
}
