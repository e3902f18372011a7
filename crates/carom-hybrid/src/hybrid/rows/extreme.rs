//! Extreme points of what a run leaves free.

use super::program::SystemVariables;
use super::run::HybridRun;
use crate::error::{Error, check_length};
use crate::model::{Affine, Model, Quadratic, Sense, Variable};
use crate::solution::Solution;
use crate::solver::Solver;
use crate::tolerance::FEASIBILITY;

/// Inputs this near to the middle of their range, relative to half of it, stay where they are: they
/// are idle.
const IDLE: f64 = 1e-3;

impl SystemVariables {
    /// Fixes the transitions of a run in a model.
    pub(crate) fn fix_transitions(&self, model: &mut Model, run: &HybridRun) -> Result<(), Error> {
        for choice in &self.system.choices {
            let names = run.transitions(&choice.name)?;
            check_length("the steps of the run", names.len(), self.horizon.steps())?;
            for (step, name) in names.iter().enumerate() {
                if let Some(taken) = self.taken(&choice.name, name, step)? {
                    model.fix(taken.variable(), f64::from(u8::from(taken.is_on())))?;
                }
            }
        }
        Ok(())
    }

    /// The inputs with their values in a run.
    pub(crate) fn input_values(&self, run: &HybridRun) -> Result<Vec<(Variable, f64)>, Error> {
        let mut values = Vec::new();
        for (u, ((name, _), family)) in self.system.inputs.iter().zip(&self.inputs).enumerate() {
            let measure = self.coordinates.input(u);
            let own = run.input(name)?;
            check_length("the steps of the run", own.len(), family.len())?;
            values.extend(family.iter().zip(own.iter().map(|value| measure.inward(*value))));
        }
        Ok(values)
    }

    /// A solution near a run of a model: the same transitions, and each input as far as it can go
    /// to the side of its range on which it is in the run.
    pub(crate) fn extreme(
        &self,
        model: &Model,
        run: &HybridRun,
        solver: &mut dyn Solver,
    ) -> Result<Option<Solution>, Error> {
        let mut model = model.clone();
        self.fix_transitions(&mut model, run)?;
        push_outward(model, &self.input_values(run)?, solver)
    }
}

/// Solves a model for inputs as far as they can go from the middles of their ranges, to the sides
/// on which they are.
pub(crate) fn push_outward(
    mut model: Model,
    inputs: &[(Variable, f64)],
    solver: &mut dyn Solver,
) -> Result<Option<Solution>, Error> {
    let objective = model.objective().clone();
    if !objective.products().is_empty() {
        return Ok(None);
    }
    let kept = objective.affine().clone();
    if !kept.terms().is_empty() {
        let least = solver.solve(&model)?;
        let Some(value) = least.objective() else { return Ok(None) };
        let margin = FEASIBILITY * (1.0 + value.abs());
        match model.sense() {
            Sense::Minimize => model.add("objective_kept", kept.le(value + margin))?,
            Sense::Maximize => model.add("objective_kept", kept.ge(value - margin))?,
        };
    }
    let mut outward = Affine::zero();
    for &(variable, value) in inputs {
        let range = model.variable_ref(variable)?.bounds();
        let half = 0.5 * (range.upper - range.lower);
        if !(half > 0.0 && half.is_finite()) {
            continue;
        }
        let share = (value - range.lower) / half - 1.0;
        match share.abs() > IDLE {
            true => outward.add_term(share, variable),
            false => model.fix(variable, value)?,
        }
    }
    model.maximize(Quadratic::from(outward))?;
    let solution = solver.solve(&model)?;
    Ok(solution.point().is_some().then_some(solution))
}
