//! Closed intervals with outward rounding: the arithmetic behind every big-M and every bound.

use std::ops::{Add, Div, Mul, Neg, RangeInclusive};

use crate::error::{Error, ErrorKind, check_finite};
use crate::rounding::{add_down, add_up, down, is_exact_product, up};

/// A closed interval `[lower, upper]`, either end possibly infinite.
///
/// An inexact operation rounds its result outward by one unit in the last place. The result
/// therefore always contains the exact result for any members of the operands. Exact results are
/// not widened.
///
/// ```
/// use carom::interval::Interval;
///
/// let tenths = Interval::point(0.1) * 3.0;
/// assert!(tenths.lower < tenths.upper && tenths.contains(0.1 * 3.0));
/// assert_eq!(Interval::from(-1.0..=2.0) + Interval::point(0.5), Interval::new(-0.5, 2.5));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Interval {
    /// The smaller end; `-inf` when unbounded below.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_numbers"))]
    pub lower: f64,
    /// The larger end; `+inf` when unbounded above.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_numbers"))]
    pub upper: f64,
}

impl From<RangeInclusive<f64>> for Interval {
    #[inline]
    fn from(range: RangeInclusive<f64>) -> Self {
        Interval::from(&range)
    }
}

impl From<&RangeInclusive<f64>> for Interval {
    #[inline]
    fn from(range: &RangeInclusive<f64>) -> Self {
        Interval { lower: *range.start(), upper: *range.end() }
    }
}

impl From<&Interval> for Interval {
    #[inline]
    fn from(interval: &Interval) -> Self {
        *interval
    }
}

impl Interval {
    /// The whole real line.
    pub const REALS: Interval = Interval { lower: f64::NEG_INFINITY, upper: f64::INFINITY };

    /// The interval `[lower, upper]`.
    #[inline]
    pub fn new(lower: f64, upper: f64) -> Self {
        Interval { lower, upper }
    }

    /// The interval that contains only `value`.
    #[inline]
    pub fn point(value: f64) -> Self {
        Interval { lower: value, upper: value }
    }

    /// Whether `value` lies inside, ends included.
    #[inline]
    pub fn contains(&self, value: f64) -> bool {
        self.lower <= value && value <= self.upper
    }

    /// `upper - lower`, rounded up.
    #[inline]
    pub fn width(&self) -> f64 {
        add_up(self.upper, -self.lower)
    }

    /// Whether both ends are finite.
    #[inline]
    pub fn is_bounded(&self) -> bool {
        self.lower.is_finite() && self.upper.is_finite()
    }

    /// Returns an error if an end is not finite or the ends are crossed. The error names `name`, a
    /// variable or a limit.
    #[doc(hidden)]
    #[inline]
    pub fn check(&self, name: &str) -> Result<(), Error> {
        let Interval { lower, upper } = *self;
        check_finite(name, "the lower limit", [lower])?;
        check_finite(name, "the upper limit", [upper])?;
        if lower > upper {
            return Err(ErrorKind::CrossedBounds { name: name.into(), lower, upper }.into());
        }
        Ok(())
    }

    /// The largest magnitude of a member.
    #[inline]
    pub fn magnitude(&self) -> f64 {
        self.lower.abs().max(self.upper.abs())
    }

    /// The smallest interval that contains both.
    #[inline]
    pub fn hull(&self, other: Interval) -> Interval {
        Interval { lower: self.lower.min(other.lower), upper: self.upper.max(other.upper) }
    }

    /// The intersection; its ends are crossed if it is empty.
    #[inline]
    pub fn intersection(&self, other: Interval) -> Interval {
        Interval { lower: self.lower.max(other.lower), upper: self.upper.min(other.upper) }
    }

    /// Whether the ends are crossed.
    #[doc(hidden)]
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.lower > self.upper
    }

    /// The member nearest to `value`.
    #[doc(hidden)]
    #[inline]
    pub fn nearest(&self, value: f64) -> f64 {
        value.max(self.lower).min(self.upper)
    }
}

impl Add for Interval {
    type Output = Interval;

    #[inline]
    fn add(self, other: Interval) -> Interval {
        Interval {
            lower: add_down(self.lower, other.lower),
            upper: add_up(self.upper, other.upper),
        }
    }
}

impl Mul<f64> for Interval {
    type Output = Interval;

    #[inline]
    fn mul(self, factor: f64) -> Interval {
        if factor == 0.0 {
            return Interval::point(0.0);
        }
        let (low, high) =
            if factor > 0.0 { (self.lower, self.upper) } else { (self.upper, self.lower) };
        let (a, b) = (low * factor, high * factor);
        Interval {
            lower: if is_exact_product(low, factor, a) { a } else { down(a) },
            upper: if is_exact_product(high, factor, b) { b } else { up(b) },
        }
    }
}

impl Mul for Interval {
    type Output = Interval;

    /// An infinite end times 0 is 0, because no member is infinite.
    fn mul(self, other: Interval) -> Interval {
        if self == Interval::point(0.0) || other == Interval::point(0.0) {
            return Interval::point(0.0);
        }
        let ends = [self.lower, self.upper].map(|a| [other.lower, other.upper].map(|b| (a, b)));
        let mut hull = Interval { lower: f64::INFINITY, upper: f64::NEG_INFINITY };
        for (a, b) in ends.into_iter().flatten() {
            let product = if a == 0.0 || b == 0.0 { 0.0 } else { a * b };
            let exact = is_exact_product(a, b, product) || product == 0.0 && (a == 0.0 || b == 0.0);
            let (low, high) = match (exact, (a > 0.0) == (b > 0.0)) {
                (true, _) => (product, product),
                // Rounding changes no sign.
                (false, true) => (down(product).max(0.0), up(product)),
                (false, false) => (down(product), up(product).min(0.0)),
            };
            hull = hull.hull(Interval { lower: low, upper: high });
        }
        hull
    }
}

impl Div for Interval {
    type Output = Interval;

    /// The whole line if the divisor contains 0 inside.
    fn div(self, other: Interval) -> Interval {
        if other.lower < 0.0 && other.upper > 0.0 || other == Interval::point(0.0) {
            return Interval::REALS;
        }
        // Without a sign, the quotient by the end at 0 is infinite on the side of the others.
        let (zero_low, zero_high) = (other.lower == 0.0, other.upper == 0.0);
        let inverse = |v: f64| if v.is_infinite() { 0.0 } else { 1.0 / v };
        let lower = if zero_high { f64::NEG_INFINITY } else { down(inverse(other.upper)) };
        let upper = if zero_low { f64::INFINITY } else { up(inverse(other.lower)) };
        // Rounding changes no sign.
        let (lower, upper) = match other.lower >= 0.0 {
            true => (lower.max(0.0), upper),
            false => (lower, upper.min(0.0)),
        };
        self * Interval { lower, upper }
    }
}

impl Neg for Interval {
    type Output = Interval;

    #[inline]
    fn neg(self) -> Interval {
        Interval { lower: -self.upper, upper: -self.lower }
    }
}
