//! Ranges of floats whose ends are rounded outward.
//!
//! Sums, products, quotients and square roots of floats are the nearest floats to the true ones
//! (IEEE 754), so that the neighbour of a result is on the safe side.

use std::ops::{Add, Mul, Neg, Sub};

/// All numbers from `lower` to `upper`; the ends may be infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FloatRange {
    pub(crate) lower: f64,
    pub(crate) upper: f64,
}

impl FloatRange {
    pub(crate) const ALL: Self = FloatRange { lower: f64::NEG_INFINITY, upper: f64::INFINITY };

    /// The range between two ends.
    pub(crate) const fn new(lower: f64, upper: f64) -> Self {
        FloatRange { lower, upper }
    }

    pub(crate) const fn point(value: f64) -> Self {
        FloatRange { lower: value, upper: value }
    }

    /// The range with ends that are the nearest floats to the true ones, or NaN.
    fn rounded(lower: f64, upper: f64) -> Self {
        let lower = if lower.is_nan() { f64::NEG_INFINITY } else { lower.next_down() };
        let upper = if upper.is_nan() { f64::INFINITY } else { upper.next_up() };
        FloatRange { lower, upper }
    }

    /// The numbers that are in both.
    pub(crate) fn within(self, other: Self) -> Self {
        FloatRange { lower: self.lower.max(other.lower), upper: self.upper.min(other.upper) }
    }

    pub(crate) fn hull(self, other: Self) -> Self {
        FloatRange { lower: self.lower.min(other.lower), upper: self.upper.max(other.upper) }
    }

    pub(crate) fn is_empty(self) -> bool {
        self.lower > self.upper
    }

    pub(crate) fn is_bounded(self) -> bool {
        self.lower.is_finite() && self.upper.is_finite()
    }

    pub(crate) fn has_inside(self, value: f64) -> bool {
        self.lower < value && value < self.upper
    }

    /// A float between the ends, which are finite.
    pub(crate) fn middle(self) -> f64 {
        (0.5 * self.lower + 0.5 * self.upper).clamp(self.lower, self.upper)
    }

    /// The quotient; all numbers if the divisor may be 0.
    pub(crate) fn divided_by(self, by: Self) -> Self {
        if by.lower <= 0.0 && by.upper >= 0.0 {
            return Self::ALL;
        }
        self.corners(by, |a, b| a / b)
    }

    /// The square root of numbers that are at least 0.
    pub(crate) fn sqrt(self) -> Self {
        let root = Self::rounded(self.lower.max(0.0).sqrt(), self.upper.max(0.0).sqrt());
        FloatRange { lower: root.lower.max(0.0), upper: root.upper }
    }

    pub(crate) fn square(self) -> Self {
        let own = self * self;
        if self.lower <= 0.0 && self.upper >= 0.0 {
            return FloatRange { lower: 0.0, upper: own.upper };
        }
        FloatRange { lower: own.lower.max(0.0), upper: own.upper }
    }

    /// Half of it; halves of floats are floats, other than of the smallest ones.
    pub(crate) fn half(self) -> Self {
        self * Self::point(0.5)
    }

    fn corners(self, other: Self, of: impl Fn(f64, f64) -> f64) -> Self {
        let corner = |a: f64, b: f64| {
            let value = of(a, b);
            // 0 times anything is 0, and an end at infinity stands for large numbers.
            if value.is_nan() && (a == 0.0 || b == 0.0) { 0.0 } else { value }
        };
        let all = [
            corner(self.lower, other.lower),
            corner(self.lower, other.upper),
            corner(self.upper, other.lower),
            corner(self.upper, other.upper),
        ];
        if all.iter().any(|value| value.is_nan()) {
            return Self::ALL;
        }
        let (lower, upper) =
            all.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, u), value| {
                (l.min(*value), u.max(*value))
            });
        Self::rounded(lower, upper)
    }
}

impl Add for FloatRange {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::rounded(self.lower + other.lower, self.upper + other.upper)
    }
}

impl Sub for FloatRange {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self::rounded(self.lower - other.upper, self.upper - other.lower)
    }
}

impl Neg for FloatRange {
    type Output = Self;

    fn neg(self) -> Self {
        FloatRange { lower: -self.upper, upper: -self.lower }
    }
}

impl Mul for FloatRange {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        self.corners(other, |a, b| a * b)
    }
}
