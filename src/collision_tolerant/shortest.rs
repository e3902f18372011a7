//! The shortest plan: the smallest feasible horizon, with a proof, and the fewest impacts on it.

use std::time::Duration;

use super::law::ContactLaw;
use super::plan::Plan;
use super::program::{Objective, PlanningProgram};
use super::scenario::Scenario;
use crate::error::Error;
use crate::error::ErrorKind;
use crate::hybrid::reach::Tube;
use crate::hybrid::{
    HorizonProof, ShortestHorizon, ShortestOptions, ShortestStatus, SolvedHorizon, shortest_horizon,
};
use crate::model::Affine;
use crate::solution::Solution;
use crate::solver::{Control, MipStart, Solver};

impl Scenario {
    /// Finds the shortest plan, proves that it is the shortest, and minimises the number of impacts
    /// on its horizon.
    ///
    /// ```
    /// use carom::collision_tolerant::Scenario;
    /// use carom::prelude::*;
    ///
    /// let scenario = Scenario::paper().with_time_step(0.05);
    /// let mut solver = BranchAndBound::default();
    /// let careful = scenario.clone().collision_free().shortest(&mut solver)?;
    /// let tolerant = scenario.shortest(&mut solver)?;
    /// assert!(tolerant.is_found() && tolerant.steps < careful.steps);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As for [`plan`](Scenario::plan).
    pub fn shortest(&self, solver: &mut dyn Solver) -> Result<ShortestHorizon<Plan>, Error> {
        self.shortest_with(&ShortestOptions::default(), solver)
    }

    /// As [`shortest`](Scenario::shortest), with limits, windows and rows of your own.
    ///
    /// # Errors
    ///
    /// As for [`shortest`](Scenario::shortest); [`ErrorKind::OutOfRange`] for a bad `max_steps`.
    pub fn shortest_with(
        &self,
        options: &ShortestOptions,
        solver: &mut dyn Solver,
    ) -> Result<ShortestHorizon<Plan>, Error> {
        self.check()?;
        let found = shortest_horizon(self, options, solver)?;
        let mut found =
            found.try_map(|SolvedHorizon { program, solution, .. }| program.plan(&solution))?;
        let Some(plan) = found.plan.take_if(|_| found.status == ShortestStatus::Found) else {
            return Ok(found);
        };
        let folder = solver.options_mut().proof.take();
        let left = options.time_limit.map(|limit| limit.saturating_sub(found.time));
        let mut refinement =
            Refinement { scenario: self, options, solver, left, time: Duration::ZERO };
        let refined = refinement.run(plan, found.tube.as_ref());
        found.time += refinement.time;
        refinement.left = options.time_limit;
        let logged = refined.and_then(|plan| match found.proofs.last_mut() {
            Some(proof) if plan.fewest_impacts => refinement.log(plan, proof),
            _ => Ok(plan),
        });
        solver.options_mut().proof = folder;
        found.plan = Some(logged?);
        Ok(found)
    }

    /// Finds the shortest plans without and with collisions. The first is a hint for the second.
    /// Logs of the two, if the solver is asked for them, go to the folders `free` and `tolerant` in
    /// the folder. If the scenario forbids collisions, the second has the reflecting law.
    ///
    /// # Errors
    ///
    /// As for [`shortest`](Scenario::shortest).
    pub fn compare(
        &self,
        options: &ShortestOptions,
        solver: &mut dyn Solver,
    ) -> Result<PlanComparison, Error> {
        let folder = solver.options().proof.clone();
        let mut logged = |name: &str, scenario: &Scenario, options: &ShortestOptions| {
            solver.options_mut().proof = folder.as_ref().map(|folder| folder.join(name));
            let found = scenario.shortest_with(options, solver);
            solver.options_mut().proof.clone_from(&folder);
            found
        };
        let free = logged("free", &self.clone().collision_free(), options)?;
        let mut options = options.clone();
        options.upper_hint = free.steps.or(options.upper_hint);
        let law = match self.law {
            ContactLaw::Forbidden => ContactLaw::Reflecting,
            law => law,
        };
        let tolerant = logged("tolerant", &self.clone().with_law(law), &options)?;
        Ok(PlanComparison { free, tolerant })
    }
}

/// Minimises the impacts of a plan on its proved horizon.
struct Refinement<'a> {
    scenario: &'a Scenario,
    options: &'a ShortestOptions,
    solver: &'a mut dyn Solver,
    /// The time that is left, if it is limited.
    left: Option<Duration>,
    /// The time of all solves.
    time: Duration,
}

