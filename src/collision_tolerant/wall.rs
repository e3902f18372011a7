//! A wall: a half-line that the vehicle cannot enter.

use super::checks::check_finite;
use crate::error::Error;
use crate::interval::Interval;
use crate::model::Affine;

/// The side of the wall on which the vehicle moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
enum FreeSide {
    /// Positions `x >= position` are free.
    Above,
    /// Positions `x <= position` are free.
    Below,
}

/// A wall on a line, at a position (m) and with one free side; the paper's `x_w`, equation (7).
///
/// Contact laws use *gap* and *rate*. The gap is the distance to the wall (m, positive on the free
/// side), and the rate is its time derivative (m/s, positive when moving away).
///
/// ```
/// use carom::collision_tolerant::Wall;
///
/// let ceiling = Wall::below(3.0)?;
/// assert_eq!(ceiling.gap(2.5), 0.5);
/// assert_eq!(ceiling.rate(4.0), -4.0); // upward, towards it
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Wall {
    position: f64,
    free: FreeSide,
}

impl Default for Wall {
    /// The paper's wall: at 0 m, free above.
    fn default() -> Self {
        Wall { position: 0.0, free: FreeSide::Above }
    }
}

impl Wall {
    fn new(position: f64, free: FreeSide) -> Result<Self, Error> {
        check_finite("wall", "the position", position)?;
        Ok(Wall { position, free })
    }

    /// A wall at a position (m, finite) whose free side is above it: `x >= position`.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::NotFinite`](crate::error::ErrorKind::NotFinite).
    pub fn above(position: f64) -> Result<Self, Error> {
        Wall::new(position, FreeSide::Above)
    }

    /// A wall at a position (m, finite) whose free side is below it: `x <= position`.
    ///
    /// # Errors
    ///
    /// As for [`Wall::above`].
    pub fn below(position: f64) -> Result<Self, Error> {
        Wall::new(position, FreeSide::Below)
    }

    /// Its position, in m.
    pub fn position(&self) -> f64 {
        self.position
    }

    /// The positions on its free side, in m.
    pub(super) fn free_positions(&self) -> Interval {
        match self.free {
            FreeSide::Above => Interval::new(self.position, f64::INFINITY),
            FreeSide::Below => Interval::new(f64::NEG_INFINITY, self.position),
        }
    }

    /// The outward normal (no unit): `+1` if the free side is above, `-1` if it is below.
    pub fn normal(&self) -> f64 {
        match self.free {
            FreeSide::Above => 1.0,
            FreeSide::Below => -1.0,
        }
    }

    /// Distance of a position (m) from the wall, in m, negative inside it.
    pub fn gap(&self, position: f64) -> f64 {
        self.normal() * (position - self.position)
    }

    /// Speed away from the wall for a velocity, in m/s; also converts accelerations, in m/s².
    pub fn rate(&self, velocity: f64) -> f64 {
        self.normal() * velocity
    }

    /// The position at a gap, in m: the inverse of [`gap`](Wall::gap).
    pub fn at_gap(&self, gap: f64) -> f64 {
        self.position + self.normal() * gap
    }

    /// The positions between two gaps, in m.
    pub(super) fn between(&self, one: f64, other: f64) -> Interval {
        Interval::point(self.at_gap(one)).hull(Interval::point(self.at_gap(other)))
    }

    /// The gap of a position expression (m).
    pub fn gap_of(&self, position: &Affine) -> Affine {
        self.normal() * (position - self.position)
    }

    /// The rate of a velocity expression (m/s).
    pub fn rate_of(&self, velocity: &Affine) -> Affine {
        self.normal() * velocity
    }
}
