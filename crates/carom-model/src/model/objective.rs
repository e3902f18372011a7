//! The objective: setting it, and the check that it is convex in its sense.

use super::checks::finite;
use super::conic::NormSum;
use super::convexity::Convexity;
use super::ids::Variable;
use super::name::Name;
use super::nonlinear::Nonlinear;
use super::quadratic::Quadratic;
use super::sense::Sense;
use super::store::Model;
use crate::error::Error;
#[cfg(doc)]
use crate::error::ErrorKind;

impl Model {
    /// Minimises an affine or quadratic expression that is convex or has a convex form, replacing
    /// any earlier objective. It may have [norms](super::norm) with factors of at least 0, each of
    /// which becomes a variable `objective_norm[k]` that is [at least the norm](Model::norm).
    ///
    /// # Errors
    ///
    /// [`ErrorKind::NotConvex`] if the quadratic part has negative curvature, which is proved,
    /// without a convex form; the error names the direction. Products of and with binaries have
    /// such a form. Some units in the last place of squares are no curvature, because the
    /// coefficients of a sum of squares are rounded. Neither is so little that the objective is
    /// nowhere within the bounds below a tangent by more than
    /// [`CONVEXITY`](crate::tolerance::CONVEXITY). Where squares within bounds lack up to a
    /// thousandth of their coefficients, a solve compares what a convex form loses with the gap. So
    /// a solve, which looks at the bounds of its time and at those that rows imply, may return this
    /// error as well. [`ErrorKind::NotConicRow`] for a norm with a factor of the wrong sign. Also
    /// [`ErrorKind::ForeignHandle`] and [`ErrorKind::NotFinite`].
    pub fn minimize(&mut self, expression: impl Into<NormSum>) -> Result<(), Error> {
        self.set_objective(Sense::Minimize, expression)
    }

    /// Maximises an affine or quadratic expression whose negative is convex or has a convex form,
    /// replacing any earlier objective. Factors of norms are at most 0.
    ///
    /// # Errors
    ///
    /// As for [`Model::minimize`].
    pub fn maximize(&mut self, expression: impl Into<NormSum>) -> Result<(), Error> {
        self.set_objective(Sense::Maximize, expression)
    }

    /// Sets sense and expression of the objective.
    ///
    /// # Errors
    ///
    /// As for [`Model::minimize`].
    pub fn set_objective(
        &mut self,
        sense: Sense,
        expression: impl Into<NormSum>,
    ) -> Result<(), Error> {
        let name = Name::from("objective_norm").free(|name| {
            let family = name.family();
            self.variable_names.has_family(family) || self.statement_names.has_family(family)
        });
        let mut expression = expression.into();
        let nonlinear = expression.take_nonlinear();
        self.all_or_nothing(|model| {
            let expression = expression.with_variables(model, sense, &name)?;
            if nonlinear.is_zero() {
                return model.set_quadratic_objective(sense, expression);
            }
            let place = Name::from("objective");
            let mut sum = nonlinear.define_parts(model, &place)?;
            sum.append(&expression, 1.0);
            let sum = sum.compacted();
            match model.convexity(sense, &sum.products()) {
                Ok(_) => model.set_quadratic_objective(sense, sum),
                Err(_) => {
                    let affine = Nonlinear::from(sum).define(model, &place)?;
                    model.set_quadratic_objective(sense, affine.into())
                }
            }
        })
    }

    fn set_quadratic_objective(
        &mut self,
        sense: Sense,
        expression: Quadratic,
    ) -> Result<(), Error> {
        let expression = expression.compacted();
        let place = Name::from("objective");
        for (variable, coefficient) in expression.affine().terms() {
            self.check_variable(variable, &place)?;
            finite(coefficient, "a coefficient", &place)?;
        }
        finite(expression.affine().offset(), "the constant", &place)?;
        let products = expression.products();
        for &(first, second, coefficient) in &products {
            self.check_variable(first, &place)?;
            self.check_variable(second, &place)?;
            finite(coefficient, "a quadratic coefficient", &place)?;
        }
        let convexity = self.convexity(sense, &products)?;
        self.replace_objective(sense, expression);
        self.is_convex_within_bounds = convexity == Convexity::WithinBounds;
        Ok(())
    }

    /// The part of the objective that all points have in common: its constant, and what variables
    /// with equal bounds add, in the objective's unit.
    #[doc(hidden)]
    pub fn objective_constant(&self) -> f64 {
        let fixed = |variable: Variable| {
            let bounds = self.variable_ref(variable).ok()?.bounds();
            (bounds.lower == bounds.upper).then_some(bounds.lower)
        };
        self.objective().evaluate(|variable| fixed(variable).unwrap_or(0.0))
    }
}
