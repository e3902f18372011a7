//! Contact laws: what happens at a wall, as transitions of a hybrid system.
//!
//! A law gives two transitions, the flight and the contact, which is an event. Laws use gap and rate
//! (see [`Wall`]), so they apply to walls that face either way.
//!
//! | law | file | paper |
//! | --- | --- | --- |
//! | [`ContactLaw::Reflecting`] | `contact/reflecting.rs` | replaces (8)-(13) |
//! | [`ContactLaw::Literal`] | `contact/literal.rs` | (8)-(13), errata applied |
//! | [`Contact::transitions_with_rest`] | `contact/resting.rs` | |

mod literal;
mod reflecting;
mod resting;

use super::linear::LinearSystem;
use super::system::Transition;
use super::wall::Wall;
use crate::error::Error;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::model::Affine;

/// The output of an impact under the reflecting law: the speed towards the wall, in m/s.
pub(crate) const IMPACT_SPEED: &str = "impact speed";

/// Coefficient of restitution e: rebound speed over impact speed (no unit), from 0 (perfectly
/// plastic) to 1 (perfectly elastic).
///
/// ```
/// use carom::hybrid::Restitution;
///
/// assert_eq!(Restitution::new(0.5)?.value(), 0.5);
/// assert!(Restitution::new(1.5).is_err());
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "f64", into = "f64"))]
pub struct Restitution(f64);

impl Restitution {
    /// The vehicle stops at the wall: e = 0.
    pub const PLASTIC: Restitution = Restitution(0.0);

    /// The vehicle rebounds at full speed: e = 1.
    pub const ELASTIC: Restitution = Restitution(1.0);

    /// A coefficient of restitution within `[0, 1]`.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`].
    pub fn new(value: f64) -> Result<Self, Error> {
        if (0.0..=1.0).contains(&value) {
            return Ok(Restitution(value));
        }
        Err(Error::out_of_range("the restitution", value, "within [0, 1]"))
    }

    /// The coefficient, within `[0, 1]` (no unit).
    pub fn value(self) -> f64 {
        self.0
    }
}

impl TryFrom<f64> for Restitution {
    type Error = Error;

    fn try_from(value: f64) -> Result<Self, Error> {
        Restitution::new(value)
    }
}

impl From<Restitution> for f64 {
    fn from(restitution: Restitution) -> f64 {
        restitution.0
    }
}

/// The equations of a contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ContactLaw {
    /// If the free flight of a step ends behind the wall, the step is reflected at the wall, and
    /// the rebound is scaled by the restitution. The vehicle never ends a step inside the wall.
    #[default]
    Reflecting,
    /// The paper's equations (8)-(13) with their errata corrected: while the vehicle is inside the
    /// wall, its acceleration is `-(1+e) v/Δt`.
    ///
    /// This law never pays off. It reverses the velocity, but during that step the vehicle moves
    /// another `Δt |v| (1-e)/2` into the wall, where the law applies again. The shortest plans
    /// under it are collision-free. It is here for comparison with the paper.
    Literal,
}

/// The impact speed of a step.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ImpactSpeed {
    /// The speed into the wall if ζ(t) = 1, in m/s.
    pub speed: Affine,
    /// Whether the law keeps `speed` at 0 if ζ(t) = 0, and never negative. Otherwise the expression
    /// has no meaning in flight.
    pub zero_in_flight: bool,
    /// The approach at the start of the step, in m/s, if the damage of a hit is to be at least that
    /// too; `None` if the damage is `speed`.
    pub start: Option<Affine>,
}

impl ImpactSpeed {
    /// The speed into the wall, in m/s, and whether it is 0 in flight.
    pub fn new(speed: impl Into<Affine>, zero_in_flight: bool) -> Self {
        ImpactSpeed { speed: speed.into(), zero_in_flight, start: None }
    }

    /// Lets the damage of a hit be at least the approach at the start of its step too, in m/s; see
    /// [`ImpactEstimate::Sound`](crate::hybrid::ImpactEstimate::Sound).
    #[must_use]
    pub fn with_start(mut self, approach: impl Into<Affine>) -> Self {
        self.start = Some(approach.into());
        self
    }
}

