//! Which limits on the damage of one impact make a given horizon the shortest.
//!
//! Let `d(τ)` be the smallest value that the largest impact speed of a plan over τ steps can have
//! (infinite when there is no plan). Where waiting is free, `d` does not grow with τ, and τ is the
//! shortest horizon under the limit `D_max` of equation (19) exactly when
//! `d(τ) <= D_max < d(τ-1)`. Both ends are optimal values of mixed-integer programs, so each comes
//! with a proved bound.

use super::plan::{PlanOutcome, plan};
use super::program::Objective;
use super::scenario::{Collisions, Scenario};
use crate::error::Error;
use crate::solution::Termination;
use crate::solver::Solver;

/// One end of the interval: an optimal value, enclosed.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct End {
    /// No plan over the end's horizon gets below this, in m/s; proved.
    pub bound: f64,
    /// The best plan found gets this far down, in m/s; infinite when it is proved that there is no
    /// plan, or when none was found.
    pub attained: f64,
}

impl End {
    /// Width of the enclosure, in m/s: how exactly the end is known.
    pub fn resolution(&self) -> f64 {
        if self.bound == self.attained { 0.0 } else { self.attained - self.bound }
    }
}

/// The limits on the impact speed for which a horizon is the shortest.
///
/// Every limit in `[lower.attained, upper.bound)` makes it so; none below `lower.bound` or from
/// `upper.attained` on does. Between, the resolution of the ends leaves it open.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DamageInterval {
    /// The horizon τ, in steps.
    pub steps: usize,
    /// The closed lower end, `d(τ)`.
    pub lower: End,
    /// The open upper end, `d(τ-1)`; infinite when τ-1 is infeasible under any limit.
    pub upper: End,
    /// Nodes of both solves.
    pub nodes: u64,
}

impl DamageInterval {
    /// The middle of the limits for which the horizon is certainly the shortest, in m/s; nothing
    /// when there is none, or when they have no upper end.
    pub fn middle(&self) -> Option<f64> {
        let (lower, upper) = (self.lower.attained, self.upper.bound);
        (lower < upper && upper.is_finite()).then(|| 0.5 * (lower + upper))
    }
}

/// Finds the limits on the impact speed for which a horizon is the shortest one.
///
/// The scenario's own per-impact limit is left out; its other limits stay.
///
/// # Arguments
///
/// * `steps`: the horizon τ, at least 2.
///
/// # Errors
///
/// [`Error::Scenario`] when collisions are forbidden or waiting is not free; otherwise as for
/// [`plan`].
pub fn damage_interval(
    scenario: &Scenario,
    steps: usize,
    solver: &mut dyn Solver,
) -> Result<DamageInterval, Error> {
    scenario.check()?;
    let refuse = |reason: &str, mend: &str| {
        Err(Error::Scenario { reason: reason.into(), mend: mend.into() })
    };
    if scenario.collisions == Collisions::Forbidden {
        return refuse("a damage limit means nothing without collisions", "tolerate them");
    }
    if !scenario.waiting().is_free() {
        return refuse(
            "its shortest horizon need not shrink as the damage limit grows, because the vehicle \
             can wait neither at its start nor at its goal",
            "let it start or end at rest",
        );
    }
    let mut open = *scenario;
    open.damage.per_impact = None;
    open.damage.weight = 0.0;
    let mut nodes = 0;
    let lower = end(&open, steps, solver, &mut nodes)?;
    let upper = end(&open, steps.saturating_sub(1), solver, &mut nodes)?;
    Ok(DamageInterval { steps, lower, upper, nodes })
}

/// Encloses `d(steps)`.
fn end(
    scenario: &Scenario,
    steps: usize,
    solver: &mut dyn Solver,
    nodes: &mut u64,
) -> Result<End, Error> {
    let answer = plan(scenario, steps, Objective::LargestDamage, solver)?;
    let (statistics, end) = match &answer {
        PlanOutcome::Planned(plan) => {
            let end = End { bound: plan.bound.max(0.0), attained: plan.objective };
            (plan.statistics, end)
        }
        PlanOutcome::Infeasible(statistics) => {
            (*statistics, End { bound: f64::INFINITY, attained: f64::INFINITY })
        }
        PlanOutcome::Stopped { reason, statistics } => {
            debug_assert!(*reason != Termination::Optimal);
            (*statistics, End { bound: 0.0, attained: f64::INFINITY })
        }
    };
    *nodes += statistics.nodes;
    Ok(end)
}
