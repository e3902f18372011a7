//! Restitution, and the speed of an impact.

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