/// A wall, its restitution, and the contact law.
///
/// ```
/// use carom::hybrid::{Contact, ContactLaw, Restitution, Wall};
///
/// let floor = Contact::new(Wall::above(0.0)?, Restitution::new(0.8)?);
/// assert_eq!(floor.law, ContactLaw::Reflecting);
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Contact {
    /// The wall.
    pub wall: Wall,
    /// The restitution.
    pub restitution: Restitution,
    /// The law.
    pub law: ContactLaw,
}

impl Contact {
    /// Contact under the default law, [`ContactLaw::Reflecting`].
    pub fn new(wall: Wall, restitution: Restitution) -> Self {
        Contact { wall, restitution, law: ContactLaw::default() }
    }

    /// Contact under another law.
    #[must_use]
    pub fn with_law(mut self, law: ContactLaw) -> Self {
        self.law = law;
        self
    }

    /// The law as transitions of a vehicle with state `[x, v]` (m, m/s) and input `[a]` (m/s²), for a
    /// [`HybridSystem`](super::HybridSystem): first the flight, then the contact, which is an event.
    ///
    /// Under the reflecting law, the impact has the output `impact speed` (m/s). Under the literal
    /// law, the contact forces the input to `-(1+e) v/Δt`, so give the contact an input range that
    /// contains it.
    ///
    /// # Arguments
    ///
    /// * `time_step`: Δt, in s, finite and positive.
    /// * `max_speed`: limit on the impact speed, in m/s, if there is one.
    ///
    /// ```
    /// use carom::hybrid::{Contact, Restitution, Wall};
    ///
    /// let floor = Contact::new(Wall::above(0.0)?, Restitution::new(0.5)?);
    /// let [flight, impact] = floor.transitions(0.01, Some(3.0))?;
    /// assert!(impact.is_event && !flight.is_event);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`] for a time step that is not finite and positive.
    pub fn transitions(
        &self,
        time_step: f64,
        max_speed: Option<f64>,
    ) -> Result<[Transition; 2], Error> {
        match self.law {
            ContactLaw::Reflecting => {
                let flow = LinearSystem::double_integrator(time_step)?;
                Ok(reflecting::transitions(self.wall, self.restitution, &flow, max_speed))
            }
            ContactLaw::Literal => {
                literal::transitions(self.wall, self.restitution, time_step, max_speed)
            }
        }
    }

    /// A contact that may come to rest, as transitions of the same vehicle: flight, impact, settling
    /// and rest. It is a law of its own, whatever [`law`](Contact::law) says.
    ///
    /// A step in contact ends at the wall. An impact rebounds with e times the approach at the
    /// *start* of its step, so that bounces die out. A vehicle that does not approach at the start, and
    /// would end behind the wall, settles there. One at rest at the wall stays as long as its
    /// acceleration does not point away, which is no event.
    ///
    /// Under the reflecting law bounces may go on for ever: what the acceleration adds between the
    /// impact and the end of its step is reflected too.
    ///
    /// # Arguments
    ///
    /// As for [`transitions`](Contact::transitions).
    ///
    /// ```
    /// use carom::hybrid::{
    ///     Contact, HybridSystem, Region, Restitution, ShortestOptions, Wall,
    /// };
    /// use carom::interval::Interval;
    /// use carom::prelude::*;
    ///
    /// let floor = Contact::new(Wall::above(0.0)?, Restitution::new(0.8)?);
    /// let mut ball = HybridSystem::new()
    ///     .with_state("x", Interval::new(0.0, 2.0))
    ///     .with_state("v", Interval::new(-10.0, 10.0))
    ///     .with_input("a", Interval::point(-9.81));
    /// for transition in floor.transitions_with_rest(0.05, None)? {
    ///     ball = ball.with_transition(transition);
    /// }
    /// let (start, rest) = (Region::point([1.0, 0.0]), Region::point([0.0, 0.0]));
    /// let (options, mut solver) = (ShortestOptions::default(), BranchAndBound::default());
    /// let found = ball.shortest_run(&start, &rest, 0.05, &options, &mut solver)?;
    /// assert!(found.run.is_some());
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`] for a time step that is not finite and positive.
    pub fn transitions_with_rest(
        &self,
        time_step: f64,
        max_speed: Option<f64>,
    ) -> Result<[Transition; 4], Error> {
        let e = self.restitution.value();
        resting::transitions(self.wall, e, time_step, max_speed, IMPACT_SPEED)
    }
}
