//! Extreme points of what a run leaves free.

use super::program::HybridProgram;
use super::run::HybridRun;
use crate::error::{Error, check_length};
use crate::model::{Affine, Model, Quadratic, Sense, Variable};
use crate::solution::Solution;
use crate::solver::Solver;
use crate::tolerance::FEASIBILITY;

/// Inputs this near to the middle of their range, relative to half of it, stay where they are: they
/// are idle.
const IDLE: f64 = 1e-3;

impl HybridProgram {
    /// An extreme point near a run: the same transitions, and each input as far as it can go to the
    /// side of its range on which it is in the run. All but a few inputs are then at an end of their
    /// range, or idle as before.
    ///
    /// If many runs are as good, an interior-point method finds one in the middle of all of them,
    /// whose inputs change smoothly where a time-optimal controller switches. An extreme point
    /// switches.
    ///
    /// ```
    /// use carom::hybrid::{Horizon, HybridSystem, LinearSystem, Region, Transition, When};
    /// use carom::interval::Interval;
    /// use carom::prelude::*;
    ///
    /// let cart = HybridSystem::new()
    ///     .with_state("x", Interval::new(-9.0, 9.0))
    ///     .with_state("v", Interval::new(-9.0, 9.0))
    ///     .with_input("a", Interval::new(-1.0, 1.0))
    ///     .with_transition(Transition::new("roll", LinearSystem::double_integrator(0.1)?));
    /// let mut model = Model::new("cart");
    /// let program = cart.write(&mut model, "", &Horizon::new(21, 0.1)?)?;
    /// program.require(&mut model, "start", &Region::point([0.0, 0.0]), When::At(0))?;
    /// program.require(&mut model, "goal", &Region::point([1.0, 0.0]), When::At(21))?;
    /// let mut solver = BranchAndBound::default();
    /// let (run, _) = program.certified(&solver.solve(&model)?)?;
    /// let solution = program.extreme(&model, &run, &mut solver)?.expect("there is one");
    /// let (run, _) = program.certified(&solution)?;
    /// // Two equations of the goal leave two inputs between the ends of their range.
    /// let between = run.input("a")?.iter().filter(|a| a.abs() < 1.0 - 1e-6).count();
    /// assert!(between <= 2);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Arguments
    ///
    /// * `model`: the model of the program; it stays as it is. An affine objective keeps the least
    ///   value that it has with these transitions.
    /// * `run`: a run of the program.
    ///
    /// # Returns
    ///
    /// A solution of the model; `None` for a quadratic objective, which leaves nothing free, and if
    /// the solver finds none.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Length`](crate::ErrorKind::Length) and
    /// [`ErrorKind::UnknownName`](crate::ErrorKind::UnknownName) for a run of another program;
    /// those of the solver.
    pub fn extreme(
        &self,
        model: &Model,
        run: &HybridRun,
        solver: &mut dyn Solver,
    ) -> Result<Option<Solution>, Error> {
        let mut model = model.clone();
        for choice in &self.system.choices {
            let names = run.transitions(&choice.name)?;
            check_length("the steps of the run", names.len(), self.horizon.steps())?;
            for (step, name) in names.iter().enumerate() {
                if let Some(taken) = self.taken(&choice.name, name, step)? {
                    model.fix(taken.variable(), f64::from(u8::from(taken.is_on())))?;
                }
            }
        }
        let mut values = Vec::new();
        for ((name, _), family) in self.system.inputs.iter().zip(&self.inputs) {
            let own = run.input(name)?;
            check_length("the steps of the run", own.len(), family.len())?;
            values.extend(family.iter().zip(own.iter().copied()));
        }
        push_outward(model, &values, solver)
    }
}

/// Solves a model for inputs as far as they can go from the middles of their ranges, to the sides on
/// which they are.
fn push_outward(
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
