//! Planning over a fixed horizon, with a certificate for every plan.

use std::collections::BTreeMap;

use super::program::{Objective, PlanningProgram};
use super::scenario::{Collisions, Scenario};
use super::trajectory::Trajectory;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::error::{Error, SceneError};
use crate::hybrid::horizon::Horizon;
use crate::hybrid::rows::no_plan;
use crate::hybrid::scene::samples::{Samples, check_line_ends, replay_line_in};
use crate::hybrid::scene::{SceneCertificate, SceneHit};
use crate::hybrid::{ContactLaw, HybridRun, RunCertificate};
use crate::solution::{Solution, Statistics, Termination, Verification};
use crate::solver::{Control, Interrupt, Solver, StopToken};
use crate::tolerance::{self, margin_scale};

/// Why a plan can be trusted.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PlanCertificate {
    /// The check of the solution against the program: bounds, rows, and every implication, with
    /// rounded binaries.
    pub verification: Verification,
    /// The check of every step against the [scenario's system](Scenario::hybrid_system): limits,
    /// guards and next states.
    pub run: RunCertificate,
    /// The replay through the scenario's scene, step by step and from the first sample alone, which
    /// agrees with the plan within [`tolerance::REPLAY`], and with impacts where they happen, which
    /// measures the discretisation error. Scenes do not have the literal law; its residual and
    /// drift are those of `run`.
    pub replay: SceneCertificate,
}

/// A certified plan. It is nominal: [pushes](Scenario::with_pushes) and the
/// [spread](Scenario::with_spread) of the restitution are left out; plans that hold under them are
/// made by [`HybridProgram::robust`](crate::hybrid::HybridProgram::robust).
#[derive(Debug, Clone)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Plan {
    /// The samples and impacts.
    pub trajectory: Trajectory,
    /// The run of the [scenario's system](Scenario::hybrid_system).
    pub run: HybridRun,
    /// Why it can be trusted.
    pub certificate: PlanCertificate,
    /// Value of the objective, in the unit of [`Objective`].
    pub objective: f64,
    /// Proved lower bound of the objective over this horizon, in the same unit.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_numbers"))]
    pub bound: f64,
    /// Why the solver stopped; [`Termination::Optimal`] when the plan is proved optimal.
    pub termination: Termination,
    /// Counts and time of the solve.
    pub statistics: Statistics,
    /// Whether it is proved that no plan of so many steps has fewer impacts (with prices of damage:
    /// a smaller sum of impacts and prices). Only [`Scenario::shortest`] looks for the fewest.
    pub fewest_impacts: bool,
    /// The solves that minimised the impacts.
    pub refinements: Vec<Statistics>,
    /// The plans of the [cases](PlanningProgram::add_case), by name, each certified against its own
    /// scenario.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "BTreeMap::is_empty"))]
    pub cases: BTreeMap<String, Plan>,
}

impl Scenario {
    /// Plans over a fixed horizon.
    ///
    /// Reach sets come first. They may prove that there is no plan, and they fix contacts and
    /// tighten bounds of the [program](Scenario::program) before it is solved.
    ///
    /// ```
    /// use carom::collision_tolerant::{Objective, Scenario};
    /// use carom::prelude::*;
    ///
    /// let scenario = Scenario::paper().with_restitution(0.5)?.with_time_step(0.1);
    /// let plan = scenario.plan(30, Objective::Effort, &mut BranchAndBound::default())?;
    /// assert_eq!(plan.trajectory.steps(), 30);
    /// assert!(plan.certificate.replay.drift <= 1e-6);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Arguments
    ///
    /// * `steps`: the horizon τ.
    ///
    /// # Errors
    ///
    /// Those of [`program`](Scenario::program) and of [`PlanningProgram::solve`].
    pub fn plan(
        &self,
        steps: usize,
        objective: Objective,
        solver: &mut dyn Solver,
    ) -> Result<Plan, Error> {
        let mut program = self.program(steps, objective)?;
        let token = StopToken::new(solver.options().time_limit, &Interrupt::new());
        // A log takes nothing from sets as given.
        if solver.options().proof.is_none()
            && let Some(tube) = self.reach_sets()?.tube_until(steps, &token)?
            && program.program_mut().tighten(&tube)?.infeasible
        {
            return Err(no_plan(Termination::Infeasible));
        }
        program.solve(solver)
    }
}

impl PlanningProgram {
    /// Solves the program. The plan is certified: limits, start and goal are checked against the
    /// scenario, its accelerations are replayed twice by code that shares nothing with the rows,
    /// and the solution is verified against all rows of the program.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::NoPlan`] if the solver ends without a plan, because there is none or because
    /// it was stopped; errors of the solver; [`RunError`](crate::hybrid::RunError) and
    /// [`SceneError`] for a plan that is not what the scenario says.
    pub fn solve(&self, solver: &mut dyn Solver) -> Result<Plan, Error> {
        self.solve_with(&mut Control::default(), solver)
    }

    /// Solves the program with events, warm starts and limits, as
    /// [`solve`](PlanningProgram::solve).
    ///
    /// # Errors
    ///
    /// Those of [`solve`](PlanningProgram::solve).
    pub fn solve_with(
        &self,
        control: &mut Control<'_>,
        solver: &mut dyn Solver,
    ) -> Result<Plan, Error> {
        let solution = solver.solve_with(self.model(), control)?;
        self.read(&*self.program.settled(&solution, Some(solver))?)
    }

