//! The shortest plan: the smallest feasible horizon, with a proof, and the fewest impacts on it.

use super::plan::Plan;
use super::program::{Objective, PlanningProgram};
use super::reach::Programs;
use super::scenario::{Collisions, Scenario};
use crate::error::Error;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::hybrid::reach::Tube;
use crate::hybrid::robust::shortest_robust;
use crate::hybrid::shortest_horizon::{HorizonLogs, without_logs};
use crate::hybrid::{Feedback, RobustPlan};
use crate::hybrid::{ShortestHorizon, ShortestOptions, SolvedHorizon, shortest_horizon};
use crate::setters::setters;
use crate::solution::Solution;
use crate::solver::{MipStart, Solver, StopToken};

/// Options of a search for the shortest plan.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct PlanningOptions {
    /// Limits and interrupt of the whole search.
    pub search: ShortestOptions,
    /// A horizon that is probably feasible, in steps, such as the collision-free one for a tolerant
    /// search. A good guess saves solves; a bad one only costs time.
    pub upper_hint: Option<usize>,
    /// Whether to minimise the number of impacts on the shortest horizon (default yes). Otherwise a
    /// plan may have unnecessary impacts.
    pub fewest_impacts: bool,
}

impl Default for PlanningOptions {
    fn default() -> Self {
        let search = ShortestOptions::default();
        PlanningOptions { search, upper_hint: None, fewest_impacts: true }
    }
}

impl PlanningOptions {
    setters! {
        /// Sets limits and interrupt.
        with_search(search: ShortestOptions) => search = search;
        /// Sets a horizon that is probably feasible, in steps.
        with_upper_hint(steps: usize) => upper_hint = Some(steps);
        /// Sets whether the impacts are minimised.
        with_fewest_impacts(wanted: bool) => fewest_impacts = wanted;
    }
}

impl Scenario {
    /// Finds the shortest plan and proves that it is the shortest.
    ///
    /// ```
    /// use carom::collision_tolerant::{PlanningOptions, Scenario};
    /// use carom::prelude::*;
    ///
    /// let scenario = Scenario::paper().with_time_step(0.05);
    /// let (options, mut solver) = (PlanningOptions::default(), BranchAndBound::default());
    /// let careful = scenario.clone().collision_free().shortest_with(&options, &mut solver)?;
    /// let tolerant = scenario.shortest_with(&options, &mut solver)?;
    /// assert!(tolerant.is_found() && tolerant.steps < careful.steps);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As for [`plan`](Scenario::plan); [`ErrorKind::OutOfRange`] for bad options.
    pub fn shortest(&self, solver: &mut dyn Solver) -> Result<ShortestHorizon<Plan>, Error> {
        self.shortest_with(&PlanningOptions::default(), solver)
    }

    /// As [`shortest`](Scenario::shortest), with limits and hints.
    ///
    /// # Errors
    ///
    /// As for [`shortest`](Scenario::shortest).
    pub fn shortest_with(
        &self,
        options: &PlanningOptions,
        solver: &mut dyn Solver,
    ) -> Result<ShortestHorizon<Plan>, Error> {
        self.check()?;
        let programs = Programs { scenario: self.clone(), upper_hint: options.upper_hint };
        without_logs(solver, |solver, folder| {
            let mut found = self.find(&programs, options, solver)?;
            let Some(folder) = folder else { return Ok(found) };
            let mut logs = HorizonLogs::new(folder, &options.search, solver);
            if let Some(plan) = &mut found.plan {
                let fewest = options.fewest_impacts && plan.fewest_impacts;
                let objective = if fewest { Objective::Impacts } else { Objective::Feasibility };
                self.log_plan(objective, options, plan, &mut logs)?;
            }
            found.proofs = logs.refute(&programs, found.refuted_steps.unwrap_or(0))?;
            Ok(found)
        })
    }

    /// The search, without logs.
    fn find(
        &self,
        programs: &Programs,
        options: &PlanningOptions,
        solver: &mut dyn Solver,
    ) -> Result<ShortestHorizon<Plan>, Error> {
        let token = StopToken::new(options.search.time_limit, &options.search.interrupt);
        let found = shortest_horizon(programs, &options.search, solver)?;
        let mut found =
            found.try_map(|SolvedHorizon { program, solution }| program.plan(&solution))?;
        if options.fewest_impacts && found.is_found() {
            let search = &options.search;
            let mut refinement = Refinement { scenario: self, solver, token: &token, search };
            let tube = found.tube.as_ref();
            found.plan = found.plan.map(|plan| refinement.run(plan, tube)).transpose()?;
        }
        found.time = token.elapsed();
        Ok(found)
    }

    /// Solves the program of a plan as the scenario states it, and writes its log. The plan is then
    /// the point in the log.
    fn log_plan(
        &self,
        objective: Objective,
        options: &PlanningOptions,
        plan: &mut Plan,
        logs: &mut HorizonLogs<'_>,
    ) -> Result<(), Error> {
        let steps = plan.trajectory.steps();
        let mut program = self.program(steps, objective)?;
        options.search.complete(program.program_mut())?;
        let contacts = program.contact.iter().flatten().zip(&plan.trajectory.contact);
        let values = contacts.map(|(zeta, &hit)| (zeta, f64::from(u8::from(hit))));
        let start = MipStart::new().with_values(values);
        if let Some(solution) = logs.log(steps, program.model(), &start, Solution::is_optimal)? {
            let (refinements, fewest_impacts) = (plan.refinements.clone(), plan.fewest_impacts);
            *plan = Plan { refinements, fewest_impacts, ..program.plan(&solution)? };
        }
        Ok(())
    }

