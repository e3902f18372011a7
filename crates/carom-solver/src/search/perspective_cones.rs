//! States squares of the objective as cones, if binaries switch enough of them off.
//!
//! Takes an objective that is a sum of squares of single columns; leaves a linear one over further
//! columns `s`, each with its cone `x^2 <= s * 1`. If a column is 0 while a binary is 0,
//! [`tighten_switched_cones`] makes of such a cone its perspective `x^2 <= s b` (Frangioni and
//! Gentile, Perspective cuts for a class of convex 0-1 mixed integer programs, Mathematical
//! Programming 106, 2006). The search cuts the cones off by tangents, so that its relaxations are
//! linear programs, to which all cuts of rows apply.
//!
//! Small programs keep their squares, see `perspective`: their nodes are few, and one quadratic
//! program each.

use super::perspective::switched_squares;
use crate::presolve::tighten_switched_cones;
use crate::program::{Cone, ConeRole, ConeShape, Program};
use crate::solver::StopToken;

/// Fewest columns of a program whose squares become cones, and the least share of these squares
/// that binaries switch off.
const LEAST_COLUMNS: usize = 1000;
const LEAST_SHARE: f64 = 0.5;

/// As [`squares_as_cones`], for programs that are large enough.
pub(crate) fn with_perspective_cones(program: &Program, token: &StopToken) -> Option<Program> {
    let is_large = program.column_count() >= LEAST_COLUMNS;
    if is_large { squares_as_cones(program, token) } else { None }
}

/// States the squares of an objective as cones; `None` if that is not possible, or binaries switch
/// too few of them. Columns and rows keep their numbers; the further columns follow. No point is
/// lost or won, and none changes its objective.
pub fn squares_as_cones(program: &Program, token: &StopToken) -> Option<Program> {
    let is_wanted = program.cones.is_empty()
        && !program.integers.is_empty()
        && program.quadratic.compute_nnz() > 0;
    let squares = if is_wanted { squares(program)? } else { return None };
    let mut switched: Vec<usize> = switched_squares(program, token)
        .into_iter()
        .filter(|square| square.value == 0.0)
        .map(|square| square.column)
        .collect();
    switched.dedup();
    let enough = LEAST_SHARE * squares.len() as f64;
    if switched.is_empty() || (switched.len() as f64) < enough || token.is_over() {
        return None;
    }
    let old = program.column_count();
    let one = old + squares.len();
    let upper: Vec<f64> = squares.iter().map(|square| square.largest).chain([1.0]).collect();
    let mut stated = program.clone();
    stated.append_continuous(&upper, &[])?;
    stated.lower[one] = 1.0;
    let mut linear = stated.linear.clone();
    let mut cones = Vec::with_capacity(squares.len());
    for (k, square) in squares.iter().enumerate() {
        linear[old + k] = 0.5 * square.curvature;
        let columns = vec![old + k, one, square.column];
        cones.push(Cone { shape: ConeShape::Rotated, columns, role: ConeRole::Square });
    }
    stated.rewrite_objective(linear, &[], program.offset)?;
    stated.set_cones(cones);
    tighten_switched_cones(&stated, token)
}

/// A square of the objective.
struct Square {
    column: usize,
    curvature: f64,
    /// Its largest value within the bounds of the column.
    largest: f64,
}

/// The squares of an objective; `None` if it has products, or if a column of them has no bound.
fn squares(program: &Program) -> Option<Vec<Square>> {
    let mut squares = Vec::new();
    for column in 0..program.column_count() {
        let curvature = match program.quadratic_column(column) {
            (&[], _) => continue,
            (&[i], &[p]) if i == column && p >= 0.0 => p,
            _ => return None,
        };
        let size = program.lower[column].abs().max(program.upper[column].abs());
        let largest = (size * size).next_up();
        if curvature > 0.0 {
            let square = Square { column, curvature, largest };
            squares.push(largest.is_finite().then_some(square)?);
        }
    }
    Some(squares)
}