impl Refinement<'_> {
    fn run(&mut self, mut plan: Plan, tube: Option<&Tube>) -> Result<Plan, Error> {
        let (impacts, rule) = (plan.trajectory.impacts.len(), &self.scenario.damage);
        let proved = tube.and_then(Tube::fewest_events).unwrap_or(0);
        let is_priced = rule.price != 0.0 || rule.price_per_hit != 0.0;
        if plan.fewest_impacts || impacts == 0 || (impacts <= proved && !is_priced) {
            plan.fewest_impacts = true;
            return Ok(plan);
        }
        // Without any impact?
        let mut is_needed = proved > 0;
        if !is_needed {
            let mut program = self.program(&plan, Objective::Feasibility)?;
            program.add("no_contact", impacts_of(&program).le(0.0))?;
            let Some(solution) = self.solve(&program, &MipStart::new())? else { return Ok(plan) };
            plan.refinements.push(*solution.statistics());
            if solution.point().is_some() {
                let refinements = plan.refinements;
                return Ok(Plan { refinements, fewest_impacts: true, ..program.plan(&solution)? });
            }
            is_needed = solution.is_infeasible();
        }
        if is_needed && impacts == 1 && !is_priced {
            plan.fewest_impacts = true;
            return Ok(plan);
        }
        // As few as possible.
        let mut program = self.program(&plan, Objective::Impacts)?;
        if is_needed {
            program.add("contact_needed", impacts_of(&program).ge(1.0))?;
        }
        if let Some(tube) = tube {
            let _report = program.program_mut().tighten(tube)?;
        }
        let Some(solution) = self.solve(&program, &MipStart::new())? else { return Ok(plan) };
        plan.refinements.push(*solution.statistics());
        if solution.point().is_none() {
            return Ok(plan);
        }
        let (refinements, fewest_impacts) = (plan.refinements, solution.is_optimal());
        Ok(Plan { refinements, fewest_impacts, ..program.plan(&solution)? })
    }

    /// Solves the program of a plan as the scenario states it, and writes its log in the place of
    /// that of the search. The plan is then the point in the log.
    fn log(&mut self, plan: Plan, proof: &mut HorizonProof) -> Result<Plan, Error> {
        let program = self.program(&plan, Objective::Impacts)?;
        let contacts = program.contact.iter().zip(&plan.trajectory.contact);
        let values = contacts
            .map(|(zeta, hit)| (zeta.variable(), f64::from(u8::from(zeta.is_on() == *hit))));
        let start = MipStart::new().with_values(values);
        self.solver.options_mut().proof = Some(proof.path.clone());
        let solution = self.solve(&program, &start);
        self.solver.options_mut().proof = None;
        // A log that cannot be written costs no plan: that of the search has told it.
        let solution = match solution {
            Err(error) if matches!(error.kind(), ErrorKind::Io { .. }) => return Ok(plan),
            solution => solution?,
        };
        let Some(solution) = solution else { return Ok(plan) };
        proof.report = solution.proof().cloned().filter(|_| solution.is_optimal());
        if !solution.is_optimal() {
            return Ok(plan);
        }
        let (refinements, fewest_impacts) = (plan.refinements, plan.fewest_impacts);
        Ok(Plan { refinements, fewest_impacts, ..program.plan(&solution)? })
    }

    /// The program of a plan's horizon, with the statements of the options.
    fn program(&self, plan: &Plan, objective: Objective) -> Result<PlanningProgram, Error> {
        let mut program = self.scenario.program(plan.trajectory.steps(), objective)?;
        self.options.complete(program.program_mut())?;
        Ok(program)
    }

    /// Solves within the remaining time of the search; `None` if there is none.
    fn solve(
        &mut self,
        program: &PlanningProgram,
        start: &MipStart,
    ) -> Result<Option<Solution>, Error> {
        let interrupt = &self.options.interrupt;
        if interrupt.is_triggered() || self.left == Some(Duration::ZERO) {
            return Ok(None);
        }
        let own = self.solver.options().time_limit;
        self.solver.options_mut().time_limit = own.into_iter().chain(self.left).min();
        let mut control = Control::default().with_interrupt(interrupt).with_start(start);
        let solution = self.solver.solve_with(program.model(), &mut control);
        self.solver.options_mut().time_limit = own;
        let solution = solution?;
        let time = solution.statistics().time;
        self.time += time;
        self.left = self.left.map(|left| left.saturating_sub(time));
        Ok(Some(solution))
    }
}

/// `Σ ζ(t)`.
fn impacts_of(program: &PlanningProgram) -> Affine {
    program.contact.iter().map(|&zeta| Affine::from(zeta)).sum()
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
