//! Shadow prices of rows and reduced costs of variables.

use crate::error::{Error, ErrorKind};
use crate::model::{Constraint, Model, ModelTag, Variable};

/// Shadow prices and reduced costs at the optimum of a model without integers.
///
/// Both are derivatives of the optimal objective, in the model's own sense, whether it minimises or
/// maximises:
///
/// * The [shadow price](Self::shadow_price) of a row is the change of the objective per unit by
///   which the row's limits move up. For `minimize x` over `x >= 3` it is 1, and for `maximize x`
///   over `x <= 3` it is 1 as well. It is 0 if the row does not bind.
/// * The [reduced cost](Self::reduced_cost) of a variable is the change of the objective per unit
///   by which the variable's bounds move up. It is 0 if the variable is between its bounds.
///
/// If the optimum is degenerate, the derivatives to both sides differ, and a multiplier is one of
/// the numbers between them.
///
/// `BranchAndBound` computes them from a relaxation, carries them back through presolve, and checks
/// them before it gives them: their signs are right, and the bound that they prove is within
/// [`tolerance::COMPLEMENTARITY`](crate::tolerance::COMPLEMENTARITY) of the objective.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Multipliers {
    tag: ModelTag,
    shadow_prices: Vec<f64>,
    reduced_costs: Vec<f64>,
}

impl Multipliers {
    /// From one number a constraint and one a variable, in the order of creation; further ones are
    /// left out.
    #[doc(hidden)]
    pub fn new(model: &Model, mut shadow_prices: Vec<f64>, mut reduced_costs: Vec<f64>) -> Self {
        shadow_prices.truncate(model.constraint_count());
        reduced_costs.truncate(model.variable_count());
        Multipliers { tag: model.tag(), shadow_prices, reduced_costs }
    }

    /// The multipliers of a model whose variables and rows come first in the one that was solved.
    #[doc(hidden)]
    pub fn of(&self, model: &Model) -> Self {
        Self::new(model, self.shadow_prices.clone(), self.reduced_costs.clone())
    }

    /// Change of the optimal objective per unit by which the limits of a row move up (objective's
    /// unit per row's unit).
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`] for a row of another model.
    pub fn shadow_price(&self, of: Constraint) -> Result<f64, Error> {
        let price = self.shadow_prices.get(of.index()).filter(|_| of.tag == self.tag);
        price.copied().ok_or_else(|| foreign("constraint", of.index()))
    }

    /// Change of the optimal objective per unit by which the bounds of a variable move up
    /// (objective's unit per variable's unit). For a parameter it is the change per unit of its
    /// value.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`] for a variable of another model.
    pub fn reduced_cost(&self, of: Variable) -> Result<f64, Error> {
        let cost = self.reduced_costs.get(of.index()).filter(|_| of.tag == self.tag);
        cost.copied().ok_or_else(|| foreign("variable", of.index()))
    }
}

fn foreign(kind: &'static str, index: usize) -> Error {
    ErrorKind::ForeignHandle { kind, index, place: "the multipliers".to_owned(), name: None }.into()
}
