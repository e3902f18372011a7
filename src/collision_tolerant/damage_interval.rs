//! The limits on the damage of one impact for which a given horizon is the shortest.
//!
//! Let `d(τ)` be the smallest possible largest impact speed of a plan over τ steps, in m/s
//! (infinite if there is no plan). If waiting is free, `d` does not increase with τ, and τ is the
//! shortest horizon under the limit `D_max` of equation (19) if and only if
//! `d(τ) <= D_max < d(τ-1)`.
//!
//! Each end is enclosed between a plan and a refutation. The largest impact speed of a plan is
//! minimised with its contacts fixed, which is a linear program. Then a slightly lower limit is
//! tried, which is either refuted or gives a better plan. Minimising `max D(t)` over the binaries
//! directly gives the same ends but takes many times longer, because relaxations spread one impact
//! over many steps and their bounds are weak.

use web_time::Duration;

use super::error::ScenarioError;
use super::plan::{PlanOutcome, outcome};
use super::program::{Objective, PlanningProgram};
use super::reach::tighten;
use super::scenario::{Collisions, Scenario};
use super::trajectory::Trajectory;
use crate::error::Error;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::setters::setters;
use crate::solution::Termination;
use crate::solver::{Interrupt, Solver, StopToken};

/// Options of [`damage_interval()`].
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct IntervalOptions {
    /// The resolution of each end, in m/s (`1e-5..=1e3`); default 1e-3. A finer one would be below
    /// the feasibility tolerance.
    pub resolution: f64,
    /// Wall-clock limit of the whole search; default none.
    pub time_limit: Option<Duration>,
    /// Stops the search.
    pub interrupt: Interrupt,
}

impl Default for IntervalOptions {
    fn default() -> Self {
        IntervalOptions { resolution: 1e-3, time_limit: None, interrupt: Interrupt::new() }
    }
}

impl IntervalOptions {
    setters! {
        /// Sets the resolution of each end, in m/s.
        with_resolution(resolution: f64) => resolution = resolution;
        /// Sets the wall-clock limit.
        with_time_limit(limit: Duration) => time_limit = Some(limit);
        /// Lets a handle stop the search.
        with_interrupt(interrupt: &Interrupt) => interrupt = interrupt.clone();
    }
}

/// One end of the interval, `d` of one horizon, enclosed.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct End {
    /// The horizon is proved to have no plan under this limit, in m/s. Infinite if it has no plan
    /// under any limit; 0 if nothing is refuted.
    #[cfg_attr(feature = "serde", serde(with = "crate::wire"))]
    pub bound: f64,
    /// Largest impact speed of the best plan found, in m/s; infinite if there is none.
    #[cfg_attr(feature = "serde", serde(with = "crate::wire"))]
    pub attained: f64,
}

impl End {
    /// Width of the enclosure, in m/s.
    pub fn resolution(&self) -> f64 {
        if self.bound == self.attained { 0.0 } else { self.attained - self.bound }
    }
}

/// The limits on the impact speed for which a horizon is the shortest.
///
/// The horizon is the shortest for every limit in `[lower.attained, upper.bound]`, and for no limit
/// up to `lower.bound` or from `upper.attained` on. In between, it is unknown.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[must_use]
pub struct DamageInterval {
    /// The horizon τ, in steps.
    pub steps: usize,
    /// The lower end, `d(τ)`.
    pub lower: End,
    /// The upper end, `d(τ-1)`; infinite when τ-1 is infeasible under any limit.
    pub upper: End,
    /// Why the search ended before both ends were known to the resolution, if it did.
    pub stopped: Option<Termination>,
    /// Number of solves, including those with fixed binaries.
    pub solves: usize,
    /// Nodes over all solves.
    pub nodes: u64,
    /// Wall-clock time.
    pub time: Duration,
}

impl DamageInterval {
    /// The middle of the limits for which the horizon is certainly the shortest, in m/s. `None` if
    /// there is no such limit, or if they have no upper end.
    pub fn middle(&self) -> Option<f64> {
        let (lower, upper) = (self.lower.attained, self.upper.bound);
        (lower <= upper && upper.is_finite()).then_some(0.5 * (lower + upper))
    }
}

