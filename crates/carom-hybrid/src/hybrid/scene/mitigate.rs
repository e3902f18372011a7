//! Collisions that cannot be avoided; objectives in turn.

use super::plan::ScenePlan;
use super::program::SceneProgram;
use super::statement::Scene;
use super::surface::Surface;
use crate::error::Error;
use crate::hybrid::reach::ReachExplanation;
use crate::model::{Affine, Quadratic};
use crate::solution::{Solution, Termination};
use crate::solver::Solver;
use crate::tolerance::FEASIBILITY;

/// Whether hits can be avoided.
#[derive(Debug, Clone)]
#[non_exhaustive]
#[must_use]
pub enum Avoidable {
    /// Yes, by this plan.
    Yes(Box<ScenePlan>),
    /// No; this is proved. The explanation is there if sets prove it.
    No(Option<Box<ReachExplanation>>),
    /// Neither found nor refuted before the solver stopped.
    Unknown(Termination),
}

/// The plan of least damage.
#[derive(Debug, Clone)]
#[non_exhaustive]
#[must_use]
pub struct Mitigation {
    /// The plan; `None` if there is none, or none was found.
    pub plan: Option<ScenePlan>,
    /// The largest damage of a hit of the plan, in m/s; 0 without hits.
    pub largest: f64,
    /// A proved lower bound of it over all plans, in m/s.
    pub bound: f64,
    /// How the solve for the largest damage ended; [`Termination::Optimal`] if it is proved least.
    pub termination: Termination,
}

impl Scene {
    /// Whether the bodies can get through a number of steps without a hit: to their goals, or
    /// anywhere if they have none. Every surface is avoided, whatever may be done at it.
    ///
    /// ```
    /// use carom::hybrid::scene::{Avoidable, Body, Scene, Solid, Surface};
    /// use carom::hybrid::Restitution;
    /// use carom::prelude::*;
    ///
    /// // One metre before a wall at 4 m/s, with brakes of 6 m/s².
    /// let car = Body::new("car", [0.0..=9.0], 9.0, 6.0)
    ///     .with_start([1.0, -4.0]);
    /// let wall = Surface::bounce(Restitution::new(0.2)?);
    /// let scene = Scene::new(0.05)
    ///     .with_body(car)
    ///     .with_obstacle(Solid::halfspace("wall", [1.0], 0.0, wall));
    /// let mut solver = BranchAndBound::default();
    /// assert!(matches!(scene.avoidable(20, &mut solver)?, Avoidable::No(_)));
    /// let crash = scene.mitigate(20, &mut solver)?;
    /// // Full brakes: the impact is at √(16 - 12) = 2 m/s. Counted is the faster end of its step.
    /// assert!(crash.largest >= 2.0 && crash.largest < 2.3);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Arguments
    ///
    /// * `steps`: the horizon τ.
    ///
    /// # Errors
    ///
    /// Those of [`Scene::program`], of the solver, and of [`SceneProgram::plan`].
    pub fn avoidable(&self, steps: usize, solver: &mut dyn Solver) -> Result<Avoidable, Error> {
        let mut cautious = self.clone();
        for face in cautious.obstacles.iter_mut().flat_map(|obstacle| &mut obstacle.faces) {
            face.surface = Surface::avoid();
        }
        cautious.pairs.iter_mut().for_each(|pair| pair.surface = Surface::avoid());
        cautious.rules.clear();
        let stated = cautious.stated()?;
        let mut program = stated.program(steps)?;
        // A log takes nothing from sets as given.
        if solver.options().proof.is_none() && !program.tighten_by_sets(&stated)? {
            return Ok(Avoidable::No(stated.sets()?.explain(steps)?.map(Box::new)));
        }
        let solution = solver.solve(program.model())?;
        Ok(match solution.termination() {
            _ if solution.point().is_some() => Avoidable::Yes(Box::new(program.plan(&solution)?)),
            Termination::Infeasible => Avoidable::No(None),
            other => Avoidable::Unknown(other),
        })
    }

