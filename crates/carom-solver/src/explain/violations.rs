//! The violations of a model at a point.

#[cfg(doc)]
use crate::error::ErrorKind;
use crate::error::{Error, check_finite, check_length};
use crate::model::Model;
use crate::solution::{Point, Verification, Violation};

/// Lists all bounds, integrality and semi-continuity conditions, rows, indicators, disjunctions,
/// logic statements, functions and ordered sets that a point violates, the worst
/// [relative](Violation::relative) violation first.
///
/// ```
/// use carom::explain::violations;
/// use carom::prelude::*;
///
/// let mut model = Model::new("m");
/// let x = model.continuous("x", 0.0, 10.0)?;
/// let hit = model.binary("hit")?;
/// model.add("sum", (x + hit).le(8.0))?;
/// model.add("soft", hit.on().implies(x.le(2.0)))?;
/// let found = violations(&model, &[9.0, 1.0], 1e-6)?;
/// let found: Vec<String> = found.iter().map(|v| v.to_string()).collect();
/// assert_eq!(found, ["the implication `soft` by 7", "the row `sum` by 2"]);
/// # Ok::<(), carom::Error>(())
/// ```
///
/// # Arguments
///
/// * `values`: one value per variable, in the order of creation, such as
///   [`Point::as_slice`].
/// * `feasibility`: the tolerance, as in [`Verification::of`].
///
/// # Errors
///
/// [`ErrorKind::Length`] if the number of values is not the number of variables,
/// [`ErrorKind::NotFinite`] for a value that is NaN or infinite, [`ErrorKind::OutOfRange`] for a
/// tolerance that is negative or not finite.
pub fn violations(
    model: &Model,
    values: &[f64],
    feasibility: f64,
) -> Result<Vec<Violation>, Error> {
    check_length("the point", values.len(), model.variable_count())?;
    for (variable, &value) in model.variables().zip(values) {
        check_finite(variable.name(), "the value", [value])?;
    }
    if !(feasibility.is_finite() && feasibility >= 0.0) {
        let (what, words) = ("the feasibility tolerance", "finite and not negative");
        let range = 0.0..f64::INFINITY;
        return Err(Error::out_of_range_in_words(what, feasibility, range, words));
    }
    let point = Point::new(model, values.to_vec())?;
    let mut found = Verification::of(model, &point, feasibility).violations().to_vec();
    found.sort_by(|a, b| b.relative.total_cmp(&a.relative));
    Ok(found)
}
