//! The objective: sense, expression and the check that it is convex in that sense.

use super::Model;
use super::convexity;
use super::name::Name;
use super::quadratic::Quadratic;
use super::statement::finite;
use crate::error::{Error, ErrorKind};

/// Direction of optimisation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Sense {
    /// Smaller is better.
    Minimize,
    /// Larger is better.
    Maximize,
}

impl Sense {
    /// `+1` for minimising, `-1` for maximising: multiplying by it turns either into minimising.
    pub fn sign(self) -> f64 {
        match self {
            Sense::Minimize => 1.0,
            Sense::Maximize => -1.0,
        }
    }

    pub(crate) fn word(self) -> &'static str {
        match self {
            Sense::Minimize => "minimize",
            Sense::Maximize => "maximize",
        }
    }
}

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
}
