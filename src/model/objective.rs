//! The objective: setting it, and the check that it is convex in its sense.

use super::checks::finite;
use super::convexity;
use super::ids::Variable;
use super::name::Name;
use super::quadratic::Quadratic;
use super::sense::Sense;
use super::store::Model;
use crate::error::{Error, ErrorKind};
use crate::sum::Sum;

impl Model {
    /// Minimises an affine or convex quadratic expression, replacing any earlier objective.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::NotConvex`] if the quadratic part has negative curvature; the error names a
    /// variable of that direction; [`ErrorKind::ForeignHandle`] and [`ErrorKind::NotFinite`].
    pub fn minimize(&mut self, expression: impl Into<Quadratic>) -> Result<(), Error> {
        self.set_objective(Sense::Minimize, expression)
    }

    /// Maximises an affine or concave quadratic expression, replacing any earlier objective.
    ///
    /// # Errors
    ///
    /// As for [`Model::minimize`].
    pub fn maximize(&mut self, expression: impl Into<Quadratic>) -> Result<(), Error> {
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
        expression: impl Into<Quadratic>,
    ) -> Result<(), Error> {
        let expression = expression.into().compacted();
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
        if let Some(bad) = convexity::find_negative_curvature(&products, sense.sign()) {
            return Err(ErrorKind::NotConvex {
                sense: sense.word(),
                curvature: bad.curvature,
                name: self.variable_ref(bad.variable)?.name().to_string(),
                help: "only convex costs to minimise (concave ones to maximise) have a proof of \
                       optimality here; write squares, or linearise products with a binary",
            }
            .into());
        }
        self.replace_objective(sense, expression);
        Ok(())
    }

    /// The part of the objective that all points have in common: its constant, and what variables with
    /// equal bounds add, in the objective's unit.
    pub(crate) fn objective_constant(&self) -> f64 {
        let fixed = |variable: Variable| {
            let bounds = self.variable_ref(variable).ok()?.bounds();
            (bounds.lower == bounds.upper).then_some(bounds.lower)
        };
        let objective = self.objective();
        let mut sum = Sum::new(objective.affine().offset());
        for (variable, cost) in objective.affine().terms() {
            sum.add_product(cost, fixed(variable).unwrap_or(0.0));
        }
        for (first, second, weight) in objective.products() {
            if let (Some(a), Some(b)) = (fixed(first), fixed(second)) {
                sum.add_product_of_three(a, b, weight);
            }
        }
        sum.value()
    }
}