    /// The certified plan of a solution of the [model](crate::hybrid::HybridProgram::model), for
    /// those who solve it themselves.
    ///
    /// # Errors
    ///
    /// Those of [`solve`](PlanningProgram::solve) that do not come from the solver;
    /// [`ErrorKind::ForeignHandle`] for a solution of another model.
    pub fn plan(&self, solution: &Solution) -> Result<Plan, Error> {
        self.read(&*self.program.settled(solution, None)?)
    }

    /// The plan of a solution whose states are the run of its inputs.
    fn read(&self, solution: &Solution) -> Result<Plan, Error> {
        self.scenario.check()?;
        let run = self.program().variables().read(solution)?;
        let mut trajectory = Trajectory::read(self, solution)?;
        let horizon = Horizon::new(self.steps(), self.scenario.time_step)?;
        let system = self.scenario.system(&horizon, &self.scenario.damage)?;
        let checked = match self.units.is_plain() {
            true => system.certify(&run)?,
            false => system.certify_in(self.program().variables().coordinates(), &run)?,
        };
        let own = match solution.point().filter(|_| !self.units.is_plain()) {
            Some(point) => self.program().variables().read_own(point)?,
            None => run.clone(),
        };
        let replay = self.replay(&own, &checked, &mut trajectory)?;
        let no_point = || no_plan(solution.termination());
        let verification = solution.verification().cloned().ok_or_else(no_point)?;
        let objective = solution.objective().ok_or_else(no_point)?;
        let cases = self.cases.iter().map(|(name, case)| Ok((name.clone(), case.read(solution)?)));
        let cases = cases.collect::<Result<_, Error>>()?;
        Ok(Plan {
            trajectory,
            run,
            cases,
            certificate: PlanCertificate { verification, run: checked, replay },
            objective,
            bound: solution.bound(),
            termination: solution.termination(),
            statistics: *solution.statistics(),
            fewest_impacts: self.scenario.collisions == Collisions::Forbidden,
            refinements: Vec::new(),
        })
    }
}

impl Plan {
    /// A plan with the same contacts and steps whose accelerations are extreme: all but a few are
    /// at the ends of their range, where they are only near in a plan from the middle of many.
    /// Bound and objective stay those of this plan. The plan itself if there is nothing to choose.
    ///
    /// # Arguments
    ///
    /// * `scenario`: the scenario of the plan.
    ///
    /// # Errors
    ///
    /// As for [`Scenario::plan`].
    pub fn extreme(&self, scenario: &Scenario, solver: &mut dyn Solver) -> Result<Plan, Error> {
        let program = scenario.program(self.trajectory.steps(), Objective::Feasibility)?;
        let solution = program.program().variables().extreme(program.model(), &self.run, solver)?;
        let Some(solution) = solution else { return Ok(self.clone()) };
        let Plan { trajectory, run, certificate, .. } = program.plan(&solution)?;
        Ok(Plan { trajectory, run, certificate, ..self.clone() })
    }
}

impl PlanningProgram {
    /// Replays a run, in the units of the program, and completes the impacts of its trajectory.
    fn replay(
        &self,
        own: &HybridRun,
        run: &RunCertificate,
        trajectory: &mut Trajectory,
    ) -> Result<SceneCertificate, Error> {
        let (scenario, units) = (&self.scenario, &self.units);
        let (e, steps) = (scenario.contact.restitution.value(), trajectory.steps());
        let scene = scenario.scene(&Horizon::new(steps, scenario.time_step)?);
        let (position, velocity) = (own.state("x")?, own.state("v")?);
        let contact = trajectory.contact[..steps].to_vec();
        let acceleration = own.input("a")?;
        let samples = Samples { position, velocity, acceleration, contact: &contact };
        let certificate = if scenario.contact.law == ContactLaw::Literal {
            check_line_ends(units, &scene, &samples)?;
            // The wall pushes from the start of the step on.
            for t in (0..steps).filter(|&t| contact[t]) {
                let speed = -scenario.contact.wall.rate(trajectory.velocity[t]);
                trajectory.add_impact(t, trajectory.time[t], [speed, speed.max(0.0)], e);
            }
            let RunCertificate { time_step, largest_residual, drift, .. } = *run;
            SceneCertificate { time_step, largest_residual, drift, ..Default::default() }
        } else {
            let (hits, certificate) = replay_line_in(units, &scene, &samples)?;
            for SceneHit { step, time, end_speed, damage, .. } in hits {
                trajectory.add_impact(step, time, [end_speed, damage], e);
            }
            certificate
        };
        let samples = position.iter().chain(velocity);
        let size = samples.fold(0.0_f64, |size, x| size.max(x.abs()));
        let [place, speed, _] = units.measures();
        let allowed = place.scale.max(speed.scale) * tolerance::REPLAY * margin_scale(size, 0.0);
        let by = certificate.drift;
        if by <= allowed {
            return Ok(certificate);
        }
        let what = "its accelerations lead elsewhere from the first sample alone (m, m/s)".into();
        Err(SceneError::Replay { step: steps, what, by, allowed }.into())
    }
}
