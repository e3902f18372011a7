//! Piecewise-affine functions as rows.
//!
//! Takes a variable that is a piecewise-affine function of an expression; leaves rows, and binaries
//! if one side does not suffice (Vielma, Ahmed and Nemhauser, Mixed-integer models for nonseparable
//! piecewise-linear optimization: unifying framework and extensions, Operations Research 58, 2010).
//!
//! The function is first restricted to the range of its argument, and breakpoints without a bend
//! are dropped. One piece is an equation. A convex function that the model pushes only down
//! (`reformulate/direction.rs`) is one inequality per piece. All others use the incremental
//! formulation over `n` pieces `(x0, y0), ..., (xn, yn)`:
//!
//! * `e = x0 + (x1 - x0) d1 + ... + (xn - x(n-1)) dn`, and the same for `w` with the `y`;
//! * `1 >= d1 >= z1 >= d2 >= z2 >= ... >= dn >= 0` with `n - 1` binaries `z`.
//!
//! Its relaxation is the convex hull of the graph, and it has no big-M.

use super::direction::Tie;
use super::lowering::Lowering;
use crate::error::Error;
use crate::model::{Affine, PiecewiseAffine, Variable, VariableKind};

/// Adds the rows of `result = graph(of)`.
pub(super) fn apply(
    result: Variable,
    of: &Affine,
    graph: &PiecewiseAffine,
    tie: Tie,
    lowering: &mut Lowering<'_>,
) -> Result<(), Error> {
    let (range, domain) = (lowering.model.range(of)?, graph.domain());
    let inside = domain.lower <= range.lower && range.upper <= domain.upper;
    let common = domain.intersection(range);
    if common.lower == common.upper {
        if !inside {
            lowering.affine_row(of.clone(), domain.lower, domain.upper)?;
        }
        let value = graph.value_near(common.lower);
        return lowering.affine_row(result.into(), value, value);
    }
    let graph = graph.restricted(range);
    let pieces: Vec<(f64, f64)> = graph.pieces().collect();
    let one_sided = pieces.len() == 1 || tie != Tie::Exact;
    if one_sided && !inside {
        lowering.affine_row(of.clone(), domain.lower, domain.upper)?;
    }
    let (none, any) = (f64::NEG_INFINITY, f64::INFINITY);
    if let [(slope, start)] = pieces[..] {
        return lowering.affine_row(result - slope * of, start, start);
    }
    if tie != Tie::Exact {
        for (slope, start) in pieces {
            let (lower, upper) = if tie == Tie::Above { (start, any) } else { (none, start) };
            lowering.affine_row(result - slope * of, lower, upper)?;
        }
        return Ok(());
    }
    let points = graph.points();
    let (mut x, mut y) = (Affine::constant(points[0].0), Affine::constant(points[0].1));
    let mut before: Option<Variable> = None;
    for (k, pair) in points.windows(2).enumerate() {
        let share = lowering.column("share", VariableKind::Continuous, 0.0, 1.0)?;
        x += (pair[1].0 - pair[0].0) * share;
        y += (pair[1].1 - pair[0].1) * share;
        if let Some(full) = before {
            lowering.affine_row(share - full, none, 0.0)?;
        }
        if k + 2 < points.len() {
            let full = lowering.column("full", VariableKind::Binary, 0.0, 1.0)?;
            lowering.affine_row(full - share, none, 0.0)?;
            before = Some(full);
        }
    }
    lowering.affine_row(of - x, 0.0, 0.0)?;
    lowering.affine_row(result - y, 0.0, 0.0)
}
