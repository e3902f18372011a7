//! Planning over a fixed horizon, with a certificate for every plan.

use super::program::{Objective, PlanningProgram};
use super::scenario::Scenario;
use super::trajectory::Trajectory;
use crate::error::{Error, ErrorKind};
use crate::hybrid::scene::samples::{check_line_ends, replay_line};
use crate::hybrid::scene::{SceneCertificate, SceneError, SceneHit};
use crate::hybrid::{ContactLaw, HybridRun, RunCertificate};
use crate::solution::{Solution, Statistics, Termination, Verification};
use crate::solver::{Control, Solver, StopToken};
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
    /// The replay through the scenario's scene, step by step and from the first
    /// sample alone, which agrees with the plan within [`tolerance::REPLAY`], and with impacts where
    /// they happen, which measures the discretisation error. Scenes do not have the literal law; its
    /// residual and drift are those of `run`.
    pub replay: SceneCertificate,
}

/// A certified plan.
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
    #[cfg_attr(feature = "serde", serde(with = "crate::wire"))]
    pub bound: f64,
    /// Why the solver stopped; [`Termination::Optimal`] when the plan is proved optimal.
    pub termination: Termination,
    /// Counts and time of the solve.
    pub statistics: Statistics,
}

/// The result of planning over a fixed horizon.
#[derive(Debug, Clone)]
#[non_exhaustive]
#[must_use]
pub enum PlanOutcome {
    /// A certified plan; see [`Plan::termination`] for whether it is optimal.
    Planned(Box<Plan>),
    /// There is no plan over this horizon; this is proved.
    Infeasible(Statistics),
    /// Stopped without a plan and without a proof.
    Stopped {
        /// Why.
        reason: Termination,
        /// Counts and time of the solve.
        statistics: Statistics,
    },
}

impl PlanOutcome {
    /// The plan, if there is one.
    pub fn plan(&self) -> Option<&Plan> {
        match self {
            PlanOutcome::Planned(plan) => Some(plan),
            _ => None,
        }
    }

    /// The plan, if there is one, by value.
    pub fn into_plan(self) -> Option<Plan> {
        match self {
            PlanOutcome::Planned(plan) => Some(*plan),
            _ => None,
        }
    }

    /// Whether it is proved that there is no plan.
    pub fn is_infeasible(&self) -> bool {
        matches!(self, PlanOutcome::Infeasible(_))
    }
}

/// Plans a scenario over a fixed horizon.
///
/// Reach sets come first. They may prove that there is no plan, and they fix contacts and tighten
/// bounds of the program before it is solved. [`PlanningProgram::build`] does not use them.
///
/// ```
/// use carom::collision_tolerant::{Objective, Scenario, plan};
/// use carom::prelude::*;
///
/// let scenario = Scenario::paper().with_restitution(0.5)?.with_time_step(0.1);
/// let outcome = plan(&scenario, 30, Objective::Effort, &mut BranchAndBound::default())?;
/// let plan = outcome.plan().expect("3 s are enough");
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
/// Those of [`Scenario::check`] and of the solver; [`ErrorKind::OutOfRange`] for the number of steps;
/// [`SceneError`] if the solver's plan disagrees with its replay and cannot be certified.
pub fn plan(
    scenario: &Scenario,
    steps: usize,
    objective: Objective,
    solver: &mut dyn Solver,
) -> Result<PlanOutcome, Error> {
    plan_with(scenario, steps, objective, solver, &mut Control::default())
}

/// Same as [`plan`], with progress events and an interrupt.
///
/// # Errors
///
/// As for [`plan`].
pub fn plan_with(
    scenario: &Scenario,
    steps: usize,
    objective: Objective,
    solver: &mut dyn Solver,
    control: &mut Control<'_>,
) -> Result<PlanOutcome, Error> {
    let mut program = PlanningProgram::build(scenario, steps, objective)?;
    let token = StopToken::new(solver.options().time_limit, control.interrupt());
    if let Some(tube) = scenario.reach_sets()?.tube_until(steps, &token)?
        && tube.tighten(&mut program.model, &program.hybrid.horizon_variables())?.infeasible
    {
        return Ok(PlanOutcome::Infeasible(Statistics::default()));
    }
    let solution = solver.solve_with(&program.model, control)?;
    outcome(scenario, &program, &solution)
}

/// Turns a solution into a certified plan.
pub(super) fn outcome(
    scenario: &Scenario,
    program: &PlanningProgram,
    solution: &Solution,
) -> Result<PlanOutcome, Error> {
    if solution.point().is_some() {
        let plan = Plan::certify(scenario, program, solution)?;
        return Ok(PlanOutcome::Planned(Box::new(plan)));
    }
    let statistics = *solution.statistics();
    Ok(match solution.termination() {
        Termination::Infeasible => PlanOutcome::Infeasible(statistics),
        reason => PlanOutcome::Stopped { reason, statistics },
    })
}

