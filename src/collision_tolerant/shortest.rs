//! The shortest plan: the smallest feasible horizon, with a proof, and the fewest impacts on it.

use web_time::Duration;

use super::plan::{Plan, PlanOutcome, outcome};
use super::program::{Objective, PlanningProgram};
use super::reach::Programs;
use super::scenario::{Collisions, Scenario};
use crate::error::Error;
use crate::hybrid::program::HybridProgram;
use crate::hybrid::reach::Tube;
use crate::hybrid::{
    Attempt, HorizonEvent, ShortestOptions, ShortestStatus, Solved, shortest_horizon_with,
};
use crate::setters::setters;
use crate::solution::{Solution, Statistics};
use crate::solver::{Solver, StopToken};

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

/// The result of a search for the shortest plan.
#[derive(Debug, Clone)]
#[non_exhaustive]
#[must_use]
pub struct ShortestPlan {
    /// How the search ended.
    pub status: ShortestStatus,
    /// The shortest horizon, in steps; if the search was stopped, the smallest one found feasible.
    pub steps: Option<usize>,
    /// The largest horizon proved infeasible together with every smaller one, in steps.
    pub refuted_steps: Option<usize>,
    /// A plan over `steps`, with the fewest impacts if they were minimised.
    pub plan: Option<Plan>,
    /// Whether it is proved that no plan over `steps` has fewer impacts (with prices of
    /// damage: a smaller sum of impacts and prices).
    pub fewest_impacts: bool,
    /// The tube of `steps`, if reach sets were used: what any plan of that horizon can do at each
    /// step.
    pub tube: Option<Tube>,
    /// The horizons that the search decided, in order, and how.
    pub attempts: Vec<Attempt>,
    /// The subsequent solves that minimised the impacts.
    pub refinements: Vec<Statistics>,
    /// Wall-clock time of the search and of all solves.
    pub time: Duration,
}

impl ShortestPlan {
    /// Whether the shortest horizon was found and proved.
    pub fn is_found(&self) -> bool {
        self.status == ShortestStatus::Found
    }

    /// Nodes over all solves.
    pub fn nodes(&self) -> u64 {
        self.statistics().map(|s| s.nodes).sum()
    }

    /// Relaxations over all solves.
    pub fn relaxations(&self) -> u64 {
        self.statistics().map(|s| s.relaxations).sum()
    }

    fn statistics(&self) -> impl Iterator<Item = &Statistics> {
        self.attempts.iter().map(|attempt| &attempt.statistics).chain(&self.refinements)
    }
}

/// Finds the shortest plan of a scenario and proves that it is the shortest.
///
/// ```
/// use carom::collision_tolerant::{PlanningOptions, Scenario, shortest_plan};
/// use carom::prelude::*;
///
/// let scenario = Scenario::paper().with_time_step(0.05);
/// let mut solver = BranchAndBound::default();
/// let careful = shortest_plan(&scenario.clone().collision_free(), &PlanningOptions::default(), &mut solver)?;
/// let tolerant = shortest_plan(&scenario, &PlanningOptions::default(), &mut solver)?;
/// assert!(tolerant.is_found() && tolerant.steps < careful.steps);
/// # Ok::<(), carom::Error>(())
/// ```
///
/// # Errors
///
/// As for [`plan`](super::plan()); [`ErrorKind::OutOfRange`](crate::ErrorKind::OutOfRange) for bad
/// options.
pub fn shortest_plan(
    scenario: &Scenario,
    options: &PlanningOptions,
    solver: &mut dyn Solver,
) -> Result<ShortestPlan, Error> {
    shortest_plan_with(scenario, options, solver, &mut |_| {})
}

/// Same as [`shortest_plan`], with progress events on the calling thread.
///
/// # Errors
///
/// As for [`shortest_plan`].
pub fn shortest_plan_with(
    scenario: &Scenario,
    options: &PlanningOptions,
    solver: &mut dyn Solver,
    progress: &mut dyn FnMut(&HorizonEvent),
) -> Result<ShortestPlan, Error> {
    scenario.check()?;
    let token = StopToken::new(options.search.time_limit, &options.search.interrupt);
    let programs = Programs { scenario: scenario.clone(), upper_hint: options.upper_hint };
    let found = shortest_horizon_with(&programs, &options.search, solver, progress)?;
    let certify = |solved: Solved<_>| Plan::certify(scenario, &solved.program, &solved.solution);
    let found = found.try_map(certify)?;
    let mut shortest = ShortestPlan {
        status: found.status,
        steps: found.steps,
        refuted_steps: found.refuted_steps,
        plan: found.plan,
        fewest_impacts: scenario.collisions == Collisions::Forbidden,
        tube: found.tube,
        attempts: found.attempts,
        refinements: Vec::new(),
        time: found.time,
    };
    if options.fewest_impacts && shortest.is_found() && !shortest.fewest_impacts {
        Refinement { scenario, solver, token: &token, options: &options.search }
            .run(&mut shortest)?;
    }
    shortest.time = token.elapsed();
    Ok(shortest)
}