    /// The plan of least damage over a number of steps: to the goals, or anywhere without them.
    /// First the largest damage of a hit is minimised, and then, without making it larger, the sum
    /// of the prices of the rules, or without prices the number of hits.
    ///
    /// # Errors
    ///
    /// As for [`avoidable`](Scene::avoidable).
    pub fn mitigate(&self, steps: usize, solver: &mut dyn Solver) -> Result<Mitigation, Error> {
        let mut program = match solver.options().proof.is_some() {
            true => self.plain_program(steps)?,
            false => self.program(steps)?,
        };
        let price = program.price();
        let next = if price.terms().is_empty() { program.hits() } else { price };
        let largest = program.largest_impact()?;
        program.minimize(largest.clone())?;
        let first = solver.solve(program.model())?;
        let mut found = Mitigation {
            plan: None,
            largest: f64::INFINITY,
            bound: first.bound(),
            termination: first.termination(),
        };
        let Some(least) = first.objective() else { return Ok(found) };
        let unit = program.units.speed();
        program.add("least_damage", (1.0 / unit * largest).le(kept(least / unit)))?;
        program.minimize(next)?;
        let second = solver.solve(program.model())?;
        let solution: &Solution = if second.point().is_some() { &second } else { &first };
        let plan = program.plan(solution)?;
        found.largest = plan.largest_damage();
        found.plan = Some(plan);
        Ok(found)
    }
}

impl SceneProgram {
    /// Minimises objectives in turn: each without making those before it worse. The solution is
    /// that of the last one, or of the first one that is not proved optimal.
    ///
    /// To have the least damage first, and the least time with it, ask for the damage of each
    /// horizon that [`Scene::shortest`] leaves open, from the shortest one on.
    ///
    /// ```
    /// use carom::hybrid::scene::{Body, Scene, Solid, Surface};
    /// use carom::hybrid::Restitution;
    /// use carom::prelude::*;
    ///
    /// let car = Body::new("car", [0.0..=9.0], 9.0, 6.0)
    ///     .with_start([1.0, -4.0]);
    /// let wall = Surface::bounce(Restitution::new(0.2)?);
    /// let scene = Scene::new(0.05)
    ///     .with_body(car)
    ///     .with_obstacle(Solid::halfspace("wall", [1.0], 0.0, wall));
    /// let mut program = scene.program(12)?;
    /// let (damage, hits, effort) = (program.largest_impact()?, program.hits(), program.effort()?);
    /// let mut solver = BranchAndBound::default();
    /// let solution = program.minimize_in_turn(&[damage.into(), hits], effort, &mut solver)?;
    /// assert_eq!(program.plan(&solution)?.hits.len(), 1);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Arguments
    ///
    /// * `first`: the linear objectives, the most important one first. Each is kept to a relative
    ///   and absolute [`FEASIBILITY`].
    /// * `last`: the last objective.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::DuplicateName`](crate::error::ErrorKind::DuplicateName) at the second call with
    /// several objectives; those of the solver.
    pub fn minimize_in_turn(
        &mut self,
        first: &[Affine],
        last: impl Into<Quadratic>,
        solver: &mut dyn Solver,
    ) -> Result<Solution, Error> {
        for (k, objective) in first.iter().enumerate() {
            self.minimize(objective.clone())?;
            let solution = solver.solve(self.model())?;
            let Some(least) = solution.objective().filter(|_| solution.is_optimal()) else {
                return Ok(solution);
            };
            self.add(("in_turn", k), objective.clone().le(kept(least)))?;
        }
        self.minimize(last.into())?;
        solver.solve(self.model())
    }
}

/// The largest value that a later objective may give an earlier one, from the least value of that
/// one.
fn kept(least: f64) -> f64 {
    least + FEASIBILITY * (1.0 + least.abs())
}
