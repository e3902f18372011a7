//! Models whose objective falls, inside a box.

use crate::error::Error;
use crate::model::Model;

/// Distances that variables without bounds may go in a box, in their units.
pub(super) const DISTANCES: [f64; 2] = [1e3, 1e6];

/// A model in which variables without bounds have some: so far from 0, or from their other bound.
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
