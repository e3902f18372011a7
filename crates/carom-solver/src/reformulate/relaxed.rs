//! The continuous relaxation of a model.
//!
//! Takes a model; leaves the lowered model with continuous variables only.

use super::lower;
use crate::error::Error;
use crate::model::Model;

/// The continuous relaxation: the model [lowered](lower) to rows as its
/// [`Reformulation`](crate::model::Reformulation) asks for, with all binary and integer variables
/// continuous between their bounds.
///
/// Its optimum is a bound on that of the model. How good it is depends on the reformulation.
/// Handles of variables and rows of the model are valid in it; auxiliary variables and the rows of
/// other statements come after them. Solved by
/// [`BranchAndBound`](crate::branch_and_bound::BranchAndBound), it has [shadow
/// prices](crate::solution::Solution::shadow_price) and [reduced
/// costs](crate::solution::Solution::reduced_cost).
///
/// ```
/// use carom::prelude::*;
/// use carom::reformulate::relaxed;
///
/// let mut model = Model::new("bag");
/// let (rope, tent) = (model.binary("rope")?, model.binary("tent")?);
/// let weight = model.add("weight", (3.0 * rope + 7.0 * tent).le(8.0))?;
/// model.maximize(6.0 * rope + 7.0 * tent)?;
///
/// let continuous = BranchAndBound::default().solve(&relaxed(&model)?)?;
/// // The rope and 5/7 of the tent; a bag for one more kilogram is worth 1.
/// assert!((continuous.objective().unwrap() - 11.0).abs() < 1e-6);
/// assert!((continuous.shadow_price(weight)? - 1.0).abs() < 1e-6);
/// assert!((continuous.reduced_cost(rope)? - 3.0).abs() < 1e-6);
/// # Ok::<(), carom::Error>(())
/// ```
///
/// # Errors
///
/// Those of [`lower`].
#[doc(alias("LP relaxation", "continuous relaxation"))]
pub fn relaxed(model: &Model) -> Result<Model, Error> {
    Ok(lower(model)?.model.with_continuous_variables())
}

/// The model as rows, by which points are verified if it has [relaxed
/// integers](Model::relax_integer); `None` if it has none.
pub(crate) fn with_some_integers(model: &Model) -> Result<Option<Model>, Error> {
    let is_integral = |variable| model.variable_ref(variable).is_ok_and(|v| v.kind().is_integral());
    match model.relaxed_integers().any(is_integral) {
        true => Ok(Some(lower(model)?.model)),
        false => Ok(None),
    }
}
