//! Bounds of semi-continuous variables that follow from what a known point costs.
//!
//! That a variable is 0 or anything from a limit on has no linear rows without an upper bound.
//! Where the model's rows imply none, a point within a box does: no better point costs more than
//! it, and that row may imply bounds. It cuts off worse points only.

use super::far::{DISTANCES, boxed};
use super::solve::{EarlierResults, Solve};
use crate::error::Error;
use crate::model::{Model, Name, StoredRow};
use crate::solution::Point;
use crate::solver::Control;

/// Nodes of the search within a box.
const BOX_NODES: u64 = 200;

/// Room of the row above the cost of the point, relative to it and at least absolute, so that the
/// point is not at its edge.
const CUTOFF_ROOM: f64 = 1e-3;

impl Solve<'_> {
    /// The model with a row that says that its objective is no worse than that of a point; `None`
    /// if no semi-continuous variable lacks a bound, or where no point is found or other points are
    /// asked for.
    pub(super) fn with_cutoff(&self) -> Result<Option<Model>, Error> {
        let Solve { model, options, rows, .. } = *self;
        let is_open =
            model.variables().any(|v| v.semicontinuous().is_some_and(|s| !s.is_bounded()));
        let objective = model.objective();
        let is_linear = objective.products().is_empty() && !objective.affine().terms().is_empty();
        if !is_open
            || !is_linear
            || rows.is_some()
            || options.pool > 1
            || options.parts().keep_leaves
        {
            return Ok(None);
        }
        let limit = options.node_limit.map_or(BOX_NODES, |limit| limit.min(BOX_NODES));
        let mut options = options.clone().with_node_limit(limit);
        options.proof = None;
        let options = &options;
        for far in DISTANCES {
            let boxed = &boxed(model, far)?;
            let token = &self.token.child(None);
            let solve = Solve { model: boxed, options, token, ..*self };
            let solved = solve.run(&EarlierResults::default(), &mut Control::default())?;
            let Some(values) = solved.found.points.into_iter().next() else { continue };
            let point = Point::new(boxed, values)?;
            let value = point.value(objective)?;
            let sign = model.sense().sign();
            let worst =
                value + sign * CUTOFF_ROOM * value.abs().max(1.0) - objective.affine().offset();
            let (lower, upper) = match sign > 0.0 {
                true => (f64::NEG_INFINITY, worst),
                false => (worst, f64::INFINITY),
            };
            let mut cut = model.clone();
            let name = Name::from("objective_cutoff");
            let name = name.free(|name| cut.has_statement(name));
            let terms = objective.affine().terms();
            cut.push_constraint(name, StoredRow { terms, lower, upper })?;
            return Ok(Some(cut));
        }
        Ok(None)
    }
}
