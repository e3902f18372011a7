//! The shortest run of a hybrid system, from its statement alone.

use std::borrow::{Borrow, BorrowMut};
use std::fmt;

use super::options::ShortestOptions;
use super::outcome::ShortestHorizon;
use super::search::shortest_horizon;
use super::{HorizonModel, Waiting};
use crate::error::Error;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::hybrid::costs::When;
use crate::hybrid::horizon::Horizon;
use crate::hybrid::reach::{HorizonVariables, ReachSets, SetOptions};
use crate::hybrid::rows::{HybridProgram, HybridRun};
use crate::hybrid::simulate::RunCertificate;
use crate::hybrid::system::{HybridSystem, Region};
use crate::model::Model;
use crate::solver::Solver;

/// A model with a hybrid system in it, from a start to a goal.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct RunProgram {
    /// The model.
    pub model: Model,
    /// The system's variables in it.
    pub program: HybridProgram,
}

impl Borrow<Model> for RunProgram {
    fn borrow(&self) -> &Model {
        &self.model
    }
}

impl BorrowMut<Model> for RunProgram {
    fn borrow_mut(&mut self) -> &mut Model {
        &mut self.model
    }
}

/// The outcome of [`HybridSystem::shortest_run`].
#[derive(Debug, Clone)]
#[non_exhaustive]
#[must_use]
pub struct ShortestRun {
    /// Δt of the time-stepped law, in s: what is found and what is refuted is said of it.
    pub time_step: f64,
    /// How the search ended, its horizons, its sets and its attempts.
    pub search: ShortestHorizon<RunProgram>,
    /// Whether waiting is free, and why: whether smaller horizons were refuted by monotonicity or
    /// each separately.
    pub waiting: Waiting,
    /// The run of `search.steps` steps.
    pub run: Option<HybridRun>,
    /// How the run agrees with the system as it is stated, replayed without the program's rows.
    pub certificate: Option<RunCertificate>,
}

impl fmt::Display for ShortestRun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.search.claim(self.time_step, f)
    }
}

impl HybridSystem {
    /// Finds the smallest number of steps in which the system gets from a start to a goal, and
    /// refutes all smaller numbers.
    ///
    /// Rows, [reach sets](crate::hybrid::reach) and the question whether [waiting is
    /// free](HybridSystem::waiting) all come from this statement of the system.
    ///
    /// ```
    /// use carom::hybrid::{HybridSystem, LinearSystem, Region, ShortestOptions, Transition};
    /// use carom::interval::Interval;
    /// use carom::prelude::*;
    ///
    /// let cart = HybridSystem::new()
    ///     .with_state("x", Interval::new(-9.0, 9.0))
    ///     .with_state("v", Interval::new(-9.0, 9.0))
    ///     .with_input("a", Interval::new(-1.0, 1.0))
    ///     .with_transition(Transition::new("roll", LinearSystem::double_integrator(0.1)?));
    /// let (start, goal) = (Region::point([0.0, 0.0]), Region::point([1.0, 0.0]));
    /// let (options, mut solver) = (ShortestOptions::default(), BranchAndBound::default());
    /// let found = cart.shortest_run(&start, &goal, 0.1, &options, &mut solver)?;
    /// assert!(found.search.is_found() && found.waiting.is_free());
    /// assert_eq!(found.search.steps, Some(20));
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Arguments
    ///
    /// * `time_step`: the length of a step in s, for the times of the run. The flows already
    ///   describe whole steps.
    ///
    /// # Errors
    ///
    /// The errors of [`HybridSystem::check`], those of a start or goal that does not fit;
    /// [`ErrorKind::OutOfRange`] for a bad `time_step` or `max_steps`; errors of the solver; those of
    /// [`HybridSystem::certify`] for a run that is not what the system states.
    pub fn shortest_run(
        &self,
        start: &Region,
        goal: &Region,
        time_step: f64,
        options: &ShortestOptions,
        solver: &mut dyn Solver,
    ) -> Result<ShortestRun, Error> {
        let waiting = options.waiting(self.waiting(start, goal)?);
        let task = Task { system: self, start, goal, time_step, waiting };
        let search = shortest_horizon(&task, options, solver)?;
        let (run, certificate) = match (&search.program, &search.solution) {
            (Some(found), Some(solution)) => {
                let (run, certificate) = found.program.certified(solution)?;
                (Some(run), Some(certificate))
            }
            _ => (None, None),
        };
        Ok(ShortestRun { time_step, search, waiting: task.waiting, run, certificate })
    }
}

/// From a start to a goal, in any number of steps.
pub(super) struct Task<'a> {
    pub(super) system: &'a HybridSystem,
    pub(super) start: &'a Region,
    pub(super) goal: &'a Region,
    pub(super) time_step: f64,
    pub(super) waiting: Waiting,
}

impl HorizonModel for Task<'_> {
    type Program = RunProgram;

    fn build(&self, steps: usize) -> Result<RunProgram, Error> {
        let mut model = Model::new("run");
        let program = self.system.write(&mut model, "", &Horizon::new(steps, self.time_step)?)?;
        program.require(&mut model, "start", self.start, When::At(0))?;
        program.require(&mut model, "goal", self.goal, When::At(steps))?;
        Ok(RunProgram { model, program })
    }

    fn waiting(&self) -> Waiting {
        self.waiting.clone()
    }

    fn reach_sets(&self) -> Result<Option<ReachSets>, Error> {
        ReachSets::new(self.system, self.start, self.goal, SetOptions::default()).map(Some)
    }

    fn hybrid<'p>(
        &self,
        program: &'p mut RunProgram,
    ) -> Option<(&'p mut Model, &'p HybridProgram)> {
        Some((&mut program.model, &program.program))
    }

    fn variables(&self, program: &RunProgram) -> HorizonVariables {
        program.program.horizon_variables()
    }
}
