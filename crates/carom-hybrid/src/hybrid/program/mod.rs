//! The program of a hybrid system over a horizon, and its plans.
//!
//! | part | file |
//! | --- | --- |
//! | the program, which owns its model | `program/mod.rs` |
//! | expressions of a system, taken at a sample | `program/sample.rs` |
//! | starts, goals, way-points, time windows | `program/require.rs` |
//! | the memory of the start | `program/memory.rs` |
//! | the start as a parameter | `program/open_start.rs` |
//! | sums over the steps, magnitudes, soft limits | `program/costs.rs` |
//! | the first steps alone with whole integers | `program/integer_horizon.rs` |
//! | certified plans | `program/plan.rs` |
//! | plans that are the runs of their inputs | `program/settle.rs` |
//! | scenes and others that own such a program | `program/owner.rs` |

mod costs;
mod integer_horizon;
mod memory;
mod open_start;
mod owner;
mod plan;
mod require;
mod sample;
mod settle;

use std::sync::Arc;

pub use costs::SoftLimit;
pub(crate) use owner::owns_program;
pub use plan::HybridPlan;
pub use require::When;
pub use sample::AtSample;
pub(crate) use sample::ProgramSystems;
pub(crate) use settle::as_drift;

use super::reach::{HorizonVariables, TighteningReport, Tube};
use super::rows::SystemVariables;
use super::system::HybridSystem;
use crate::error::Error;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::interval::Interval;
use crate::model::{Method, Model, Name, NormSum, Statement, Variable};
use crate::solution::Solution;
use crate::solver::{Control, Solver};

/// The program of a [`HybridSystem`] over a horizon of some steps: a model, and the system's
/// states, inputs, modes, transitions and outputs in it.
///
/// Everything is stated with the handles of the system. An expression of them is taken at a sample
/// by [`at`](HybridProgram::at); sample 0 is the start and sample τ the end, and step t leads from
/// sample t to sample t + 1.
///
/// ```
/// use carom::prelude::*;
///
/// let mut cart = HybridSystem::new(0.5); // s
/// let x = cart.state("x", -9.0, 9.0)?; // m
/// let v = cart.state("v", -2.0, 2.0)?; // m/s
/// let a = cart.input("a", -1.0, 1.0)?; // m/s²
/// cart.mode("roll")?.rates([x.is(v), v.is(a)])?;
///
/// let mut program = cart.program(12)?;
/// program.start([x.equals(0.0), v.equals(0.0)])?;
/// program.require("way-point", [x.ge(4.0)], When::OnceIn(6..=8))?;
/// program.goal([x.equals(3.0), v.equals(0.0)])?;
/// let effort = program.sum(a.square())?;
/// program.minimize(effort)?;
/// let plan = program.solve(&mut BranchAndBound::default())?;
/// assert!(plan.values(x)?.iter().any(|x| *x >= 4.0 - 1e-6));
/// # Ok::<(), carom::Error>(())
/// ```
///
/// Several systems can be in one program, see [`join`](HybridProgram::join).
#[derive(Debug, Clone)]
pub struct HybridProgram {
    pub(crate) model: Model,
    pub(crate) systems: Arc<ProgramSystems>,
}

impl HybridSystem {
    /// The program of the system over a horizon.
    ///
    /// A part that all transitions of a choice share is stated once. Only what they change about
    /// the next state is switched, by variables whose bounds come from guards and domains.
    /// Statements that describe the system are [background](Model::set_background); limits and
    /// ranges of inputs are not.
    ///
    /// # Errors
    ///
    /// Those of [`HybridSystem::check`]; [`ErrorKind::OutOfRange`] for a number of steps that is
    /// not from 1 to [`MAX_STEPS`](crate::tolerance::MAX_STEPS); [`ErrorKind::CrossedBounds`] if an
    /// input has no value that any transition allows.
    pub fn program(&self, steps: usize) -> Result<HybridProgram, Error> {
        let mut model = Model::new("program");
        let variables = self.write(&mut model, "", steps)?;
        Ok(HybridProgram::from_parts(model, variables))
    }

    /// As [`program`](Self::program), with all rows that belong to transitions stated as
    /// disjunctions and implications, which are lowered by one method.
    ///
    /// By default, rows have an M for each other transition, computed over what that one allows,
    /// and transitions share rows in the same direction. This is for comparisons with that: see the
    /// guide to weak statements.
    ///
    /// # Errors
    ///
    /// Those of [`program`](Self::program).
    pub fn program_with(&self, steps: usize, method: Method) -> Result<HybridProgram, Error> {
        let mut model = Model::new("program");
        let variables = self.write_by(&mut model, "", steps, Some(method))?;
        Ok(HybridProgram::from_parts(model, variables))
    }
}

impl HybridProgram {
    /// The program of a model with one system in it.
    pub(crate) fn from_parts(model: Model, variables: SystemVariables) -> Self {
        let systems = Arc::new(ProgramSystems::new(model.tag(), variables));
        HybridProgram { model, systems }
    }

