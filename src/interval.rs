//! Closed intervals with outward rounding: the arithmetic behind every big-M and every bound.

use std::ops::{Add, Mul, Neg};

/// A closed interval `[lower, upper]`, either end possibly infinite.
///
/// Every operation rounds outward by one unit in the last place, so a result always contains the
/// exact result of the operation on any members of its operands.
///
/// ```
/// use carom::interval::Interval;
///
/// let third = Interval::point(1.0) * (1.0 / 3.0);
/// assert!(third.lower < third.upper && third.contains(1.0 / 3.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Interval {
    /// The smaller end; `-inf` when unbounded below.
    pub lower: f64,
    /// The larger end; `+inf` when unbounded above.
    pub upper: f64,
}

impl Interval {
    /// The whole real line.
    pub const REALS: Interval = Interval { lower: f64::NEG_INFINITY, upper: f64::INFINITY };

    /// The interval `[lower, upper]`.
    pub fn new(lower: f64, upper: f64) -> Self {
        Interval { lower, upper }
    }

    /// The interval that holds one value only.
    pub fn point(value: f64) -> Self {
        Interval { lower: value, upper: value }
    }

    /// Whether `value` lies inside, ends included.
    pub fn contains(&self, value: f64) -> bool {
        self.lower <= value && value <= self.upper
    }

    /// `upper - lower`, rounded up.
    pub fn width(&self) -> f64 {
        up(self.upper - self.lower)
    }

    /// Whether both ends are finite.
    pub fn is_bounded(&self) -> bool {
        self.lower.is_finite() && self.upper.is_finite()
    }

    /// The largest magnitude of a member.
    pub fn magnitude(&self) -> f64 {
        self.lower.abs().max(self.upper.abs())
    }

    /// The smallest interval that holds both.
    pub fn hull(&self, other: Interval) -> Interval {
        Interval { lower: self.lower.min(other.lower), upper: self.upper.max(other.upper) }
    }

    /// The common part; its ends are crossed when there is none.
    pub fn intersection(&self, other: Interval) -> Interval {
        Interval { lower: self.lower.max(other.lower), upper: self.upper.min(other.upper) }
    }
}

/// The next float above a finite `value`; infinities and exact zeros of a difference stay.
pub(crate) fn up(value: f64) -> f64 {
    if value.is_finite() { value.next_up() } else { value }
}

/// The next float below a finite `value`.
pub(crate) fn down(value: f64) -> f64 {
    if value.is_finite() { value.next_down() } else { value }
}

impl Add for Interval {
    type Output = Interval;

    fn add(self, other: Interval) -> Interval {
        Interval { lower: down(self.lower + other.lower), upper: up(self.upper + other.upper) }
    }
}

impl Mul<f64> for Interval {
    type Output = Interval;

    fn mul(self, factor: f64) -> Interval {
        if factor == 0.0 {
            return Interval::point(0.0);
        }
        let (a, b) = (self.lower * factor, self.upper * factor);
        Interval { lower: down(a.min(b)), upper: up(a.max(b)) }
    }
}

impl Neg for Interval {
    type Output = Interval;

    fn neg(self) -> Interval {
        Interval { lower: -self.upper, upper: -self.lower }
    }
}
