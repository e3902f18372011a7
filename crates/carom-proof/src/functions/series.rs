//! Values of the elementary functions, by series whose remainders are bounded.
//!
//! Only sums, products, quotients and square roots of floats are computed, each rounded outward;
//! no function of the standard library is trusted.

use super::range::FloatRange;
use std::f64::consts::FRAC_PI_2;

/// ln 2 is `LN2_HIGH`, whose last 20 bits are 0, and a number in `LN2_LOW`.
const LN2_HIGH: f64 = 6.931_471_803_691_238e-1;
const LN2_LOW: FloatRange = FloatRange::new(1.908_214_929_270_587_7e-10, 1.908_214_929_270_588e-10);

/// π/2 is the sum of the first two, whose last 20 bits are 0, and a number in the third.
const HALF_PI: [f64; 2] = [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11];
const HALF_PI_REST: FloatRange = FloatRange::new(2.022_266_248_71e-21, 2.022_266_248_96e-21);

/// The range of π/2: the nearest float is below it.
pub(super) const RIGHT_ANGLE: FloatRange = FloatRange::new(FRAC_PI_2, FRAC_PI_2.next_up());

/// Angles beyond this are not reduced: their sines are from -1 to 1 (rad).
const LARGEST_ANGLE: f64 = 1e6;

/// Arguments of the exponential function between which no step leaves the normal floats.
const LARGEST_EXPONENT: f64 = 709.0;
const LEAST_EXPONENT: f64 = -700.0;

/// The sum of `terms[n] * z^n`, and of a remainder between these.
fn polynomial(terms: &[FloatRange], z: FloatRange, remainder: FloatRange) -> FloatRange {
    let zero = FloatRange::point(0.0);
    terms.iter().rev().fold(zero, |sum, term| sum * z + *term) + remainder
}

/// `first / step(1) / step(2) ...`: coefficients of a series, one after the other.
fn coefficients(count: u32, divisor: impl Fn(u32) -> f64) -> Vec<FloatRange> {
    let mut all = vec![FloatRange::point(1.0)];
    for n in 1..count {
        let last = all.last().copied().unwrap_or(FloatRange::point(1.0));
        all.push(last.divided_by(FloatRange::point(divisor(n))));
    }
    all
}

/// `e^x`.
pub(super) fn exp(x: f64) -> FloatRange {
    if x > LARGEST_EXPONENT {
        return FloatRange { upper: f64::INFINITY, ..exp(LARGEST_EXPONENT) };
    }
    if x < LEAST_EXPONENT {
        return FloatRange { lower: 0.0, ..exp(LEAST_EXPONENT) };
    }
    let k = (x * std::f64::consts::LOG2_E).round();
    // x = k ln 2 + rest; the product with `LN2_HIGH` has less than 53 bits, so that it is exact.
    let high = FloatRange::point(x) - FloatRange::point(k * LN2_HIGH);
    let rest = high - FloatRange::point(k) * LN2_LOW;
    // |rest| < 0.35, and 0.35^17 / 17! times e^0.35 is less than 1e-22.
    let terms = coefficients(17, f64::from);
    let value = polynomial(&terms, rest, FloatRange::new(-1e-22, 1e-22));
    let half = (k / 2.0).trunc();
    let value = value * power_of_two(half) * power_of_two(k - half);
    FloatRange { lower: value.lower.max(0.0), ..value }
}

/// `2^k` for a whole number between -1022 and 1023.
fn power_of_two(k: f64) -> FloatRange {
    FloatRange::point(f64::from_bits(((k as i64 + 1023) as u64) << 52))
}

/// The natural logarithm of a positive float.
pub(super) fn ln(x: f64) -> FloatRange {
    if x == f64::INFINITY {
        return FloatRange::point(f64::INFINITY);
    }
    // Floats below the normal ones are multiplied by 2^54, which is exact.
    let (scaled, shift) = if x < f64::MIN_POSITIVE { (x * 2f64.powi(54), 54) } else { (x, 0) };
    let bits = scaled.to_bits();
    let mut k = (bits >> 52) as i64 - 1023 - shift;
    let mut mantissa = f64::from_bits((bits & ((1 << 52) - 1)) | (1023 << 52));
    if mantissa > std::f64::consts::SQRT_2 {
        mantissa *= 0.5;
        k += 1;
    }
    let (mantissa, one) = (FloatRange::point(mantissa), FloatRange::point(1.0));
    // ln m = 2 (s + s^3 / 3 + s^5 / 5 + ...) with s = (m - 1) / (m + 1), |s| < 0.172; what follows
    // is less than s times 0.03^13 / 27 / 0.97 < 1e-20.
    let s = (mantissa - one).divided_by(mantissa + one);
    let odd = |n: u32| one.divided_by(FloatRange::point(f64::from(2 * n + 1)));
    let terms: Vec<FloatRange> = (0..13).map(odd).collect();
    let series = polynomial(&terms, s.square(), FloatRange::new(0.0, 1e-20)) * s;
    let k = k as f64;
    // 11 bits times 33.
    let whole = FloatRange::point(k * LN2_HIGH) + FloatRange::point(k) * LN2_LOW;
    let value = series * FloatRange::point(2.0);
    if k == 0.0 { value } else { whole + value }
}

