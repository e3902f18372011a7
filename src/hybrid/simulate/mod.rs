//! Simulators of hybrid systems, and replays of plans.
//!
//! They work in `f64` and share no code with the rows of programs, so they check plans
//! independently:
//!
//! * [`HybridSystem::simulate`](crate::hybrid::HybridSystem::simulate) runs a hybrid system as it is
//!   stated: it evaluates flows, guards and resets, and says which transitions were possible;
//! * [`replay_discrete`] runs the same discrete law open loop from the first sample and decides contacts
//!   itself;
//! * [`replay_continuous`] runs the physics behind the law: accelerations are held over each step, and
//!   impacts are located inside it.

mod certify;
mod condition;
pub(crate) mod continuous;
mod discrete;
mod error;
mod memory;
mod options;
mod plan;
mod run;
mod simulation;
mod step;
mod stepper;

pub use certify::RunCertificate;
pub use condition::Condition;
pub use continuous::{ContinuousReplay, replay_continuous};
pub use discrete::{DiscreteReplay, ReplayedImpact, replay_discrete};
pub use error::{ReplayError, RunError};
pub use options::{Follow, SimulationOptions};
pub use simulation::{Candidate, DeadEnd, SimulatedStep, Simulation};

use super::horizon::Horizon;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::error::{Error, check_finite, check_length};

/// The samples of a plan over τ steps, as input of a replay.
///
/// ```
/// use carom::hybrid::{Contact, Restitution, Samples, Wall, replay_discrete};
///
/// // Half a metre above the floor, falling at 2 m/s, for half a second.
/// let plan = Samples {
///     time_step: 0.5,
///     position: &[0.5, 0.25],
///     velocity: &[-2.0, 1.0],
///     acceleration: &[0.0],
///     contact: &[true],
/// };
/// let floor = Contact::new(Wall::above(0.0)?, Restitution::new(0.5)?);
/// let replay = replay_discrete(&floor, &plan)?;
/// assert_eq!(replay.impacts[0].speed_before, 2.0);
/// assert_eq!(replay.max_position_error, 0.0);
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Samples<'a> {
    /// Δt, in s.
    pub time_step: f64,
    /// x(0), ..., x(τ), in m.
    pub position: &'a [f64],
    /// v(0), ..., v(τ), in m/s.
    pub velocity: &'a [f64],
    /// a(0), ..., a(τ-1), in m/s².
    pub acceleration: &'a [f64],
    /// ζ(0), ..., ζ(τ-1).
    pub contact: &'a [bool],
}

impl Samples<'_> {
    /// Number of steps, τ.
    pub fn steps(&self) -> usize {
        self.acceleration.len()
    }

    /// Refuses lengths that do not fit, horizons out of range and numbers that are not finite.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Length`], [`ErrorKind::OutOfRange`], [`ErrorKind::NotFinite`].
    pub fn check(&self) -> Result<(), Error> {
        let steps = Horizon::new(self.steps(), self.time_step)?.steps();
        let lengths = [
            ("the positions", self.position.len(), steps + 1),
            ("the velocities", self.velocity.len(), steps + 1),
            ("the contacts", self.contact.len(), steps),
        ];
        for (what, found, expected) in lengths {
            check_length(what, found, expected)?;
        }
        let groups = [
            ("a position", self.position),
            ("a velocity", self.velocity),
            ("an acceleration", self.acceleration),
        ];
        for (what, values) in groups {
            check_finite("the plan", what, values.iter().copied())?;
        }
        Ok(())
    }
}
