//! The semantic certificate of a point: integers rounded, the rest solved again, every statement
//! checked by its meaning.
//!
//! The crate's own search accepts points in no other way. Use this for points from elsewhere, such
//! as a plan from a file or the point of a backend that treats 0.999999 as 1.

use super::Solver;
use crate::error::{Error, ErrorKind};
use crate::model::Model;
use crate::solution::{Point, Solution, Verification};
use crate::tolerance;

/// The certificate of a point: the point with rounded integers, the rest solved again; made by
/// [`certify`].
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[must_use]
pub struct Certificate {
    solution: Solution,
    as_given: Verification,
    rounding: f64,
    moved: Option<f64>,
}

impl Certificate {
    /// Whether a point with these integers exists and satisfies the model.
    pub fn holds(&self) -> bool {
        self.solution.point().is_some() && self.solution.verification().is_some_and(|v| v.holds())
    }

    /// The best point with the rounded integers, if there is one, its objective and its
    /// verification. Its termination and bound are those of the model with these integers fixed.
    pub fn solution(&self) -> &Solution {
        &self.solution
    }

    /// The check of the given point, before rounding.
    pub fn as_given(&self) -> &Verification {
        &self.as_given
    }

    /// The largest distance by which an integer variable was rounded (no unit).
    pub fn rounding(&self) -> f64 {
        self.rounding
    }

    /// The largest distance between the given value of a continuous variable and its certified one,
    /// in the variable's unit; `None` if there is no certified point. A large value with a small
    /// [`rounding`](Self::rounding) shows that switched rows leak.
    pub fn moved(&self) -> Option<f64> {
        self.moved
    }
}

/// Certifies a point: rounds its integers into their bounds, fixes them, solves the continuous rest
/// with `solver`, and checks every implication, disjunction, logic statement and function of the
/// result by its meaning.
///
/// ```
/// use carom::prelude::*;
/// use carom::solver::certify;
///
/// // A backend that treats 1e-6 as 0 has let x pass through the wall at 0.
/// let mut model = Model::new("wall");
/// let x = model.continuous("x", -1e6, 10.0)?;
/// let open = model.binary("open")?;
/// model.add("wall", open.off().implies(x.ge(0.0)))?;
/// model.minimize(x + 1e9 * open)?;
/// let certificate = certify(&model, &[-1.0, 1e-6], &mut BranchAndBound::default())?;
/// assert!(!certificate.as_given().holds());
/// assert!(certificate.holds());
/// assert!(certificate.solution().value(x)?.abs() < 1e-6);
/// assert!((certificate.moved().unwrap_or(0.0) - 1.0).abs() < 1e-6);
/// # Ok::<(), carom::Error>(())
/// ```
///
/// # Arguments
///
/// * `values`: one value per variable, in the order of creation.
///
/// # Errors
///
/// [`ErrorKind::Length`] for a wrong number of values, [`ErrorKind::NotFinite`] naming the variable
/// without a finite value; the errors of the solver.
pub fn certify<S: Solver + ?Sized>(
    model: &Model,
    values: &[f64],
    solver: &mut S,
) -> Result<Certificate, Error> {
    let given = Point::new(model, values.to_vec())?;
    let (mut fixed, mut rounding) = (model.clone(), 0.0_f64);
    for (variable, &value) in model.variables().zip(values) {
        if value.is_nan() || value.abs() >= tolerance::INFINITE {
            let name = variable.name().to_string();
            return Err(ErrorKind::NotFinite { name, what: "the value", value }.into());
        }
        if variable.kind().is_integral() {
            let bounds = variable.bounds();
            let whole = value.round().max(bounds.lower.ceil()).min(bounds.upper.floor());
            rounding = rounding.max((whole - value).abs());
            if bounds.contains(whole) {
                fixed.fix(variable.id(), whole)?;
            }
        }
    }
    let solution = solver.solve(&fixed)?;
    let feasibility = solver.options().feasibility;
    let moved = solution.point().map(|point| {
        let pairs = model.variables().zip(values).zip(point.as_slice());
        let continuous = pairs.filter(|((variable, _), _)| !variable.kind().is_integral());
        continuous.map(|((_, a), b)| (a - b).abs()).fold(0.0, f64::max)
    });
    let as_given = Verification::of(model, &given, feasibility);
    Ok(Certificate { solution, as_given, rounding, moved })
}
