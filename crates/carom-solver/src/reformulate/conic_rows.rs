//! Rows that norms and quadratic rows imply.
//!
//! Takes a norm or a quadratic row; leaves rows that hold wherever it does.

use crate::error::Error;
use crate::model::{Affine, Model, Name, StandardCone, StoredConic, StoredRow, Variable};
use crate::tolerance;

/// The rounding of a root (no unit).
const ROOT_ROUNDING: f64 = 2.0 * f64::EPSILON;

/// The rounding of a square that was completed, relative to its terms (no unit).
const SQUARE_ROUNDING: f64 = 32.0 * f64::EPSILON;

/// Rows that a conic row implies: no entry is longer than the bounds allow all to be.
///
/// Completed squares are rounded, and the rows leave room for this, because a cone whose inside is
/// empty has no points to lose.
pub(super) fn implied_rows(
    conic: &StoredConic,
    name: &Name,
    model: &Model,
) -> Result<Vec<StoredRow>, Error> {
    let StandardCone { head, tail } = model.standard_cone(conic, name)?;
    let rounding = match conic {
        StoredConic::Norm { .. } => 0.0,
        StoredConic::Quadratic { .. } => SQUARE_ROUNDING,
    };
    let mut rows = Vec::new();
    let mut at_least_zero = |e: Affine, size: f64| {
        let (terms, constant) = e.into_parts();
        if !terms.is_empty() {
            let lower = -constant - rounding * size;
            rows.push(StoredRow { terms, lower, upper: f64::INFINITY });
        }
    };
    // Of what the bounds leave finite.
    let size = |e: &Affine| {
        let terms = e.terms().into_iter();
        let term = |(v, a): (Variable, f64)| (model.range_of(&v.into()) * a).magnitude();
        e.offset().abs() + terms.map(term).filter(|size| size.is_finite()).sum::<f64>()
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
    head.into_iter().for_each(|e| {
        let size = size(&e);
        at_least_zero(e, size);
    });
    if !limit.terms().is_empty() || limit.offset() < tolerance::INFINITE {
        for e in tail {
            let size = size(&limit) + size(&e);
            at_least_zero(&limit - &e, size);
            at_least_zero(&limit + e, size);
        }
    }
    Ok(rows)
}
