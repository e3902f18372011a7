//! The arguments at which a function has values of an interval, within what is known of them.

use super::function::{Elementary, VALUE_ROUNDING, is_odd, is_whole};
use crate::interval::Interval;

impl Elementary {
    /// An interval that contains all arguments of a range whose values lie in another one; empty
    /// (with crossed ends) if there is none.
    #[doc(hidden)]
    pub fn inverse(&self, y: Interval, x: Interval) -> Interval {
        let x = x.intersection(self.domain());
        let values = self.range(x);
        // A value in floats may be a little off the true one.
        let rounding = VALUE_ROUNDING * y.lower.abs().min(y.upper.abs());
        let rounding = if rounding.is_finite() { rounding } else { 0.0 };
        let y = Interval::new(y.lower - rounding, y.upper + rounding).intersection(values);
        if x.is_empty() || y.is_empty() {
            return Interval::new(f64::INFINITY, f64::NEG_INFINITY);
        }
        if y == values {
            return x;
        }
        let found = match self {
            Elementary::Exp => Elementary::Ln.range(y),
            Elementary::Ln => Elementary::Exp.range(y),
            Elementary::Sinh => inverse_of(y, f64::asinh),
            Elementary::Tanh => inverse_of(y.intersection(Interval::new(-1.0, 1.0)), f64::atanh),
            Elementary::Cosh => {
                let most = inverse_of(Interval::new(1.0, y.upper), f64::acosh).upper;
                Interval::new(-most, most)
            }
            Elementary::Asin => Elementary::Sin.range(y),
            Elementary::Acos => Elementary::Cos.range(y),
            Elementary::Atan => match Elementary::Tan.has_pole_in(y) {
                true => Interval::REALS,
                false => Elementary::Tan.range(y),
            },
            Elementary::Power(p) => roots(*p, y, x),
            Elementary::Sin | Elementary::Cos | Elementary::Tan | Elementary::Own(_) => {
                Interval::REALS
            }
        };
        self.shaved(y, x.intersection(found))
    }

    /// Takes away parts at the ends of a range whose values all lie outside of others. The parts
    /// double while that works.
    fn shaved(&self, y: Interval, mut x: Interval) -> Interval {
        if x.is_empty() || !x.is_bounded() {
            return x;
        }
        for is_upper in [false, true] {
            let mut part = x.width() / 16.0;
            for _ in 0..8 {
                if part <= 1e-9 * x.magnitude().max(1e-9) || x.is_empty() {
                    break;
                }
                let end = match is_upper {
                    true => Interval::new((x.upper - part).max(x.lower), x.upper),
                    false => Interval::new(x.lower, (x.lower + part).min(x.upper)),
                };
                if !self.range(end).intersection(y).is_empty() {
                    part /= 4.0;
                    continue;
                }
                match is_upper {
                    true if end.lower <= x.lower => return Interval::new(x.upper, x.lower),
                    true => x.upper = end.lower,
                    false if end.upper >= x.upper => return Interval::new(x.upper, x.lower),
                    false => x.lower = end.upper,
                }
                part *= 2.0;
            }
        }
        x
    }
}

/// The values of an inverse function that rises, widened by what rounding can change.
fn inverse_of(y: Interval, of: fn(f64) -> f64) -> Interval {
    let value = |y: f64, sign: f64| {
        let value = of(y);
        if value.is_nan() { sign * f64::INFINITY } else { value }
    };
    let (lower, upper) = (value(y.lower, -1.0), value(y.upper, 1.0));
    let slack = |value: f64| 1e-14 * value.abs().max(1e-300);
    Interval::new(lower - slack(lower), upper + slack(upper))
}

/// The arguments of a power within a range.
fn roots(p: f64, y: Interval, x: Interval) -> Interval {
    if p == 0.0 || p == 1.0 {
        return if p == 1.0 { y } else { Interval::REALS };
    }
    let root = Elementary::Power(1.0 / p);
    // 1/p is rounded, which a root of a large number multiplies.
    let of = |y: Interval| {
        let found = root.range(y);
        let slack = |v: f64| {
            let of = if v > 0.0 && v.is_finite() { v.ln().abs() } else { 0.0 };
            v.abs() * f64::EPSILON * (8.0 + 4.0 * of * p.abs())
        };
        let lower =
            if found.lower.is_finite() { found.lower - slack(found.lower) } else { found.lower };
        let upper =
            if found.upper.is_finite() { found.upper + slack(found.upper) } else { found.upper };
        Interval::new(lower.max(0.0), upper)
    };
    let positive = Interval::new(0.0, f64::INFINITY);
    if !is_whole(p) || x.lower >= 0.0 {
        let y = y.intersection(positive);
        return if y.is_empty() { y } else { of(y) };
    }
    if is_odd(p) {
        let (above, below) = (y.intersection(positive), (-y).intersection(positive));
        return match (above.is_empty(), below.is_empty()) {
            (false, false) => (-of(below)).hull(of(above)),
            (false, true) => of(above),
            (true, false) => -of(below),
            (true, true) => above,
        };
    }
    let y = y.intersection(positive);
    if y.is_empty() {
        return y;
    }
    let sizes = of(y);
    match () {
        () if x.upper <= 0.0 => -sizes,
        () if x.lower > -sizes.lower => sizes,
        () if x.upper < sizes.lower => -sizes,
        () => (-sizes).hull(sizes),
    }
}
