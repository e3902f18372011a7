//! Programs in which only the first steps have whole integers.

use std::sync::Arc;

use super::HybridProgram;
use crate::error::{Error, ErrorKind};
use crate::model::Variable;

impl HybridProgram {
    /// Decides transitions, modes and listed values of inputs in the first steps only: from step
    /// `steps` on, they may be mixtures.
    ///
    /// A controller applies the first move of a plan, and what it decides far ahead matters little
    /// but costs most of the search. The bound of a solve is still a bound on the cost of every
    /// plan, because a plan is a mixture, too. What comes out is no plan beyond these steps:
    /// [`plan`](HybridProgram::plan) refuses it, and a
    /// [`RecedingHorizon`](crate::hybrid::RecedingHorizon) plans the first steps, simulates them,
    /// and calls the source of its move
    /// [`IntegerHorizon`](crate::hybrid::MoveSource::IntegerHorizon).
    /// [`Solution::relaxed`](crate::solution::Solution::relaxed) tells the variables. Binaries that
    /// missions and rows of your own add stay whole. D. Axehill, L. Vandenberghe and A. Hansson
    /// compare such relaxations (Convex relaxations for mixed integer predictive control,
    /// Automatica 46, 2010).
    ///
    /// ```
    /// use carom::hybrid::MoveSource;
    /// use carom::prelude::*;
    ///
    /// // A room that a heater warms.
    /// let mut room = HybridSystem::new(600.0); // s
    /// let t = room.state("t", 5.0, 30.0)?; // °C
    /// room.mode_of("heater", "off")?.next([t.is(t - 0.5)])?;
    /// room.mode_of("heater", "on")?.next([t.is(t + 0.75)])?;
    /// let mut program = room.program(12)?;
    /// program.minimize(program.sum((t - 20.0).square())?)?;
    /// program.set_integer_horizon(3)?;
    /// let mut solver = BranchAndBound::default();
    /// let mut controller = RecedingHorizon::new(program, &mut solver)?;
    /// let next = controller.step(&[18.0])?;
    /// assert_eq!(next.source, MoveSource::IntegerHorizon);
    /// assert_eq!(next.transition("heater"), Some("on"));
    /// assert_eq!(next.states.len(), 4);
    /// assert!(next.objective.is_none() && next.bound.is_some());
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`] for a number of steps that is not from 1 to that of the program,
    /// and for more steps than at an earlier call.
    #[doc(alias("move blocking", "relaxed tail"))]
    pub fn set_integer_horizon(&mut self, steps: usize) -> Result<(), Error> {
        let most = self.systems.integer_steps.unwrap_or(self.systems.steps);
        if steps == 0 || steps > most {
            let (what, value) = ("the integer horizon (steps)", steps as f64);
            return Err(Error::out_of_range(what, value, 1.0..=most as f64));
        }
        let later = self.systems.iter().flat_map(|own| own.decisions_from(steps));
        for variable in later.collect::<Vec<Variable>>() {
            self.model.relax_integer(variable)?;
        }
        let is_shorter = steps < self.systems.steps;
        Arc::make_mut(&mut self.systems).integer_steps = is_shorter.then_some(steps);
        Ok(())
    }

    /// Refuses to read plans where integers of later steps are relaxed.
    pub(super) fn check_is_whole(&self) -> Result<(), Error> {
        let Some(steps) = self.systems.integer_steps else { return Ok(()) };
        Err(ErrorKind::Unsupported {
            solver: "a plan".into(),
            what: format!("an integer horizon of {steps} steps, after which nothing is decided"),
            help:
                "read values by `Solution::value`, or let a `RecedingHorizon` take the first move"
                    .into(),
        }
        .into())
    }
}