    /// Adds another system with the same length of steps. Its names in the model begin with `name`,
    /// and its handles can stand in the same expressions.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let cart = || {
    ///     let mut cart = HybridSystem::new(1.0); // s
    ///     let x = cart.state("x", 0.0, 9.0)?;
    ///     let u = cart.input("u", -1.0, 1.0)?;
    ///     cart.mode("roll")?.next([x.is(x + u)])?;
    ///     Ok::<_, Error>((cart, x))
    /// };
    /// let ((first, x), (second, y)) = (cart()?, cart()?);
    /// let mut program = first.program(5)?;
    /// program.join("second", &second)?;
    /// program.start([x.equals(0.0), y.equals(4.0)])?;
    /// program.require("apart", [(y - x).ge(2.0)], When::Throughout(0..=5))?;
    /// program.maximize(program.end(x)?)?;
    /// let plan = program.solve(&mut BranchAndBound::default())?;
    /// assert!((plan.value(x, 5)? - 5.0).abs() < 1e-6);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`] for another length of steps; [`ErrorKind::DuplicateName`] for a
    /// name that is taken, and for a system that is in the program already (build a second one);
    /// those of [`HybridSystem::program`].
    pub fn join(&mut self, name: &str, system: &HybridSystem) -> Result<(), Error> {
        self.systems.check_new(name, system)?;
        let steps = self.steps();
        let variables = system.write_by(&mut self.model, name, steps, None)?;
        Arc::make_mut(&mut self.systems).push(name, variables);
        Ok(())
    }

    pub(crate) fn systems_mut(&mut self) -> &mut ProgramSystems {
        Arc::make_mut(&mut self.systems)
    }

    /// The model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The variables of the first system, by number and step.
    #[doc(hidden)]
    pub fn variables(&self) -> &SystemVariables {
        self.systems.first()
    }

    /// The model, for statements of your own.
    pub fn model_mut(&mut self) -> &mut Model {
        &mut self.model
    }

    /// The number of steps, τ.
    pub fn steps(&self) -> usize {
        self.systems.steps
    }

    /// The system, the first one if there are several; its handles [by
    /// name](HybridSystem::state_named) stand in expressions of the program, also for the program
    /// of a scene.
    pub fn system(&self) -> &HybridSystem {
        self.systems.first().system()
    }

    /// An expression, a row or a condition of the systems' handles, taken at a sample: states and
    /// modes at it, inputs, transitions and outputs in the step that starts there. Variables of the
    /// model stay as they are.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`]; [`ErrorKind::OutOfRange`] for a sample beyond the horizon;
    /// [`ErrorKind::Misplaced`] for predictions.
    pub fn at<E: AtSample>(&self, expression: E, sample: usize) -> Result<E::Output, Error> {
        expression.at_sample(&self.systems, sample)
    }

    /// An expression at the last sample.
    ///
    /// # Errors
    ///
    /// Those of [`at`](HybridProgram::at).
    pub fn end<E: AtSample>(&self, expression: E) -> Result<E::Output, Error> {
        self.at(expression, self.steps())
    }

    /// The variable of the model for a state at a sample or an input in a step. Where the domain is
    /// not of an ordinary size (some 0.02 to 2e6), or far from 0, the variable is in a unit of its
    /// own and counts from the middle of the domain; [`at`](HybridProgram::at) is the value in your
    /// unit.
    ///
    /// # Errors
    ///
    /// Those of [`at`](HybridProgram::at); [`ErrorKind::Misplaced`] for another handle.
    pub fn variable(&self, of: impl Into<Variable>, sample: usize) -> Result<Variable, Error> {
        self.systems.variable(of.into(), sample)
    }

    /// Adds a statement to the model, as [`Model::add`] does.
    ///
    /// # Errors
    ///
    /// Those of [`Model::add`].
    pub fn add<S: Statement>(
        &mut self,
        name: impl Into<Name>,
        statement: S,
    ) -> Result<S::Handle, Error> {
        self.model.add(name, statement)
    }

    /// Sets the cost, as [`Model::minimize`] does.
    ///
    /// # Errors
    ///
    /// Those of [`Model::minimize`].
    pub fn minimize(&mut self, cost: impl Into<NormSum>) -> Result<(), Error> {
        self.model.minimize(cost)
    }

    /// Sets the objective, as [`Model::maximize`] does.
    ///
    /// # Errors
    ///
    /// Those of [`Model::maximize`].
    pub fn maximize(&mut self, gain: impl Into<NormSum>) -> Result<(), Error> {
        self.model.maximize(gain)
    }

    /// Solves the program. The plan is [certified](HybridSystem::certify): replayed against the
    /// systems as they are stated, by code that shares nothing with the rows.
    ///
    /// A plan is a run from its start. Rows hold within a tolerance, which an unstable system
    /// multiplies at every step; where the solver's plan leaves the run of its inputs, they are
    /// corrected with the same transitions. The solution of the plan is then that of the corrected
    /// run, with its own objective, and is called optimal only if that is within the gap. A plan
    /// that cannot be corrected is refused.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::NoPlan`] if the solver ends without a plan, because there is none or because it
    /// was stopped: `explain` says why the [model](HybridProgram::model) has none. Errors of the
    /// solver; those of [`HybridSystem::certify`] for a plan that is not what a system states, or
    /// that leaves the run of its inputs and cannot be corrected.
    pub fn solve(&self, solver: &mut dyn Solver) -> Result<HybridPlan, Error> {
        self.solve_with(&mut Control::default(), solver)
    }

