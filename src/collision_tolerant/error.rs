//! Errors of scenarios.

use thiserror::Error;

use crate::hybrid::{FreeSide, Wall};
use crate::interval::Interval;

/// A scenario that contradicts itself, found before any planning, or a plan of another scenario.
///
/// In a [`carom::Error`](crate::Error) it is the [`source`](std::error::Error::source) of an error
/// of the kind [`ErrorKind::Other`](crate::ErrorKind::Other):
///
/// ```
/// use std::error::Error;
///
/// use carom::collision_tolerant::{Endpoint, Scenario, ScenarioError};
///
/// let fast = Scenario::paper().with_start(Endpoint::at_rest(10.0).with_velocity(-16.0));
/// let error = fast.check().unwrap_err();
/// let scenario = error.source().and_then(|source| source.downcast_ref());
/// assert!(matches!(scenario, Some(ScenarioError::TooFast { speed: 16.0, .. })));
/// ```
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ScenarioError {
    /// The vehicle starts or ends inside the wall.
    #[error(
        "the scenario cannot be planned: the {end} at {position} m is inside the wall, whose free \
         side is {} {} m; move it to the free side, or turn the wall around",
        side(.wall), .wall.position()
    )]
    InsideWall {
        /// `start` or `goal`.
        end: &'static str,
        /// Its position, in m.
        position: f64,
        /// The position of the wall, in m.
        wall: Wall,
    },
    /// The vehicle starts or ends faster than the largest speed.
    #[error(
        "the scenario cannot be planned: the {end} speed of {speed} m/s is above the largest speed \
         of {limit} m/s; lower it, or raise the largest speed"
    )]
    TooFast {
        /// `start` or `goal`.
        end: &'static str,
        /// Its speed, in m/s.
        speed: f64,
        /// The largest speed, in m/s.
        limit: f64,
    },
    /// The acceleration at the start or at the goal is outside the limits.
    #[error(
        "the scenario cannot be planned: the {end} acceleration of {acceleration} m/s² is outside \
         [{}, {}] m/s²; bring it within the limits, or leave it free",
        .limits.lower, .limits.upper
    )]
    Acceleration {
        /// `start` or `goal`.
        end: &'static str,
        /// Its acceleration, in m/s².
        acceleration: f64,
        /// The limits, in m/s².
        limits: Interval,
    },
    /// The vehicle starts or ends outside the domain.
    #[error(
        "the scenario cannot be planned: the {end} at {position} m is outside the domain [{}, {}] \
         m; move it, or widen the domain",
        .domain.lower, .domain.upper
    )]
    OutsideDomain {
        /// `start` or `goal`.
        end: &'static str,
        /// Its position, in m.
        position: f64,
        /// The domain, in m.
        domain: Interval,
    },
    /// A solution starts or ends elsewhere than the scenario says.
    #[error(
        "the plan misses the {end} of the scenario: it is at {position} m there, with {velocity} m/s \
         and {acceleration} m/s²; certify it with the scenario of its program, whose {end} must stay \
         as it was built"
    )]
    Missed {
        /// `start` or `goal`.
        end: &'static str,
        /// Its position, in m.
        position: f64,
        /// Its velocity, in m/s.
        velocity: f64,
        /// Its acceleration, in m/s².
        acceleration: f64,
    },
    /// An interval of damage limits was asked for, but collisions are forbidden.
    #[error(
        "the scenario has no damage interval: a damage limit means nothing without collisions; \
         tolerate them"
    )]
    NoCollisions,
    /// An interval of damage limits was asked for, but waiting is not free.
    #[error(
        "the scenario has no damage interval: its shortest horizon need not shrink as the damage \
         limit grows, because the vehicle can wait neither at its start nor at its goal; let it \
         start or end at rest"
    )]
    CannotWait,
}

impl From<ScenarioError> for crate::Error {
    fn from(error: ScenarioError) -> Self {
        crate::Error::other(error)
    }
}

fn side(wall: &Wall) -> &'static str {
    match wall.free() {
        FreeSide::Above => "above",
        FreeSide::Below => "below",
    }
}
