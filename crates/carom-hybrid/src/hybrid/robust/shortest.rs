//! The smallest number of steps after which every disturbed run is at the goal.

use super::feedback::Feedback;
use super::plan::RobustPlan;
use super::program::RobustProgram;
use crate::error::Error;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::hybrid::program::HybridProgram;
use crate::hybrid::reach::{HorizonVariables, ReachSets};
use crate::hybrid::shortest_horizon::{
    HorizonModel, Monotonicity, ShortestHorizon, ShortestOptions, SolvedHorizon, shortest_horizon,
};
use crate::hybrid::system::{HybridSystem, IntoRegion, Region};
use crate::solution::Solution;
use crate::solver::Solver;

impl HybridSystem {
    /// Finds the smallest number of steps for which there is a plan that brings every disturbed run
    /// from a start to a goal, if the feedback corrects the inputs, and refutes all smaller
    /// numbers: as [`shortest_with`](HybridSystem::shortest_with), of
    /// [robust](HybridProgram::robust) programs.
    ///
    /// A number is refuted for tubes of this feedback; another feedback may need fewer steps.
    ///
    /// ```
    /// use carom::hybrid::Feedback;
    /// use carom::prelude::*;
    ///
    /// let mut cart = HybridSystem::new(1.0); // s
    /// let x = cart.state("x", 0.0, 9.0)?; // m
    /// let u = cart.input("u", -1.0, 1.0)?; // m
    /// cart.disturbance(x, -0.2, 0.2)?;
    /// cart.mode("roll")?.next([x.is(x + u)])?;
    /// let (start, goal) = ([x.equals(0.0)], [x.within(2.6, 3.2)]);
    /// let (options, mut solver) = (ShortestOptions::default(), BranchAndBound::default());
    /// assert_eq!(cart.shortest(start.clone(), goal.clone(), &mut solver)?.steps, Some(3));
    /// // The feedback takes a fifth of each input.
    /// let feedback = Feedback::new(&cart, [[-1.0]])?;
    /// let found = cart.shortest_robust(start, goal, &feedback, &options, &mut solver)?;
    /// assert_eq!(found.steps, Some(4));
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Those of [`shortest_with`](HybridSystem::shortest_with) and of
    /// [`robust`](HybridProgram::robust), such as for a goal that is a single point.
    pub fn shortest_robust(
        &self,
        start: impl IntoRegion,
        goal: impl IntoRegion,
        feedback: &Feedback,
        options: &ShortestOptions,
        solver: &mut dyn Solver,
    ) -> Result<ShortestHorizon<RobustPlan>, Error> {
        let (start, goal) = (start.stated().of(self)?, goal.stated().of(self)?);
        let task = self.task(&start, &goal, options)?;
        shortest_robust(&task, self, feedback, options, solver)
    }
}

/// The shortest robust plan of programs of a system.
pub(crate) fn shortest_robust<M: HorizonModel<Program: Into<HybridProgram>>>(
    nominal: &M,
    system: &HybridSystem,
    feedback: &Feedback,
    options: &ShortestOptions,
    solver: &mut dyn Solver,
) -> Result<ShortestHorizon<RobustPlan>, Error> {
    let monotonicity = match options.monotonicity(nominal.monotonicity()) {
        Monotonicity::Monotone(_) if system.is_disturbed() => {
            Monotonicity::NotMonotone("disturbances add up while a run waits".into())
        }
        own => own,
    };
    let task = RobustTask { nominal, feedback, options, monotonicity };
    let found = shortest_horizon(&task, &options.without_statements(), solver)?;
    found.try_map(|SolvedHorizon { program, solution }| program.plan(&solution))
}

/// The robust programs of a family of programs.
struct RobustTask<'a, M> {
    nominal: &'a M,
    feedback: &'a Feedback,
    /// With the statements that are tightened as well.
    options: &'a ShortestOptions,
    monotonicity: Monotonicity,
}

impl<M: HorizonModel<Program: Into<HybridProgram>>> HorizonModel for RobustTask<'_, M> {
    type Program = RobustProgram;

    fn build(&self, steps: usize) -> Result<RobustProgram, Error> {
        let mut program: HybridProgram = self.nominal.build(steps)?.into();
        self.options.complete(&mut program)?;
        program.robust(self.feedback)
    }

    fn monotonicity(&self) -> Monotonicity {
        self.monotonicity.clone()
    }

    /// Those of nominal runs: the plan of a robust program is one.
    fn reach_sets(&self) -> Result<Option<ReachSets>, Error> {
        self.nominal.reach_sets()
    }

    fn time_step(&self) -> Option<f64> {
        self.nominal.time_step()
    }

    /// Of nominal runs: before the first step nothing has disturbed one.
    fn ends(&self) -> Result<Option<(HybridSystem, Region, Region)>, Error> {
        match self.options.has_statements() {
            true => Ok(None),
            false => self.nominal.ends(),
        }
    }

    fn hints(&self) -> Vec<String> {
        self.nominal.hints()
    }

    fn takes_any_point(&self) -> bool {
        self.nominal.takes_any_point()
    }

    fn settled(
        &self,
        program: &mut RobustProgram,
        solution: Solution,
        solver: &mut dyn Solver,
    ) -> Result<Solution, Error> {
        Ok(program.program.settled(&solution, Some(solver))?.into_owned())
    }

    fn variables(&self, program: &mut RobustProgram) -> HorizonVariables {
        program.program.systems.first().horizon_variables()
    }
}