    /// The smallest number of steps for which a plan brings all disturbed runs to the goal, if the
    /// feedback corrects the accelerations: as
    /// [`HybridSystem::shortest_robust`](crate::hybrid::HybridSystem::shortest_robust). The number
    /// of impacts is not minimised. The goal has to be a [region](Scenario::with_goal_region).
    ///
    /// # Errors
    ///
    /// Those of [`shortest`](Scenario::shortest) and of
    /// [`robust`](crate::hybrid::HybridProgram::robust).
    pub fn shortest_robust(
        &self,
        feedback: &Feedback,
        options: &ShortestOptions,
        solver: &mut dyn Solver,
    ) -> Result<ShortestHorizon<RobustPlan>, Error> {
        self.check()?;
        let programs = Programs { scenario: self.clone(), upper_hint: None };
        shortest_robust(&programs, &self.hybrid_system()?, feedback, options, solver)
    }

    /// Finds the shortest plans without and with collisions. The first is a hint for the second.
    /// Logs of the two, if the solver is asked for them, go to the folders `free` and `tolerant` in
    /// the folder.
    ///
    /// # Errors
    ///
    /// As for [`shortest`](Scenario::shortest).
    pub fn compare(
        &self,
        options: &PlanningOptions,
        solver: &mut dyn Solver,
    ) -> Result<PlanComparison, Error> {
        let folder = solver.options().proof.clone();
        let mut logged = |name: &str, scenario: &Scenario, options: &PlanningOptions| {
            solver.options_mut().proof = folder.as_ref().map(|folder| folder.join(name));
            let found = scenario.shortest_with(options, solver);
            solver.options_mut().proof.clone_from(&folder);
            found
        };
        let free = logged("free", &self.clone().collision_free(), options)?;
        let mut options = options.clone();
        options.upper_hint = free.steps.or(options.upper_hint);
        let tolerant = Scenario { collisions: Collisions::Tolerated, ..self.clone() };
        let tolerant = logged("tolerant", &tolerant, &options)?;
        Ok(PlanComparison { free, tolerant })
    }
}

/// Minimises the impacts of a plan on its proved horizon.
struct Refinement<'a> {
    scenario: &'a Scenario,
    solver: &'a mut dyn Solver,
    token: &'a StopToken,
    search: &'a ShortestOptions,
}

impl Refinement<'_> {
    fn run(&mut self, mut plan: Plan, tube: Option<&Tube>) -> Result<Plan, Error> {
        let (impacts, steps) = (plan.trajectory.impacts.len(), plan.trajectory.steps());
        let proved = tube.and_then(Tube::fewest_events).unwrap_or(0);
        let priced = self.scenario.damage.has_price();
        if plan.fewest_impacts || impacts == 0 || (impacts <= proved && !priced) {
            plan.fewest_impacts = true;
            return Ok(plan);
        }
        // Without any impact?
        let mut needed = proved > 0;
        // Rows of one's own may speak of contacts, which the careful scenario does not have.
        if !needed && !self.search.has_statements() {
            let careful = self.scenario.clone().collision_free();
            let program = careful.program(steps, Objective::Feasibility)?;
            let Some(solution) = self.solve(&program)? else { return Ok(plan) };
            plan.refinements.push(*solution.statistics());
            if solution.point().is_some() {
                let refinements = plan.refinements;
                return Ok(Plan { refinements, ..program.plan(&solution)? });
            }
            needed = solution.is_infeasible();
        }
        if needed && impacts == 1 && !priced {
            plan.fewest_impacts = true;
            return Ok(plan);
        }
        // As few as possible.
        let mut program = self.scenario.program(steps, Objective::Impacts)?;
        self.search.complete(program.program_mut())?;
        if needed {
            program.require_contact()?;
        }
        if let Some(tube) = tube {
            let _report = program.program_mut().tighten(tube)?;
        }
        let Some(solution) = self.solve(&program)? else { return Ok(plan) };
        plan.refinements.push(*solution.statistics());
        if solution.point().is_none() {
            return Ok(plan);
        }
        let (refinements, fewest_impacts) = (plan.refinements, solution.is_optimal());
        Ok(Plan { refinements, fewest_impacts, ..program.plan(&solution)? })
    }

    /// Solves within the remaining time of the search; `None` if there is none.
    fn solve(&mut self, program: &PlanningProgram) -> Result<Option<Solution>, Error> {
        if self.token.is_over() {
            return Ok(None);
        }
        self.token.solve(self.solver, program.model(), &mut |_| {}).map(Some)
    }
}

/// The shortest plans of a task without and with collisions.
#[derive(Debug, Clone)]
#[non_exhaustive]
#[must_use]
pub struct PlanComparison {
    /// Collisions forbidden.
    pub free: ShortestHorizon<Plan>,
    /// Collisions tolerated.
    pub tolerant: ShortestHorizon<Plan>,
}

impl PlanComparison {
    /// Whether hitting the wall pays off, that is, whether the tolerant plan is proved to be
    /// shorter. `None` if a search was stopped before that was known.
    pub fn hitting_pays(&self) -> Option<bool> {
        match (self.free.refuted_steps, self.tolerant.steps) {
            // Every horizon up to `refuted` needs an impact.
            (Some(refuted), Some(tolerant)) if tolerant <= refuted => Some(true),
            _ if self.tolerant.is_found() && self.free.is_found() => Some(false),
            _ => None,
        }
    }
}