/// Minimises the impacts of a plan on its proved horizon.
struct Refinement<'a> {
    scenario: &'a Scenario,
    solver: &'a mut dyn Solver,
    token: &'a StopToken,
    options: &'a ShortestOptions,
}

impl Refinement<'_> {
    fn run(&mut self, shortest: &mut ShortestPlan) -> Result<(), Error> {
        let (Some(steps), Some(plan)) = (shortest.steps, &shortest.plan) else { return Ok(()) };
        let impacts = plan.trajectory.impacts.len();
        let proved = shortest.tube.as_ref().and_then(Tube::fewest_events).unwrap_or(0);
        if impacts == 0 || (impacts <= proved && !self.scenario.damage.has_price()) {
            shortest.fewest_impacts = true;
            return Ok(());
        }
        // Without any impact?
        let mut needed = proved > 0;
        // Rows of one's own may speak of contacts, which the careful scenario does not have.
        if !needed && !self.options.has_statements() {
            let careful = self.scenario.clone().collision_free();
            let program = PlanningProgram::build(&careful, steps, Objective::Feasibility)?;
            let Some(solution) = self.solve(&program)? else { return Ok(()) };
            shortest.refinements.push(*solution.statistics());
            needed = match outcome(&careful, &program, &solution)? {
                PlanOutcome::Planned(plan) => {
                    shortest.plan = Some(*plan);
                    shortest.fewest_impacts = true;
                    return Ok(());
                }
                answer => answer.is_infeasible(),
            };
        }
        if needed && impacts == 1 && !self.scenario.damage.has_price() {
            shortest.fewest_impacts = true;
            return Ok(());
        }
        // As few as possible.
        let mut program = PlanningProgram::build(self.scenario, steps, Objective::Impacts)?;
        let mut stated = Ok(());
        HybridProgram::lend(&mut program.model, &program.hybrid, &mut |hybrid| {
            stated = self.options.complete(hybrid);
        });
        stated?;
        if needed {
            program.require_contact()?;
        }
        if let Some(tube) = &shortest.tube {
            let variables = program.hybrid.horizon_variables();
            let _report = tube.tighten(&mut program.model, &variables)?;
        }
        let Some(solution) = self.solve(&program)? else { return Ok(()) };
        shortest.refinements.push(*solution.statistics());
        if let PlanOutcome::Planned(plan) = outcome(self.scenario, &program, &solution)? {
            shortest.fewest_impacts = solution.is_optimal();
            shortest.plan = Some(*plan);
        }
        Ok(())
    }

    /// Solves within the remaining time of the search; `None` if there is none.
    fn solve(&mut self, program: &PlanningProgram) -> Result<Option<Solution>, Error> {
        if self.token.is_over() {
            return Ok(None);
        }
        self.token.solve(self.solver, &program.model, &mut |_| {}).map(Some)
    }
}

/// The shortest plans of a task without and with collisions.
#[derive(Debug, Clone)]
#[non_exhaustive]
#[must_use]
pub struct PlanComparison {
    /// Collisions forbidden.
    pub free: ShortestPlan,
    /// Collisions tolerated.
    pub tolerant: ShortestPlan,
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

/// Finds the shortest plans of a scenario without and with collisions. The first is a hint for the
/// second.
///
/// # Errors
///
/// As for [`shortest_plan`].
pub fn compare(
    scenario: &Scenario,
    options: &PlanningOptions,
    solver: &mut dyn Solver,
) -> Result<PlanComparison, Error> {
    let free = shortest_plan(&scenario.clone().collision_free(), options, solver)?;
    let mut options = options.clone();
    options.upper_hint = free.steps.or(options.upper_hint);
    let tolerant = shortest_plan(
        &Scenario { collisions: Collisions::Tolerated, ..scenario.clone() },
        &options,
        solver,
    )?;
    Ok(PlanComparison { free, tolerant })
}
