//! Contacts of a vehicle on a line with a wall, and restitution.
//!
//! | law | file | paper |
//! | --- | --- | --- |
//! | [`ContactLaw::Reflecting`] | `scene/law.rs`, the law of every surface | replaces (8)-(13) |
//! | `Contact::transitions_with_rest` | `scene/resting.rs`, the law of surfaces with rest | |
//! | [`ContactLaw::Literal`] | `contact/literal.rs` | (8)-(13), errata applied |

mod literal;

pub(super) use literal::transitions as literal_transitions;

use super::wall::Wall;
use crate::error::Error;
#[cfg(doc)]
use crate::error::ErrorKind;

/// The output of a hit: the speed towards the surface, in m/s.
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
        Err(Error::out_of_range("the restitution", value, 0.0..=1.0))
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
    /// By how much the restitution may be more or less in a hit (no unit); default 0.
    #[cfg_attr(feature = "serde", serde(default))]
    pub spread: f64,
}

impl Contact {
    /// Contact under the default law, [`ContactLaw::Reflecting`].
    pub fn new(wall: Wall, restitution: Restitution) -> Self {
        Contact { wall, restitution, law: ContactLaw::default(), spread: 0.0 }
    }

    /// Says that the restitution is not known: it may be up to `spread` more or less (no unit), in
    /// every hit anew. [Robust programs](crate::hybrid::HybridProgram::robust) plan for all of it.
    #[must_use]
    pub fn with_spread(mut self, spread: f64) -> Self {
        self.spread = spread;
        self
    }

    /// Contact under another law.
    #[must_use]
    pub fn with_law(mut self, law: ContactLaw) -> Self {
        self.law = law;
        self
    }
}
