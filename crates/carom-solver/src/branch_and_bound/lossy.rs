//! Solves of programs whose convex objective may be below that of the model.
//!
//! A bound for the program is one for the model. A point costs as much as the model says, so the
//! loss of the convex objective there is a part of the gap. The search gets half of the gap that
//! was asked for.

use super::lower::LoweredProgram;
use super::solve::{EarlierResults, Solve, SolveResult};
use crate::error::Error;
use crate::model::Model;
use crate::solution::{Point, Termination};
use crate::solver::Control;
use crate::sum::Sum;

/// The help of the error that a loss is too large.
const TOO_LOSSY: &str = "within the bounds, a convex form of it loses more than the gap that is asked for; \
                         write squares, give closer bounds or allow a larger gap";

impl Solve<'_> {
    /// Solves a lowered program with a loss.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::NotConvex`](crate::error::ErrorKind::NotConvex) if the loss is more than the
    /// gap.
    pub(super) fn run_with_loss(
        &self,
        lowered: &LoweredProgram,
        known: &EarlierResults<'_>,
        control: &mut Control<'_>,
    ) -> Result<SolveResult, Error> {
        let (model, loss) = (self.model, lowered.loss);
        let sign = model.sense().sign();
        let constant = sign * model.objective_constant();
        // The gap is the larger, the further the objective is from its constant.
        let far = largest_objective(model);
        let most =
            self.options.allowed_gap(far, constant).max(self.options.allowed_gap(-far, constant));
        if loss > most {
            return Err(too_lossy(model));
        }
        let mut options = self.options.clone();
        options.absolute_gap *= 0.5;
        options.relative_gap *= 0.5;
        let mut solved =
            Solve { options: &options, ..*self }.run_lowered(lowered, known, control)?;
        let found = &mut solved.found;
        let value = |values: &Vec<f64>| -> Result<f64, Error> {
            Ok(sign * Point::new(model, values.clone())?.value(model.objective())?)
        };
        let values = found.points.iter().map(value).collect::<Result<Vec<f64>, Error>>()?;
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
        let Some(&best) = order.first() else { return Ok(solved) };
        found.points = order.iter().map(|&k| found.points[k].clone()).collect();
        if best != 0 {
            (solved.point, solved.lowered_point) = (None, None);
        }
        // Points that are missing may be better than those of a pool, as the model has it.
        found.pool_complete &= values.len() == 1;
        let allowed = self.options.allowed_gap(values[best], constant);
        if found.termination == Termination::Optimal && values[best] - found.bound > allowed {
            return Err(too_lossy(model));
        }
        Ok(solved)
    }
}

/// The error that the loss is too large.
fn too_lossy(model: &Model) -> Error {
    let direction = model.concave_direction(|_| f64::INFINITY).unwrap_or_default();
    model.not_convex(model.sense(), direction, TOO_LOSSY)
}

/// At least the largest magnitude of the objective within the bounds of the variables.
fn largest_objective(model: &Model) -> f64 {
    let size = |variable| model.variable_ref(variable).map_or(0.0, |v| v.bounds().magnitude());
    let objective = model.objective();
    let mut sum = Sum::new(objective.affine().offset().abs());
    for (variable, a) in objective.affine().terms() {
        // Infinity times 0 would be no number.
        sum.add(if a == 0.0 { 0.0 } else { a.abs() * size(variable) });
    }
    for (first, second, q) in objective.products() {
        sum.add(q.abs() * size(first) * size(second));
    }
    if sum.value().is_nan() { f64::INFINITY } else { sum.value() }
}
