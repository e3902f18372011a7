//! Planning over a fixed horizon, with a certificate for every plan.

use std::collections::BTreeMap;

use super::law::ContactLaw;
use super::program::{Objective, PlanningProgram, Written};
use super::scenario::Scenario;
use super::trajectory::Trajectory;
use crate::error::{Error, ErrorKind};
use crate::hybrid::scene::{SceneCertificate, ScenePlan};
use crate::hybrid::{HybridPlan, HybridRun, RunCertificate};
use crate::model::Affine;
use crate::solution::{Solution, Statistics, Termination};
use crate::solver::{Control, Solver};

/// The share of half its range from which on an input is pushed to the end of its range.
const IDLE_SHARE: f64 = 1e-3;

/// A certified plan. It is nominal: [pushes](Scenario::with_pushes) and the
/// [spread](Scenario::with_spread) of the restitution are left out; plans that hold under them are
/// made by [`HybridProgram::robust`](crate::hybrid::HybridProgram::robust).
#[derive(Debug, Clone)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Plan {
    /// The samples and impacts.
    pub trajectory: Trajectory,
    /// The run of the [scenario's system](Scenario::hybrid_system), which every step has been
    /// checked against: limits, guards and next states.
    pub run: HybridRun,
    /// The replay through the scenario's scene, step by step and from the first sample alone, which
    /// agrees with the plan, and with impacts where they happen, which measures the discretisation
    /// error. Scenes do not have the literal law; its residual and drift are those of the run.
    pub certificate: SceneCertificate,
    /// The solution from which it comes, with its objective, bound, counts, and the check against
    /// the program; that of the whole program for a case.
    pub solution: Solution,
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
    /// assert!(plan.certificate.drift <= 1e-6);
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
        // A log takes nothing from sets as given.
        if solver.options().proof.is_none() {
            let tube = self.reach_sets()?.tube(steps)?;
            if program.program_mut().tighten(&tube)?.infeasible {
                let termination = Termination::Infeasible.to_string();
                let help =
                    "`Scenario::explainable_program` and `explain` say which limits are in the way";
                return Err(ErrorKind::NoPlan { termination, help }.into());
            }
        }
        program.solve(solver)
    }

    /// The plan of a path through the scenario's scene, replayed there.
    fn plan_of(&self, plan: ScenePlan, last: &Affine) -> Result<Plan, Error> {
        let steps = plan.steps();
        let ScenePlan { bodies, hits, run, certificate, solution, .. } =
            self.scene_over(steps).replay(&plan)?;
        let column = |values: &[Vec<f64>]| -> Vec<f64> {
            values.iter().flat_map(|value| value.first().copied()).collect()
        };
        let mut trajectory = Trajectory::new(self.time_step);
        for body in &bodies {
            trajectory.position = column(&body.position);
            trajectory.velocity = column(&body.velocity);
            trajectory.acceleration = column(&body.acceleration);
        }
        trajectory.complete(solution.value(last)?);
        for hit in hits {
            let speeds = [hit.end_speed, hit.damage];
            trajectory.add_impact(hit.step, hit.time, speeds, self.restitution.value());
        }
        Ok(Plan::new(self, trajectory, run, certificate, solution))
    }

    /// The plan of a run of the paper's own system, certified against it.
    fn literal_plan(&self, plan: HybridPlan, last: &Affine) -> Result<Plan, Error> {
        let HybridPlan { run, solution, .. } = plan;
        let mut trajectory = Trajectory::new(self.time_step);
        trajectory.position = run.state("vehicle x")?.to_vec();
        trajectory.velocity = run.state("vehicle vx")?.to_vec();
        trajectory.acceleration = run.input("vehicle ax")?.to_vec();
        trajectory.complete(solution.value(last)?);
        for (t, name) in run.transitions("mode")?.iter().enumerate() {
            if name == "contact" {
                // The wall pushes from the start of the step on.
                let speed = -self.wall.rate(trajectory.velocity[t]);
                let time = trajectory.time[t];
                trajectory.add_impact(t, time, [speed, speed.max(0.0)], self.restitution.value());
            }
        }
        let RunCertificate { time_step, largest_residual, drift, .. } =
            self.system(trajectory.steps())?.certify(&run)?;
        let mut certificate = SceneCertificate::default();
        (certificate.time_step, certificate.drift) = (time_step, drift);
        certificate.largest_residual = largest_residual;
        Ok(Plan::new(self, trajectory, run, certificate, solution))
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
    /// [`SceneError`](crate::hybrid::scene::SceneError) for a plan that is not what the scenario
    /// says.
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
        match &self.written {
            Written::Scene(program) => self.scene_plan(program.solve_with(control, solver)?),
            Written::Literal(program) => {
                self.scenario.literal_plan(program.solve_with(control, solver)?, self.last())
            }
        }
    }

    /// The certified plan of a solution of the [model](PlanningProgram::model), for those who solve
    /// it themselves.
    ///
    /// # Errors
    ///
    /// Those of [`solve`](PlanningProgram::solve) that do not come from the solver;
    /// [`ErrorKind::ForeignHandle`] for a solution of another model.
    pub fn plan(&self, solution: &Solution) -> Result<Plan, Error> {
        match &self.written {
            Written::Scene(program) => self.scene_plan(program.plan(solution)?),
            Written::Literal(program) => {
                self.scenario.literal_plan(program.plan(solution)?, self.last())
            }
        }
    }

    /// The plan of a scene and of its cases.
    fn scene_plan(&self, mut plan: ScenePlan) -> Result<Plan, Error> {
        let mut cases = BTreeMap::new();
        for (name, scenario, last) in &self.cases {
            if let Some(case) = plan.cases.remove(name) {
                cases.insert(name.clone(), scenario.plan_of(case, last)?);
            }
        }
        Ok(Plan { cases, ..self.scenario.plan_of(plan, self.last())? })
    }

    /// a(τ).
    fn last(&self) -> &Affine {
        &self.acceleration[self.steps()]
    }
}

