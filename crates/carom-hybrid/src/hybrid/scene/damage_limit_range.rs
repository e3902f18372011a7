//! The limits on the damage of one hit for which a given horizon is the shortest.
//!
//! Let `d(τ)` be the smallest possible largest impact speed of a plan over τ steps, in m/s
//! (infinite if there is no plan). If waiting is free, `d` does not increase with τ, and τ is the
//! shortest horizon under a limit on each hit if and only if `d(τ) <= limit < d(τ-1)`.
//!
//! Each end is enclosed between a plan and a refutation. The largest impact speed of a plan is
//! minimised with its hits fixed, which is a linear program. Then a slightly lower limit is tried,
//! which is either refuted or gives a better plan. Minimising the largest damage over the binaries
//! directly gives the same ends but takes many times longer, because relaxations spread one hit
//! over many steps and their bounds are weak.

use web_time::Duration;

use super::plan::ScenePlan;
use super::program::SceneProgram;
use super::rule::{DamageMeasure, DamageRule};
use super::statement::Scene;
use super::system::Stated;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::error::{Error, SceneError};
use crate::setters::setters;
use crate::solution::Termination;
use crate::solver::{Interrupt, Solver, StopToken};

/// Options of [`Scene::damage_limit_range`].
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct DamageLimitOptions {
    /// The resolution of each end, in m/s (`1e-5..=1e3`); default 1e-3. A finer one would be below
    /// the feasibility tolerance.
    pub resolution: f64,
    /// Wall-clock limit of the whole search; default none.
    pub time_limit: Option<Duration>,
    /// Stops the search.
    pub interrupt: Interrupt,
}

impl Default for DamageLimitOptions {
    fn default() -> Self {
        DamageLimitOptions { resolution: 1e-3, time_limit: None, interrupt: Interrupt::new() }
    }
}