    /// Solves the program with events, warm starts and limits, as [`solve`](HybridProgram::solve).
    ///
    /// # Errors
    ///
    /// Those of [`solve`](HybridProgram::solve).
    pub fn solve_with(
        &self,
        control: &mut Control<'_>,
        solver: &mut dyn Solver,
    ) -> Result<HybridPlan, Error> {
        self.check_is_whole()?;
        let solution = solver.solve_with(&self.model, control)?;
        self.plan_by(&solution, solver)
    }

    /// As [`plan`](HybridProgram::plan), with a solver for what a corrected plan may need.
    pub(crate) fn plan_by(
        &self,
        solution: &Solution,
        solver: &mut dyn Solver,
    ) -> Result<HybridPlan, Error> {
        self.check_is_whole()?;
        HybridPlan::of(&self.systems, &*self.settled(solution, Some(solver))?)
    }

    /// The certified plan of a solution of the [model](HybridProgram::model), for those who solve
    /// it themselves.
    ///
    /// # Errors
    ///
    /// Those of [`solve`](HybridProgram::solve) that do not come from the solver;
    /// [`ErrorKind::ForeignHandle`] for a solution of another model.
    pub fn plan(&self, solution: &Solution) -> Result<HybridPlan, Error> {
        self.check_is_whole()?;
        HybridPlan::of(&self.systems, &*self.settled(solution, None)?)
    }

    /// Fixes transitions and modes that no plan of a tube takes and narrows bounds. The tube is
    /// that of the program's system, start, goal and number of steps; no plan is lost.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Length`], [`ErrorKind::OutOfRange`] and [`ErrorKind::UnknownName`] for the tube
    /// of another system or another number of steps.
    pub fn tighten(&mut self, tube: &Tube) -> Result<TighteningReport, Error> {
        let variables = self.systems.first().horizon_variables();
        self.tighten_by(tube, &variables)
    }

    /// As [`tighten`](HybridProgram::tighten), with variables of a scene. Remembers which bounds
    /// come from the tube, because they are about plans without disturbance.
    pub(crate) fn tighten_by(
        &mut self,
        tube: &Tube,
        variables: &HorizonVariables,
    ) -> Result<TighteningReport, Error> {
        let own = self.systems.first();
        let own: Vec<Variable> = own.states().iter().chain(own.inputs()).flatten().collect();
        let bounds = |model: &Model| -> Result<Vec<Interval>, Error> {
            own.iter().map(|variable| Ok(model.variable_ref(*variable)?.bounds())).collect()
        };
        let before = bounds(&self.model)?;
        let report = tube.tighten(&mut self.model, variables)?;
        let after = bounds(&self.model)?;
        let implied = &mut Arc::make_mut(&mut self.systems).implied;
        for (variable, (before, after)) in own.iter().zip(before.into_iter().zip(after)) {
            if before != after {
                let known = implied.get(variable).filter(|known| known.1 == before);
                let stated = known.map_or(before, |known| known.0);
                implied.insert(*variable, (stated, after));
            }
        }
        Ok(report)
    }

    /// The bounds of a state or an input without what sets have proved about them.
    pub(crate) fn stated_bounds(&self, variable: Variable) -> Result<Interval, Error> {
        let own = self.model.variable_ref(variable)?.bounds();
        let implied = self.systems.implied.get(&variable).filter(|known| known.1 == own);
        Ok(implied.map_or(own, |known| known.0))
    }

    /// An extreme plan near a plan: the same transitions, and each input as far as it can go to the
    /// side of its range on which it is. All but a few inputs are then at an end of their range, or
    /// idle as before. An affine objective keeps the least value that it has with these
    /// transitions.
    ///
    /// If many plans are as good, an interior-point method finds one in the middle of all of them,
    /// whose inputs change smoothly where a time-optimal controller switches. An extreme plan
    /// switches.
    ///
    /// # Returns
    ///
    /// `None` for a quadratic objective, which leaves nothing free, and if the solver finds none.
    ///
    /// # Errors
    ///
    /// Those of the solver and of [`plan`](HybridProgram::plan).
    pub fn extreme(
        &self,
        plan: &HybridPlan,
        solver: &mut dyn Solver,
    ) -> Result<Option<HybridPlan>, Error> {
        let solution = self.systems.extreme(&self.model, plan, solver)?;
        solution.map(|solution| self.plan_by(&solution, solver)).transpose()
    }
}

impl AsRef<Model> for HybridProgram {
    fn as_ref(&self) -> &Model {
        &self.model
    }
}

impl AsMut<Model> for HybridProgram {
    fn as_mut(&mut self) -> &mut Model {
        &mut self.model
    }
}