impl Plan {
    /// Reads a plan from a solution of a program and certifies it: limits, start and goal are
    /// checked, and its accelerations are replayed twice.
    ///
    /// The program may have been extended: what the scenario says is checked against the scenario
    /// itself, and the solution is verified against all rows of the program.
    ///
    /// ```
    /// use carom::collision_tolerant::{Objective, Plan, PlanningProgram, Scenario};
    /// use carom::prelude::*;
    ///
    /// let scenario = Scenario::paper().with_time_step(0.1);
    /// let mut program = PlanningProgram::build(&scenario, 30, Objective::Effort)?;
    /// // Speeds up to 6 m/s in the first second, and nothing in the second one.
    /// for t in 1..=10 {
    ///     program.model.add(("slow", t), program.velocity[t].within(-6.0, 6.0))?;
    ///     program.model.add(("coast", t), program.acceleration[10 + t].equals(0.0))?;
    /// }
    /// let solution = BranchAndBound::default().solve(&program.model)?;
    /// let plan = Plan::certify(&scenario, &program, &solution)?;
    /// assert!(plan.trajectory.velocity[10] >= -6.0 - 1e-6);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ErrorKind::NoPoint`] if the solution has no point, [`ErrorKind::ForeignHandle`] if it is of
    /// another model; [`RunError`](crate::hybrid::RunError) and
    /// [`SceneError`] if the plan is not what the scenario says.
    pub fn certify(
        scenario: &Scenario,
        program: &PlanningProgram,
        solution: &Solution,
    ) -> Result<Self, Error> {
        scenario.check()?;
        let mut trajectory = Trajectory::read(program, solution)?;
        let system = scenario.system(&program.horizon, &scenario.damage)?;
        let run = program.hybrid.read(solution)?;
        let checked = system.certify(&run)?;
        let replay = replay(scenario, program, &checked, &mut trajectory)?;
        let no_point =
            || Error::from(ErrorKind::NoPoint { termination: solution.termination().to_string() });
        let verification = solution.verification().cloned().ok_or_else(no_point)?;
        let objective = solution.objective().ok_or_else(no_point)?;
        Ok(Plan {
            trajectory,
            run,
            certificate: PlanCertificate { verification, run: checked, replay },
            objective,
            bound: solution.bound(),
            termination: solution.termination(),
            statistics: *solution.statistics(),
        })
    }

    /// A plan with the same contacts and steps whose accelerations are extreme: all but a few are at
    /// the ends of their range, where they are only near in a plan from the middle of many. Bound
    /// and objective stay those of this plan. The plan itself if there is nothing to choose.
    ///
    /// # Arguments
    ///
    /// * `scenario`: the scenario of the plan.
    ///
    /// # Errors
    ///
    /// As for [`plan`](super::plan()).
    pub fn extreme(&self, scenario: &Scenario, solver: &mut dyn Solver) -> Result<Plan, Error> {
        let steps = self.trajectory.steps();
        let program = PlanningProgram::build(scenario, steps, Objective::Feasibility)?;
        match program.hybrid.extreme(&program.model, &self.run, solver)? {
            None => Ok(self.clone()),
            Some(solution) => {
                let Plan { objective, bound, termination, statistics, .. } = *self;
                let found = Plan::certify(scenario, &program, &solution)?;
                Ok(Plan { objective, bound, termination, statistics, ..found })
            }
        }
    }
}

/// Replays a trajectory and completes its impacts.
fn replay(
    scenario: &Scenario,
    program: &PlanningProgram,
    run: &RunCertificate,
    trajectory: &mut Trajectory,
) -> Result<SceneCertificate, Error> {
    let e = scenario.contact.restitution.value();
    let scene = scenario.scene(&program.horizon);
    let certificate = if scenario.contact.law == ContactLaw::Literal {
        check_line_ends(&scene, &trajectory.samples())?;
        // The wall pushes from the start of the step on.
        for t in 0..trajectory.steps() {
            if trajectory.contact[t] {
                let speed = -scenario.contact.wall.rate(trajectory.velocity[t]);
                trajectory.add_impact(t, trajectory.time[t], [speed, speed.max(0.0)], e);
            }
        }
        let RunCertificate { time_step, largest_residual, drift, .. } = *run;
        SceneCertificate { time_step, largest_residual, drift, ..Default::default() }
    } else {
        let (hits, certificate) = replay_line(&scene, &trajectory.samples())?;
        for SceneHit { step, time, end_speed, damage, .. } in hits {
            trajectory.add_impact(step, time, [end_speed, damage], e);
        }
        certificate
    };
    let samples = trajectory.position.iter().chain(&trajectory.velocity);
    let size = samples.fold(0.0_f64, |size, x| size.max(x.abs()));
    let (by, allowed) = (certificate.drift, tolerance::REPLAY * margin_scale(size, 0.0));
    if by <= allowed {
        return Ok(certificate);
    }
    let what = "its accelerations lead elsewhere from the first sample alone (m, m/s)".into();
    Err(SceneError::Replay { step: trajectory.steps(), what, by, allowed }.into())
}
