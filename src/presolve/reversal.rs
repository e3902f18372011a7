//! What the idle value of a binary says.
//!
//! A binary that costs nothing and that only one row keeps from being 1 may as well be 1 wherever
//! that row lets it. So among the best points there is one where each such binary is 0 only if the
//! row *forbids* 1, and that is a row again: from `z = 1 => x <= 2` follows `z = 0 => x >= 2`. A
//! split of a disjunction's binary then divides the space in two, where without it the idle side
//! says next to nothing and overlaps the other one.
//!
//! All these rows hold together: raise one binary after the other while any can be raised. Each
//! step keeps a feasible point feasible and costs nothing, each raises the count of raised ones, and
//! where it ends all of the rows hold. Points may be lost, but never all of the best ones.

use crate::program::{Program, Row};

/// Longest row that is reversed, in entries: in long ones the reverse says little.
const LONGEST: usize = 30;

/// A program with the reversed rows of its binaries.
#[must_use]
pub fn with_reversed_rows(program: &Program) -> Program {
    let rows: Vec<Row> = program.integers.iter().filter_map(|&j| reversed(program, j)).collect();
    if rows.is_empty() { program.clone() } else { program.with_rows(&rows) }
}

/// The row that a binary's idle value implies, if there is one.
fn reversed(program: &Program, j: usize) -> Option<Row> {
    let binary = program.lower[j] == 0.0 && program.upper[j] == 1.0;
    if !binary || !program.quadratic_column(j).0.is_empty() {
        return None;
    }
    let cost = program.linear[j];
    let (hurt_up, hurt_down) = (hurting_sides(program, j, 1.0), hurting_sides(program, j, -1.0));
    let (direction, sides) = match (&hurt_up[..], &hurt_down[..]) {
        ([_], [_, ..]) if cost <= 0.0 => (1.0, hurt_up),
        ([_, ..], [_]) if cost >= 0.0 => (-1.0, hurt_down),
        _ => return None,
    };
    let (row, sign) = *sides.first()?;
    let (columns, values) = program.row(row);
    if columns.len() > LONGEST {
        return None;
    }
    // In the form `rest + m z <= limit`.
    let limit = sign * if sign > 0.0 { program.row_upper[row] } else { program.row_lower[row] };
    let (mut m, mut least, mut scale) = (0.0, 0.0, limit.abs());
    let mut terms = Vec::with_capacity(columns.len());
    for (&k, &a) in columns.iter().zip(values) {
        let a = sign * a;
        if k == j {
            m = a;
            continue;
        }
        let (p, q) = (a * program.lower[k], a * program.upper[k]);
        least += p.min(q);
        scale += p.abs().max(q.abs());
        terms.push((k, a));
    }
    // Idle means that the better value would break the row: rest >= limit - m (z = better).
    let lower = limit - if direction > 0.0 { m } else { 0.0 };
    let gap = lower - least;
    if terms.is_empty() || !scale.is_finite() || gap <= 1e-6 * scale.max(1.0) {
        return None;
    }
    // Relaxed by `gap` at the better value.
    let (coefficient, lower) = if direction > 0.0 { (gap, lower) } else { (-gap, lower - gap) };
    terms.push((j, coefficient));
    terms.sort_by_key(|t| t.0);
    let lower = lower - 8.0 * f64::EPSILON * (scale + gap);
    Some(Row { terms, lower, upper: f64::INFINITY, switch: Some(j) })
}

/// The sides of rows that keep a column from moving in a direction, with their signs in the form
/// `sign * row <= limit`.
fn hurting_sides(program: &Program, j: usize, direction: f64) -> Vec<(usize, f64)> {
    let (rows, values) = program.column(j);
    let mut sides = Vec::new();
    for (&row, &a) in rows.iter().zip(values) {
        let rises = a * direction > 0.0;
        if rises && program.row_upper[row].is_finite() {
            sides.push((row, 1.0));
        }
        if !rises && program.row_lower[row].is_finite() {
            sides.push((row, -1.0));
        }
    }
    sides
}