impl DamageLimitOptions {
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
pub struct DamageLimitEnd {
    /// The horizon is proved to have no plan under this limit, in m/s. Infinite if it has no plan
    /// under any limit; 0 if nothing is refuted.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_numbers"))]
    pub bound: f64,
    /// Largest impact speed of the best plan found, in m/s; infinite if there is none.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_numbers"))]
    pub attained: f64,
}

impl DamageLimitEnd {
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
pub struct DamageLimitRange {
    /// The horizon τ, in steps.
    pub steps: usize,
    /// The lower end, `d(τ)`.
    pub lower: DamageLimitEnd,
    /// The upper end, `d(τ-1)`; infinite when τ-1 is infeasible under any limit.
    pub upper: DamageLimitEnd,
    /// Why the search ended before both ends were known to the resolution, if it did.
    pub stopped: Option<Termination>,
    /// Number of solves, including those with fixed binaries.
    pub solves: usize,
    /// Nodes over all solves.
    pub nodes: u64,
    /// Wall-clock time.
    pub time: Duration,
}

impl DamageLimitRange {
    /// The middle of the limits for which the horizon is certainly the shortest, in m/s. `None` if
    /// there is no such limit, or if they have no upper end.
    pub fn middle(&self) -> Option<f64> {
        let (lower, upper) = (self.lower.attained, self.upper.bound);
        (lower <= upper && upper.is_finite()).then_some(0.5 * (lower + upper))
    }
}

impl Scene {
    /// Finds the limits on the impact speed of each hit for which a horizon is the shortest one.
    ///
    /// Limits on a hit and prices of the scene's rules are ignored; their other limits apply.
    ///
    /// # Arguments
    ///
    /// * `steps`: the horizon τ.
    ///
    /// # Errors
    ///
    /// [`SceneError::NoDamageLimitRange`] if nothing may be hit or waiting is not free;
    /// [`ErrorKind::OutOfRange`] for a resolution out of its range; otherwise as for
    /// [`program`](Scene::program) and [`SceneProgram::plan`].
    pub fn damage_limit_range(
        &self,
        steps: usize,
        options: &DamageLimitOptions,
        solver: &mut dyn Solver,
    ) -> Result<DamageLimitRange, Error> {
        let mut scene = self.clone();
        for rule in &mut scene.rules {
            (rule.per_hit, rule.price, rule.price_per_hit) = (None, 0.0, 0.0);
        }
        let open = scene.stated()?;
        let no_interval = |reason: String| SceneError::NoDamageLimitRange { reason };
        if !open.contacts.iter().any(|contact| contact.bounces()) {
            let reason = "nothing may be hit, so that a limit means nothing; let bodies bounce";
            return Err(no_interval(reason.into()).into());
        }
        let monotonicity = open.monotonicity()?;
        if !monotonicity.is_monotone() {
            let reason = "its shortest horizon need not shrink as the limit grows, because ";
            return Err(no_interval(format!("{reason}{}", monotonicity.reason())).into());
        }
        if !(1e-5..=1e3).contains(&(options.resolution / open.units.speed())) {
            let (what, words) = ("the resolution (m/s)", "within [1e-5, 1e3]");
            let range = 1e-5 * open.units.speed()..=1e3 * open.units.speed();
            return Err(Error::out_of_range_in_words(what, options.resolution, range, words));
        }
        let token = StopToken::new(options.time_limit, &options.interrupt);
        let resolution = options.resolution;
        let mut search =
            Enclosure { open, resolution, solver, token, stopped: None, solves: 0, nodes: 0 };
        let lower = search.end(steps)?;
        let upper = match steps {
            1 => DamageLimitEnd { bound: f64::INFINITY, attained: f64::INFINITY },
            _ => search.end(steps - 1)?,
        };
        let Enclosure { stopped, solves, nodes, token, .. } = search;
        Ok(DamageLimitRange { steps, lower, upper, stopped, solves, nodes, time: token.elapsed() })
    }
}

/// The search for the ends.
struct Enclosure<'a> {
    /// The scene without a limit on a hit.
    open: Stated,
    resolution: f64,
    solver: &'a mut dyn Solver,
    token: StopToken,
    stopped: Option<Termination>,
    solves: usize,
    nodes: u64,
}

/// The verdict of a solve.
enum Answer {
    Plan(Box<ScenePlan>),
    Refuted,
    Stopped,
}

impl Enclosure<'_> {
    /// Encloses `d(steps)`.
    fn end(&mut self, steps: usize) -> Result<DamageLimitEnd, Error> {
        let mut end = DamageLimitEnd { bound: 0.0, attained: f64::INFINITY };
        match self.feasible(steps, None)? {
            Answer::Plan(plan) => end.attained = self.gentlest(&plan)?,
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
                    let attained = self.gentlest(&plan)?;
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
        let mut scene = self.open.source.clone();
        let rule = DamageRule::new("damage_interval", DamageMeasure::ImpactSpeed);
        scene.rules.extend(limit.map(|most| rule.with_per_hit(most)));
        let stated = scene.stated()?;
        let mut program = stated.program(steps)?;
        // A log takes nothing from sets as given.
        let uses_sets = self.solver.options().proof.is_none();
        match uses_sets && !program.tighten_until(&stated, &self.token)? {
            true => Ok(Answer::Refuted),
            false => self.solve(&program),
        }
    }

    /// The smallest possible largest impact speed with the hits of a plan, in m/s.
    fn gentlest(&mut self, plan: &ScenePlan) -> Result<f64, Error> {
        let mut program = self.open.program(plan.steps())?;
        program.fix_contacts(plan)?;
        let largest = program.largest_impact()?;
        program.minimize(largest)?;
        let found = plan.largest_damage();
        Ok(match self.solve(&program)? {
            Answer::Plan(gentler) => gentler.largest_damage().min(found),
            // The original plan is feasible here, so keep it.
            Answer::Refuted | Answer::Stopped => found,
        })
    }

    fn solve(&mut self, program: &SceneProgram) -> Result<Answer, Error> {
        if let Some(reason) = self.token.ended() {
            self.stopped = Some(reason);
            return Ok(Answer::Stopped);
        }
        let solution = self.token.solve(self.solver, program.model(), &mut |_| {})?;
        self.solves += 1;
        self.nodes += solution.statistics().nodes;
        if solution.point().is_some() {
            let plan = program.plan(&solution)?;
            return Ok(Answer::Plan(Box::new(plan)));
        }
        Ok(match solution.termination() {
            Termination::Infeasible => Answer::Refuted,
            reason => {
                self.stopped = Some(reason);
                Answer::Stopped
            }
        })
    }
}
