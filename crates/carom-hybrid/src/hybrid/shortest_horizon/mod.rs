#![doc = include_str!("../../../docs/shortest_horizon.md")]

mod at_goal;
mod event;
mod guess;
mod logged;
mod look;
mod options;
mod outcome;
mod proofs;
mod rest;
mod run;
mod search;
mod statements;
mod time_step;
mod watch;

pub use event::HorizonEvent;
pub use logged::shortest_horizon;
pub use options::ShortestOptions;
pub use outcome::{
    HorizonAttempt, HorizonProof, HorizonRefutation, HorizonVerdict, ShortestHorizon,
    ShortestStatus, SolvedHorizon,
};
pub use time_step::{LeastTimeStep, TimeStepGrid, least_time_step};
pub(crate) use time_step::{decide, least_of};

use std::borrow::Cow;

use crate::error::Error;
use crate::hybrid::program::HybridProgram;
use crate::hybrid::reach::{HorizonVariables, ReachSets};
use crate::hybrid::system::{Discretization, HybridSystem, Region};
use crate::model::Model;
use crate::solution::Solution;
use crate::solver::Solver;

/// A family of programs, one for each number of steps.
pub trait HorizonModel {
    /// The program of a horizon: a [`Model`], or a type that contains one together with its
    /// handles.
    type Program: AsRef<Model> + AsMut<Model>;

    /// Builds the program of a horizon.
    ///
    /// # Arguments
    ///
    /// * `steps`: τ, at least 1 and at most
    ///   [`tolerance::MAX_STEPS`](crate::tolerance::MAX_STEPS).
    ///
    /// # Errors
    ///
    /// Any error of building ends the search.
    fn build(&self, steps: usize) -> Result<Self::Program, Error>;

    /// Whether a feasible horizon makes every longer one feasible.
    fn monotonicity(&self) -> Monotonicity;

    /// The number of steps at which to begin, at least 1. A good guess saves solves; a bad one only
    /// costs time. Used only if waiting is free.
    fn lower_hint(&self) -> usize {
        1
    }

    /// Reach sets of the system that the programs describe, with the same start and goal; `None` by
    /// default.
    ///
    /// They refute most horizons before a program is built. Every solution of a program must be a
    /// run of the system.
    ///
    /// # Errors
    ///
    /// Any error of building them ends the search.
    fn reach_sets(&self) -> Result<Option<ReachSets>, Error> {
        Ok(None)
    }

    /// The program's variables for states and transitions: sets tighten both, and a coarser plan
    /// suggests the transitions. By default those of the [hybrid program](Self::with_hybrid).
    #[doc(hidden)]
    fn variables(&self, program: &mut Self::Program) -> HorizonVariables {
        let mut found = HorizonVariables::default();
        self.with_hybrid(program, &mut |hybrid| found = hybrid.variables().horizon_variables());
        found
    }

    /// Whether the objective only guides the search: the first point of a horizon is enough.
    #[doc(hidden)]
    fn takes_any_point(&self) -> bool {
        false
    }

    /// The solution whose states are the run of its inputs: the same one, or a corrected one. By
    /// default that of the [hybrid program](Self::with_hybrid).
    ///
    /// # Errors
    ///
    /// A [`RunError::Drift`](crate::hybrid::RunError::Drift) if there is none leaves the horizon
    /// open; any other error ends the search.
    #[doc(hidden)]
    fn settled(
        &self,
        program: &mut Self::Program,
        solution: Solution,
        solver: &mut dyn Solver,
    ) -> Result<Solution, Error> {
        let mut found = None;
        self.with_hybrid(program, &mut |hybrid| {
            found = Some(hybrid.settled(&solution, Some(&mut *solver)).map(Cow::into_owned));
        });
        found.unwrap_or(Ok(solution))
    }

    /// Δt of the programs, in s, for the words of the result; `None` by default.
    fn time_step(&self) -> Option<f64> {
        None
    }

    /// The method that makes steps of nonlinear rates, for the words of the result; `None` by
    /// default, for linear ones.
    fn discretization(&self) -> Option<Discretization> {
        None
    }

    /// The system with its start and its goal, to see whether no step is needed; `None` by default.
    ///
    /// # Errors
    ///
    /// Any error of building them ends the search.
    fn ends(&self) -> Result<Option<(HybridSystem, Region, Region)>, Error> {
        Ok(None)
    }

    /// Hints if there is no plan, in words; none by default.
    #[doc(hidden)]
    fn hints(&self) -> Vec<String> {
        Vec::new()
    }

    /// Hands a program with a hybrid system to `statements`, if there is one. The search then adds
    /// the [windows](ShortestOptions::with_window) and [rows](ShortestOptions::with_rows) of the
    /// options to it, tightens it by sets, and corrects plans that are not the runs of their
    /// inputs. By default it is not handed over, and such options are refused.
    fn with_hybrid(
        &self,
        program: &mut Self::Program,
        statements: &mut dyn FnMut(&mut HybridProgram),
    ) {
        let _ = (program, statements);
    }

    /// The same task on a coarser grid, if there is one. Its shortest plan suggests at which steps
    /// the binaries of transitions may be needed. A good guess saves most of a search; a bad one
    /// only costs time. `None` by default.
    fn coarser(&self) -> Option<Box<dyn HorizonModel<Program = Self::Program> + '_>> {
        None
    }
}

/// Whether waiting is free, with the reason as text.
///
/// Waiting is free if every plan of τ steps can be extended to τ+1: the vehicle can hold still at
/// its start or at its goal, there is no running cost, and no limit, window or obstacle depends on
/// the step.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Monotonicity {
    /// Feasibility is monotone in the horizon, so bisection is valid.
    Monotone(String),
    /// Feasibility may not be monotone, so every smaller horizon must be refuted.
    NotMonotone(String),
}

impl Monotonicity {
    /// Whether bisection is valid.
    pub fn is_monotone(&self) -> bool {
        matches!(self, Monotonicity::Monotone(_))
    }

    /// The reason.
    pub fn reason(&self) -> &str {
        match self {
            Monotonicity::Monotone(reason) | Monotonicity::NotMonotone(reason) => reason,
        }
    }
}