/// Finds the limits on the impact speed for which a horizon is the shortest one.
///
/// The scenario's limit on a hit and its prices are ignored; its other limits apply.
///
/// ```
/// use carom::collision_tolerant::{IntervalOptions, Scenario, damage_interval};
/// use carom::prelude::*;
///
/// let scenario = Scenario::paper().with_time_step(0.05);
/// let mut solver = BranchAndBound::default();
/// let interval = damage_interval(&scenario, 49, &IntervalOptions::default(), &mut solver)?;
/// assert!((interval.lower.attained - 5.895).abs() < 2e-3);
/// assert!((interval.upper.attained - 6.947).abs() < 2e-3);
/// # Ok::<(), carom::Error>(())
/// ```
///
/// # Arguments
///
/// * `steps`: the horizon τ.
///
/// # Errors
///
/// [`ScenarioError`] if collisions are forbidden or waiting is not free; [`ErrorKind::OutOfRange`]
/// for a resolution out of its range; otherwise as for [`plan`](super::plan()).
pub fn damage_interval(
    scenario: &Scenario,
    steps: usize,
    options: &IntervalOptions,
    solver: &mut dyn Solver,
) -> Result<DamageInterval, Error> {
    check(scenario, options)?;
    let mut open = scenario.clone();
    open.damage.per_hit = None;
    (open.damage.price, open.damage.price_per_hit) = (0.0, 0.0);
    let token = StopToken::new(options.time_limit, &options.interrupt);
    let resolution = options.resolution;
    let mut search =
        Search { scenario: open, resolution, solver, token, stopped: None, solves: 0, nodes: 0 };
    let lower = search.end(steps)?;
    let upper = match steps {
        1 => End { bound: f64::INFINITY, attained: f64::INFINITY },
        _ => search.end(steps - 1)?,
    };
    let Search { stopped, solves, nodes, token, .. } = search;
    Ok(DamageInterval { steps, lower, upper, stopped, solves, nodes, time: token.elapsed() })
}

fn check(scenario: &Scenario, options: &IntervalOptions) -> Result<(), Error> {
    scenario.check()?;
    if scenario.collisions == Collisions::Forbidden {
        return Err(ScenarioError::NoCollisions.into());
    }
    if !scenario.waiting().is_free() {
        return Err(ScenarioError::CannotWait.into());
    }
    if !(1e-5..=1e3).contains(&options.resolution) {
        let (what, range) = ("the resolution (m/s)", "within [1e-5, 1e3]");
        return Err(Error::out_of_range(what, options.resolution, range));
    }
    Ok(())
}

struct Search<'a> {
    /// The scenario without a per-impact limit.
    scenario: Scenario,
    resolution: f64,
    solver: &'a mut dyn Solver,
    token: StopToken,
    stopped: Option<Termination>,
    solves: usize,
    nodes: u64,
}

/// The verdict of a solve.
enum Answer {
    Plan(Trajectory),
    Refuted,
    Stopped,
}

impl Search<'_> {
    /// Encloses `d(steps)`.
    fn end(&mut self, steps: usize) -> Result<End, Error> {
        let mut end = End { bound: 0.0, attained: f64::INFINITY };
        match self.feasible(steps, None)? {
            Answer::Plan(plan) => end.attained = self.soften(steps, &plan)?,
            Answer::Refuted => end.bound = f64::INFINITY,
            Answer::Stopped => return Ok(end),
        }
        // First just below the best plan, and further below after each success.
        let mut step = self.resolution;
        while end.resolution() > self.resolution * 1.000_001 {
            let below = end.attained - step;
            let limit = if below > end.bound { below } else { 0.5 * (end.attained + end.bound) };
            match self.feasible(steps, Some(limit))? {
                Answer::Plan(plan) => {
                    let attained = self.soften(steps, &plan)?;
                    if attained >= end.attained {
                        // The limit is within the solver's tolerance of the attained speed.
                        break;
                    }
                    end.attained = attained;
                    step *= 4.0;
                }
                Answer::Refuted => {
                    end.bound = limit;
                    step = self.resolution;
                }
                Answer::Stopped => break,
            }
        }
        Ok(end)
    }

    /// Looks for a plan under a limit.
    fn feasible(&mut self, steps: usize, limit: Option<f64>) -> Result<Answer, Error> {
        let mut scenario = self.scenario.clone();
        scenario.damage.per_hit = limit;
        let mut program = PlanningProgram::build(&scenario, steps, Objective::Feasibility)?;
        match tighten(&mut scenario.reach_sets()?, &mut program, &self.token)? {
            true => self.solve(&program),
            false => Ok(Answer::Refuted),
        }
    }

    /// The smallest possible largest impact speed with the contacts of a plan, in m/s.
    fn soften(&mut self, steps: usize, plan: &Trajectory) -> Result<f64, Error> {
        let mut program = PlanningProgram::build(&self.scenario, steps, Objective::LargestDamage)?;
        for (zeta, &contact) in program.contact.iter().flatten().zip(&plan.contact) {
            program.model.fix(zeta, f64::from(u8::from(contact)))?;
        }
        let found = plan.largest_damage();
        Ok(match self.solve(&program)? {
            Answer::Plan(softer) => softer.largest_damage().min(found),
            // The original plan is feasible here, so keep it.
            Answer::Refuted | Answer::Stopped => found,
        })
    }

    fn solve(&mut self, program: &PlanningProgram) -> Result<Answer, Error> {
        if let Some(reason) = self.token.ended() {
            self.stopped = Some(reason);
            return Ok(Answer::Stopped);
        }
        let solution = self.token.solve(self.solver, &program.model, &mut |_| {})?;
        self.solves += 1;
        self.nodes += solution.statistics().nodes;
        Ok(match outcome(&self.scenario, program, &solution)? {
            PlanOutcome::Planned(plan) => Answer::Plan(plan.trajectory),
            PlanOutcome::Infeasible(_) => Answer::Refuted,
            PlanOutcome::Stopped { reason, .. } => {
                self.stopped = Some(reason);
                Answer::Stopped
            }
        })
    }
}