impl Plan {
    fn new(
        scenario: &Scenario,
        trajectory: Trajectory,
        run: HybridRun,
        certificate: SceneCertificate,
        solution: Solution,
    ) -> Self {
        Plan {
            trajectory,
            run,
            certificate,
            solution,
            fewest_impacts: scenario.law == ContactLaw::Forbidden,
            refinements: Vec::new(),
            cases: BTreeMap::new(),
        }
    }

    /// A plan with the same contacts and steps whose accelerations are extreme: all but a few are
    /// at the ends of their range, where they are only near in a plan from the middle of many. The
    /// solution stays that of this plan. The plan itself if there is nothing to choose.
    ///
    /// # Arguments
    ///
    /// * `scenario`: the scenario of the plan.
    ///
    /// # Errors
    ///
    /// As for [`Scenario::plan`].
    pub fn extreme(&self, scenario: &Scenario, solver: &mut dyn Solver) -> Result<Plan, Error> {
        let own = &self.trajectory;
        let mut program = scenario.program(own.steps(), Objective::Feasibility)?;
        for (t, hit) in program.contact.clone().into_iter().enumerate() {
            let hits = f64::from(u8::from(own.contact[t]));
            program.add(("same_contact", t), Affine::from(hit).equals(hits))?;
        }
        // From the middle of the range outward.
        let (range, mut inward) = (scenario.acceleration, Affine::zero());
        let half = 0.5 * (range.upper - range.lower);
        for t in 0..own.steps() {
            let share = (own.acceleration[t] - range.lower) / half - 1.0;
            match share.abs() > IDLE_SHARE {
                true => inward += -share * &program.acceleration[t],
                false => {
                    let idle = program.acceleration[t].equals(own.acceleration[t]);
                    program.add(("idle", t), idle)?;
                }
            }
        }
        program.minimize(inward)?;
        match program.solve(solver) {
            Ok(Plan { trajectory, run, certificate, .. }) => {
                Ok(Plan { trajectory, run, certificate, ..self.clone() })
            }
            Err(error) if matches!(error.kind(), ErrorKind::NoPlan { .. }) => Ok(self.clone()),
            Err(error) => Err(error),
        }
    }
}