/// The sine and the cosine of an angle in rad.
pub(super) fn sin_cos(x: f64) -> [FloatRange; 2] {
    let whole = FloatRange::new(-1.0, 1.0);
    if x.is_nan() || x.abs() > LARGEST_ANGLE {
        return [whole, whole];
    }
    let k = (x * std::f64::consts::FRAC_2_PI).round();
    // Products with numbers of 33 bits are exact.
    let rest = FloatRange::point(x) - FloatRange::point(k * HALF_PI[0]);
    let rest = rest - FloatRange::point(k * HALF_PI[1]) - FloatRange::point(k) * HALF_PI_REST;
    let square = rest.square();
    // |rest| < 0.79: the terms that follow are less than 0.79^23 / 23! < 1e-24 of alternating sign.
    let remainder = FloatRange::new(-1e-24, 1e-24);
    let sine = coefficients(11, |n| -f64::from(2 * n * (2 * n + 1)));
    let cosine = coefficients(12, |n| -f64::from(2 * n * (2 * n - 1)));
    let sine = polynomial(&sine, square, remainder) * rest;
    let cosine = polynomial(&cosine, square, remainder);
    let both = match (k as i64).rem_euclid(4) {
        0 => [sine, cosine],
        1 => [cosine, -sine],
        2 => [-sine, -cosine],
        _ => [-cosine, sine],
    };
    both.map(|value| value.within(whole))
}

/// The angle of a tangent, in rad, for a range of tangents.
pub(super) fn atan(x: FloatRange) -> FloatRange {
    FloatRange { lower: atan_of(x.lower).lower, upper: atan_of(x.upper).upper }
}

fn atan_of(x: f64) -> FloatRange {
    let one = FloatRange::point(1.0);
    if x < 0.0 {
        return -atan_of(-x);
    }
    if x == f64::INFINITY {
        return RIGHT_ANGLE;
    }
    let is_steep = x > 1.0;
    let own = FloatRange::point(x);
    let mut t = if is_steep { one.divided_by(own) } else { own };
    // The angle is halved twice: tan(a / 2) = t / (1 + sqrt(1 + t^2)).
    for _ in 0..2 {
        t = t.divided_by(one + (one + t.square()).sqrt());
    }
    // t < 0.199: what follows is less than t times 0.0397^15 / 31 < 1e-22, of either sign.
    let term = |n: u32| {
        let sign = if n.is_multiple_of(2) { 1.0 } else { -1.0 };
        FloatRange::point(sign).divided_by(FloatRange::point(f64::from(2 * n + 1)))
    };
    let terms: Vec<FloatRange> = (0..15).map(term).collect();
    let angle = polynomial(&terms, t.square(), FloatRange::new(-1e-22, 1e-22)) * t;
    let angle = angle * FloatRange::point(4.0);
    if is_steep { RIGHT_ANGLE - angle } else { angle }
}

/// The hyperbolic sine.
pub(super) fn sinh(x: f64) -> FloatRange {
    if x.abs() >= 1.0 {
        return (exp(x) - exp(-x)).half();
    }
    let own = FloatRange::point(x);
    // What follows is less than x times cosh(1) / 21! < 1e-19.
    let terms = coefficients(10, |n| f64::from(2 * n * (2 * n + 1)));
    polynomial(&terms, own.square(), FloatRange::new(0.0, 1e-19)) * own
}

/// The hyperbolic cosine.
pub(super) fn cosh(x: f64) -> FloatRange {
    let value = (exp(x) + exp(-x)).half();
    FloatRange { lower: value.lower.max(1.0), ..value }
}

/// The hyperbolic tangent.
pub(super) fn tanh(x: f64) -> FloatRange {
    let whole = FloatRange::new(-1.0, 1.0);
    match x.abs() {
        // 1 - tanh(20) = 2 / (e^40 + 1) < 1e-17.
        large if large > 20.0 && x > 0.0 => FloatRange::new(1.0 - 1e-15, 1.0),
        large if large > 20.0 => FloatRange::new(-1.0, -1.0 + 1e-15),
        _ => sinh(x).divided_by(cosh(x)).within(whole),
    }
}
