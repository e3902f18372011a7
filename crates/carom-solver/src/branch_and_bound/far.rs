//! Boxes for models with an unbounded objective.

use crate::error::Error;
use crate::model::Model;

/// Distances of the sides of a box that replace missing bounds, in the units of the variables.
pub(super) const DISTANCES: [f64; 2] = [1e3, 1e6];

/// The model with bounds in place of missing ones: at a distance from 0 or, where 0 is outside the
/// other bound, from that one.
pub(super) fn boxed(model: &Model, far: f64) -> Result<Model, Error> {
    let mut boxed = model.clone();
    for variable in model.variables() {
        let bounds = variable.bounds();
        let (mut lower, mut upper) = (bounds.lower, bounds.upper);
        if lower == f64::NEG_INFINITY {
            lower = -far + upper.min(0.0);
        }
        if upper == f64::INFINITY {
            upper = far + lower.max(0.0);
        }
        if (lower, upper) != (bounds.lower, bounds.upper) {
            boxed.set_bounds(variable.id(), lower, upper)?;
        }
    }
    Ok(boxed)
}
