//! The values of a function over an interval of arguments, rounded outward.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::function::{Elementary, VALUE_ROUNDING, is_odd, is_whole, power};
use crate::interval::Interval;

/// Angles beyond this are not reduced (rad).
const LARGE_ANGLE: f64 = 1e8;

/// By how much a multiple of π in floats may be off, and the distance from it, relative (no unit).
const ANGLE_ROUNDING: f64 = 1e-14;

impl Elementary {
    /// An interval that contains the values for all arguments of a range that are in the domain;
    /// empty (with crossed ends) if none is.
    pub fn range(&self, x: Interval) -> Interval {
        let x = x.intersection(self.domain());
        if x.is_empty() {
            return Interval::new(f64::INFINITY, f64::NEG_INFINITY);
        }
        match self {
            Elementary::Sin => wave(x, FRAC_PI_2, f64::sin),
            Elementary::Cos => wave(x, 0.0, f64::cos),
            Elementary::Tan => match self.has_pole_in(x) {
                true => Interval::REALS,
                false => rising(x, f64::tan),
            },
            Elementary::Asin => rising(x, f64::asin).intersection(Interval::new(-1.6, 1.6)),
            Elementary::Acos => rising(-x, |t| (-t).acos()).intersection(Interval::new(0.0, 3.2)),
            Elementary::Atan => rising(x, f64::atan).intersection(Interval::new(-1.6, 1.6)),
            Elementary::Sinh => rising(x, f64::sinh),
            Elementary::Cosh => {
                let most = around(x.magnitude().cosh()).upper;
                let least = if x.contains(0.0) { 1.0 } else { least_magnitude(x).cosh() };
                Interval::new(around(least).lower.max(1.0), most)
            }
            Elementary::Tanh => rising(x, f64::tanh).intersection(Interval::new(-1.0, 1.0)),
            Elementary::Exp => rising(x, f64::exp).intersection(Interval::new(0.0, f64::INFINITY)),
            Elementary::Ln => rising(x, f64::ln),
            Elementary::Power(p) => powers(*p, x),
            Elementary::Own(own) => own.function().range(x),
        }
    }

    /// Whether the function is infinite somewhere inside a range: the tangent, and negative powers
    /// at 0.
    #[doc(hidden)]
    pub fn has_pole_in(&self, x: Interval) -> bool {
        match self {
            Elementary::Tan => may_contain_multiple(x, std::f64::consts::FRAC_PI_2),
            Elementary::Power(p) if *p < 0.0 && is_whole(*p) => x.lower < 0.0 && x.upper > 0.0,
            _ => false,
        }
    }

    /// 1 if the function rises over a range, -1 if it falls, and 0 if neither is known.
    #[doc(hidden)]
    pub fn direction(&self, x: Interval) -> f64 {
        let x = x.intersection(self.domain());
        let within = |lower: f64, upper: f64| x.lower >= lower && x.upper <= upper;
        match self {
            Elementary::Exp
            | Elementary::Ln
            | Elementary::Sinh
            | Elementary::Tanh
            | Elementary::Asin
            | Elementary::Atan => 1.0,
            Elementary::Acos => -1.0,
            Elementary::Sin if within(-1.57, 1.57) => 1.0,
            Elementary::Cos if within(0.0, 3.1) => -1.0,
            Elementary::Cos if within(-3.1, 0.0) => 1.0,
            Elementary::Tan if within(-1.57, 1.57) => 1.0,
            Elementary::Cosh if x.lower >= 0.0 => 1.0,
            Elementary::Cosh if x.upper <= 0.0 => -1.0,
            Elementary::Power(p) if x.lower >= 0.0 => p.signum(),
            Elementary::Power(p) if is_odd(*p) && *p > 0.0 => 1.0,
            Elementary::Power(p) if x.upper <= 0.0 && is_whole(*p) => {
                if is_odd(*p) {
                    p.signum()
                } else {
                    -p.signum()
                }
            }
            Elementary::Own(own) => {
                let slope = own.function().slope_range(x);
                f64::from(u8::from(slope.lower >= 0.0)) - f64::from(u8::from(slope.upper <= 0.0))
            }
            _ => 0.0,
        }
    }
}

/// A value with its rounding.
fn around(value: f64) -> Interval {
    if value.is_nan() {
        return Interval::REALS;
    }
    if value.is_infinite() {
        // An overflow hides a finite value.
        return match value > 0.0 {
            true => Interval::new(f64::MAX, value),
            false => Interval::new(value, f64::MIN),
        };
    }
    let error = VALUE_ROUNDING * value.abs() + f64::MIN_POSITIVE;
    Interval::new((value - error).next_down(), (value + error).next_up())
}

/// The values of a function that rises.
fn rising(x: Interval, of: impl Fn(f64) -> f64) -> Interval {
    Interval::new(around(of(x.lower)).lower, around(of(x.upper)).upper)
}

/// The smallest magnitude of a range without 0.
fn least_magnitude(x: Interval) -> f64 {
    x.lower.abs().min(x.upper.abs())
}

/// Whether `first + k * period` may lie in a range for a whole number k.
fn may_contain(x: Interval, first: f64, period: f64) -> bool {
    if !x.is_bounded() || x.magnitude() > LARGE_ANGLE || x.width() >= period {
        return true;
    }
    let slack = ANGLE_ROUNDING * x.magnitude().max(1.0);
    let k = ((x.lower - slack - first) / period).ceil();
    // One before and one after, because the quotient is rounded.
    [k - 1.0, k, k + 1.0].iter().any(|k| {
        let place = first + k * period;
        x.lower - slack <= place && place <= x.upper + slack
    })
}

/// Whether an odd multiple of an angle may lie in a range.
fn may_contain_multiple(x: Interval, angle: f64) -> bool {
    may_contain(x, angle, 2.0 * angle)
}

/// The values of a sine or cosine, which is 1 at the crest and -1 half a turn later.
fn wave(x: Interval, crest: f64, of: fn(f64) -> f64) -> Interval {
    let ends = match x.is_bounded() && x.magnitude() <= LARGE_ANGLE {
        true => around(of(x.lower)).hull(around(of(x.upper))),
        false => Interval::new(-1.0, 1.0),
    };
    let upper = if may_contain(x, crest, TAU) { 1.0 } else { ends.upper.min(1.0) };
    let lower = if may_contain(x, crest + PI, TAU) { -1.0 } else { ends.lower.max(-1.0) };
    Interval::new(lower, upper)
}

fn powers(p: f64, x: Interval) -> Interval {
    let of = |x: f64| power(x, p);
    let positive = Interval::new(0.0, f64::INFINITY);
    match () {
        () if p == 0.0 => Interval::point(1.0),
        () if p == 1.0 => x,
        () if !is_whole(p) || x.lower >= 0.0 => {
            let value = |x: f64| match p > 0.0 {
                true => around(of(x)),
                false if x == 0.0 => Interval::point(f64::INFINITY),
                false => around(of(x)),
            };
            let (first, last) = (value(x.lower), value(x.upper));
            first.hull(last).intersection(positive)
        }
        () if x.upper <= 0.0 => {
            let mirrored = powers(p, -x);
            if is_odd(p) { -mirrored } else { mirrored }
        }
        () if p < 0.0 => match is_odd(p) {
            true => Interval::REALS,
            false => Interval::new(around(of(x.magnitude())).lower.max(0.0), f64::INFINITY),
        },
        () if is_odd(p) => rising(x, of),
        () => Interval::new(0.0, around(of(x.magnitude())).upper),
    }
}
