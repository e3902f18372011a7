//! Numbers of some 32 digits with a bound of their error.

use crate::sum::{exact_product, exact_sum};

/// The largest error of a value, relative to it, and absolute, at which its digits are known (no
/// unit).
const SHARP_DIGITS: f64 = 1e-12;
const SHARP_FROM_ZERO: f64 = 1e-200;

/// A product below this may have lost digits to the smallest float.
const NEAR_UNDERFLOW: f64 = 1e-250;

/// The growth of a bound that covers its own rounding.
const OUTWARD: f64 = 1.0 + 16.0 * f64::EPSILON;

/// Every number within `radius` of `high + low`. The radius is 0 where nothing was rounded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ball {
    high: f64,
    low: f64,
    radius: f64,
}

impl From<f64> for Ball {
    fn from(value: f64) -> Self {
        Ball { high: value, low: 0.0, radius: 0.0 }
    }
}

impl Ball {
    /// All numbers.
    pub(crate) const UNKNOWN: Ball = Ball { high: 0.0, low: 0.0, radius: f64::INFINITY };

    /// The float nearest to the centre.
    pub(crate) fn value(self) -> f64 {
        self.high
    }

    /// By how much a number of the ball may differ from [`value`](Self::value).
    pub(crate) fn error(self) -> f64 {
        if self.radius == 0.0 { self.low.abs() } else { (self.radius + self.low.abs()) * OUTWARD }
    }

    /// Whether the value has all digits of a float.
    pub(crate) fn is_sharp(self) -> bool {
        self.high.is_finite()
            && self.radius <= (SHARP_DIGITS * self.high.abs()).max(SHARP_FROM_ZERO)
    }

    /// Whether 0 may be meant.
    fn may_be_zero(self) -> bool {
        self.high.abs() <= self.error() * OUTWARD
    }

    /// `self + a b`.
    pub(super) fn plus_product(self, a: f64, b: Ball) -> Ball {
        let (product, error) = exact_product(a, b.high);
        let (small, rest) = exact_product(a, b.low);
        let mut parts = [rest, small, error, product, self.low, self.high];
        // Exact sums, from one end to the other and again: what the last two do not hold is known.
        for _ in 0..3 {
            for k in 1..parts.len() {
                let (sum, rest) = exact_sum(parts[k - 1], parts[k]);
                (parts[k], parts[k - 1]) = (sum, rest);
            }
        }
        let [a0, a1, a2, a3, low, high] = parts;
        let mut lost = a0.abs() + a1.abs() + a2.abs() + a3.abs();
        let vanishes =
            |factor: f64, product: f64| a != 0.0 && factor != 0.0 && product.abs() < NEAR_UNDERFLOW;
        if vanishes(b.high, product) || vanishes(b.low, small) {
            lost += 4.0 * f64::MIN_POSITIVE;
        }
        if self.radius > 0.0 || b.radius > 0.0 || lost > 0.0 {
            lost = (self.radius + a.abs() * b.radius + lost) * OUTWARD;
        }
        if high.is_finite() && lost.is_finite() {
            Ball { high, low, radius: lost }
        } else {
            Ball::UNKNOWN
        }
    }

    /// `self - a b`.
    pub(super) fn minus_product(self, a: Ball, b: Ball) -> Ball {
        let mut all = self.plus_product(-a.high, b).plus_product(-a.low, b);
        if a.radius > 0.0 {
            all.radius += a.radius * (b.high.abs() + b.error()) * OUTWARD;
        }
        if all.radius.is_finite() { all } else { Ball::UNKNOWN }
    }

    /// `self / a`; unknown where `a` may be 0.
    pub(super) fn over(self, a: Ball) -> Ball {
        let least = a.high.abs() - a.error() * OUTWARD;
        if a.may_be_zero() || least <= 0.0 || !self.radius.is_finite() {
            return Ball::UNKNOWN;
        }
        let first = self.high / a.high;
        let rest = self.plus_product(-first, a);
        let second = rest.high / a.high;
        let rest = rest.plus_product(-second, a);
        let (high, low) = exact_sum(first, second);
        let error = rest.high.abs() + rest.error();
        let radius = if error > 0.0 { error / least * OUTWARD + f64::MIN_POSITIVE } else { 0.0 };
        if high.is_finite() && radius.is_finite() {
            Ball { high, low, radius }
        } else {
            Ball::UNKNOWN
        }
    }

    /// The magnitude, for the choice of pivots; 0 where 0 may be meant.
    pub(super) fn pivot_size(self) -> f64 {
        if self.may_be_zero() { 0.0 } else { self.high.abs() }
    }
}
