//! Models whose objective falls, with a floor far below.

use super::rows::row_name;
use crate::error::Error;
use crate::model::{Model, StoredRow};

/// How far below a point the floors are, relative to the magnitude of its objective.
pub(super) const FAR: [f64; 2] = [1e3, 1e6];

/// A model in which the objective is at most so much better than a value, relative to it; `None` where
/// the objective is not linear.
pub(super) fn with_floor(model: &Model, value: f64, distance: f64) -> Result<Option<Model>, Error> {
    let objective = model.objective();
    if !objective.products().is_empty() {
        return Ok(None);
    }
    let sign = model.sense().sign();
    let floor = sign * value - distance * value.abs().max(1.0) - sign * objective.affine().offset();
    let terms = objective.affine().terms().into_iter();
    let terms = terms.map(|(variable, a)| (variable, sign * a)).collect();
    let mut floored = model.clone();
    let name = row_name("floor", 0).free(|name| floored.has_statement(name));
    floored.push_constraint(name, StoredRow { terms, lower: floor, upper: f64::INFINITY })?;
    floored.touch();
    Ok(Some(floored))
}
