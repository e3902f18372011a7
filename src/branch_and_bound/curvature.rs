//! The check of objectives that are convex only as far as bounds tell.

use crate::error::Error;
use crate::model::Model;
use crate::presolve::{Domain, Propagator};
use crate::program::Program;

/// Refuses an objective whose distance from a convex one is seen within the bounds of the program of a
/// model, and within those that its rows imply.
///
/// # Arguments
///
/// * `for_all_parameters`: whether parameters may take any value of their ranges.
///
/// # Errors
///
/// [`ErrorKind::NotConvex`](crate::ErrorKind::NotConvex).
pub(super) fn check_curvature(
    model: &Model,
    program: &Program,
    for_all_parameters: bool,
) -> Result<(), Error> {
    if !model.is_convex_within_bounds() {
        return Ok(());
    }
    let mut domain = Domain::new(program);
    for parameter in model.parameters().filter(|_| for_all_parameters) {
        if let Some(range) = model.variable_ref(parameter)?.parameter_range() {
            domain.set_lower(parameter.index(), range.lower);
            domain.set_upper(parameter.index(), range.upper);
        }
    }
    // Without a point there is nothing to be seen.
    if Propagator::new(program).propagate_all(program, &mut domain).is_err() {
        return Ok(());
    }
    model.check_convexity(|j| domain.upper(j) - domain.lower(j))
}
