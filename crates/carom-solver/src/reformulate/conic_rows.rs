//! Rows that norms and quadratic rows imply.
//!
//! Takes a norm or a quadratic row; leaves rows that hold wherever it does.

use crate::error::Error;
use crate::model::{Affine, Model, Name, StandardCone, StoredConic, StoredRow};
use crate::tolerance;

/// The rounding of a root (no unit).
const ROOT_ROUNDING: f64 = 2.0 * f64::EPSILON;

/// Rows that a conic row implies: no entry is longer than the bounds allow all to be.
pub(super) fn implied_rows(
    conic: &StoredConic,
    name: &Name,
    model: &Model,
) -> Result<Vec<StoredRow>, Error> {
    let StandardCone { head, tail } = model.standard_cone(conic, name)?;
    let mut rows = Vec::new();
    let mut at_least_zero = |e: Affine| {
        let (terms, constant) = e.into_parts();
        if !terms.is_empty() {
            rows.push(StoredRow { terms, lower: -constant, upper: f64::INFINITY });
        }
    };
    let limit = match &head[..] {
        [first, second] => {
            let most = model.range_of(first).upper.max(0.0) * model.range_of(second).upper.max(0.0);
            // A bound of 0 times no bound says nothing.
            let most = if most.is_nan() { f64::INFINITY } else { most };
            Affine::constant(most.sqrt() * (1.0 + ROOT_ROUNDING))
        }
        _ => head.iter().sum(),
    };
    head.into_iter().for_each(&mut at_least_zero);
    if !limit.terms().is_empty() || limit.offset() < tolerance::INFINITE {
        for e in tail {
            at_least_zero(&limit - &e);
            at_least_zero(&limit + e);
        }
    }
    Ok(rows)
}
