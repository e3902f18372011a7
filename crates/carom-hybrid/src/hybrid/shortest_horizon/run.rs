//! The shortest plan of a hybrid system, from its statement alone.

use super::logged::shortest_horizon;
use super::options::ShortestOptions;
use super::outcome::{ShortestHorizon, SolvedHorizon};
use super::{HorizonModel, Monotonicity};
use crate::error::Error;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::hybrid::program::{HybridPlan, HybridProgram, When};
use crate::hybrid::reach::{ReachSets, SetOptions};
use crate::hybrid::system::{Discretization, HybridSystem, IntoRegion, Region, outside_domain};
use crate::solver::Solver;

impl HybridSystem {
    /// Finds the smallest number of steps in which the system gets from a start to a goal, and
    /// refutes all smaller numbers.
    ///
    /// Rows, [reach sets](crate::hybrid::reach) and the question whether waiting is free all come
    /// from this statement of the system.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let mut cart = HybridSystem::new(0.1); // s
    /// let x = cart.state("x", -9.0, 9.0)?; // m
    /// let v = cart.state("v", -9.0, 9.0)?; // m/s
    /// let a = cart.input("a", -1.0, 1.0)?; // m/s²
    /// cart.mode("roll")?.rates([x.is(v), v.is(a)])?;
    /// let (start, goal) = ([x.equals(0.0), v.equals(0.0)], [x.equals(1.0), v.equals(0.0)]);
    /// let found = cart.shortest(start, goal, &mut BranchAndBound::default())?;
    /// assert!(found.is_found() && found.monotonicity.is_monotone());
    /// assert_eq!(
    ///     found.to_string(),
    ///     "20 steps at least, 2 s: fewer are refuted for the time-stepped law with Δt = 0.1 s"
    /// );
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Arguments
    ///
    /// * `start`, `goal`: rows of states and modes, or [regions](HybridSystem::region).
    ///
    /// # Errors
    ///
    /// The errors of [`HybridSystem::check`] and of [`HybridSystem::region`];
    /// [`ErrorKind::OutOfRange`] for a start or a goal outside the domains; errors of the solver;
    /// those of [`HybridSystem::certify`] for a plan that is not what the system states.
    #[doc(alias("minimum time", "time-optimal"))]
    pub fn shortest(
        &self,
        start: impl IntoRegion,
        goal: impl IntoRegion,
        solver: &mut dyn Solver,
    ) -> Result<ShortestHorizon<HybridPlan>, Error> {
        self.shortest_with(start, goal, &ShortestOptions::default(), solver)
    }

    /// As [`shortest`](HybridSystem::shortest), with limits, windows and rows of your own.
    ///
    /// # Errors
    ///
    /// Those of [`shortest`](HybridSystem::shortest); [`ErrorKind::OutOfRange`] for a bad
    /// `max_steps`.
    pub fn shortest_with(
        &self,
        start: impl IntoRegion,
        goal: impl IntoRegion,
        options: &ShortestOptions,
        solver: &mut dyn Solver,
    ) -> Result<ShortestHorizon<HybridPlan>, Error> {
        let (start, goal) = (&start.stated().of(self)?, &goal.stated().of(self)?);
        let task = self.task(start, goal, options)?;
        let found = shortest_horizon(&task, options, solver)?;
        found.try_map(|SolvedHorizon { program, solution }| program.plan(&solution))
    }
}

impl HybridSystem {
    /// The programs from a start to a goal.
    pub(in crate::hybrid) fn task<'a>(
        &'a self,
        start: &'a Region,
        goal: &'a Region,
        options: &ShortestOptions,
    ) -> Result<Task<'a>, Error> {
        self.check_reachable(start, "the start")?;
        self.check_reachable(goal, "the goal")?;
        let monotonicity = options.monotonicity(self.monotonicity(start, goal)?);
        Ok(Task { system: self, start, goal, monotonicity })
    }

    /// Refuses a region outside the domains of the states.
    fn check_reachable(&self, region: &Region, what: &str) -> Result<(), Error> {
        region.check(self, "the region")?;
        for ((name, domain), range) in self.states.iter().zip(&region.ranges) {
            if domain.intersection(*range).is_empty() {
                let value = range.nearest(0.5 * (domain.lower + domain.upper));
                return Err(outside_domain(what, name, value, *domain));
            }
        }
        Ok(())
    }
}

/// From a start to a goal, in any number of steps.
pub(in crate::hybrid) struct Task<'a> {
    pub(super) system: &'a HybridSystem,
    pub(super) start: &'a Region,
    pub(super) goal: &'a Region,
    pub(super) monotonicity: Monotonicity,
}

impl HorizonModel for Task<'_> {
    type Program = HybridProgram;

    fn build(&self, steps: usize) -> Result<HybridProgram, Error> {
        let mut program = self.system.program(steps)?;
        program.require("start", self.start, When::At(0))?;
        program.require("goal", self.goal, When::At(steps))?;
        Ok(program)
    }

    fn monotonicity(&self) -> Monotonicity {
        self.monotonicity.clone()
    }

    fn time_step(&self) -> Option<f64> {
        Some(self.system.time_step)
    }

    fn discretization(&self) -> Option<Discretization> {
        self.system.discretized_by()
    }

    fn reach_sets(&self) -> Result<Option<ReachSets>, Error> {
        ReachSets::new(self.system, self.start, self.goal, SetOptions::default()).map(Some)
    }

    fn ends(&self) -> Result<Option<(HybridSystem, Region, Region)>, Error> {
        Ok(Some((self.system.clone(), self.start.clone(), self.goal.clone())))
    }

    fn with_hybrid(
        &self,
        program: &mut HybridProgram,
        statements: &mut dyn FnMut(&mut HybridProgram),
    ) {
        statements(program);
    }
}
