//! The built-in functions of one argument: values, slopes and curvature, enclosed by the checker
//! itself.
//!
//! `range` has the arithmetic, `series` the values at floats, `enclosure` decides whether a line is
//! below or above a function over a range.

mod enclosure;
mod range;
mod series;

pub(crate) use enclosure::{holds_above, holds_below};
pub(crate) use range::FloatRange;

use series::RIGHT_ANGLE;

/// A built-in function.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum BuiltIn {
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Exp,
    Ln,
    /// A power: for an exponent that is not whole, of arguments from 0 on; for a negative one, of
    /// arguments other than 0.
    Power(f64),
}

/// The sign of a second derivative over a range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Curvature {
    Convex,
    Concave,
    /// Neither, and a range of the second derivative.
    Mixed(FloatRange),
}

/// The whole exponent up to which powers are products.
const LARGEST_PRODUCT: f64 = 64.0;

impl BuiltIn {
    /// The function of a name, other than a power.
    pub(crate) fn named(name: &str) -> Option<Self> {
        Some(match name {
            "sin" => BuiltIn::Sin,
            "cos" => BuiltIn::Cos,
            "tan" => BuiltIn::Tan,
            "asin" => BuiltIn::Asin,
            "acos" => BuiltIn::Acos,
            "atan" => BuiltIn::Atan,
            "sinh" => BuiltIn::Sinh,
            "cosh" => BuiltIn::Cosh,
            "tanh" => BuiltIn::Tanh,
            "exp" => BuiltIn::Exp,
            "ln" => BuiltIn::Ln,
            _ => return None,
        })
    }

    /// The arguments that have a value; those at the ends may have none.
    pub(crate) fn domain(self) -> FloatRange {
        match self {
            BuiltIn::Asin | BuiltIn::Acos => FloatRange::new(-1.0, 1.0),
            BuiltIn::Ln => FloatRange::new(0.0, f64::INFINITY),
            BuiltIn::Power(p) if p.fract() != 0.0 => FloatRange::new(0.0, f64::INFINITY),
            _ => FloatRange::ALL,
        }
    }

    /// The value at an argument of the domain; at an end without a value, and at an infinite one,
    /// the limit.
    fn value(self, x: f64) -> FloatRange {
        let own = FloatRange::point(x);
        match self {
            BuiltIn::Sin => series::sin_cos(x)[0],
            BuiltIn::Cos => series::sin_cos(x)[1],
            BuiltIn::Tan => {
                let [sine, cosine] = series::sin_cos(x);
                sine.divided_by(cosine)
            }
            BuiltIn::Asin => arc_sine(own),
            BuiltIn::Acos => RIGHT_ANGLE - arc_sine(own),
            BuiltIn::Atan => series::atan(own),
            BuiltIn::Sinh => series::sinh(x),
            BuiltIn::Cosh => series::cosh(x),
            BuiltIn::Tanh => series::tanh(x),
            BuiltIn::Exp => series::exp(x),
            BuiltIn::Ln if x <= 0.0 => FloatRange::point(f64::NEG_INFINITY),
            BuiltIn::Ln => series::ln(x),
            BuiltIn::Power(p) => power(x, p),
        }
    }

    /// The value in floats, for the judgement of points; NaN outside the domain.
    pub(crate) fn value_near(self, x: f64) -> f64 {
        let (domain, value) = (self.domain(), self.value(x));
        let has_value = x >= domain.lower && x <= domain.upper && value.is_bounded();
        if has_value { value.middle() } else { f64::NAN }
    }

    /// The derivative at an argument inside the domain; all numbers if nothing is known.
    fn slope(self, x: f64) -> FloatRange {
        let (own, one) = (FloatRange::point(x), FloatRange::point(1.0));
        match self {
            BuiltIn::Sin => series::sin_cos(x)[1],
            BuiltIn::Cos => -series::sin_cos(x)[0],
            BuiltIn::Tan => one + self.value(x).square(),
            BuiltIn::Asin => one.divided_by(((one - own) * (one + own)).sqrt()),
            BuiltIn::Acos => -BuiltIn::Asin.slope(x),
            BuiltIn::Atan => one.divided_by(one + own.square()),
            BuiltIn::Sinh => series::cosh(x),
            BuiltIn::Cosh => series::sinh(x),
            BuiltIn::Tanh => one.divided_by(series::cosh(x).square()),
            BuiltIn::Exp => series::exp(x),
            BuiltIn::Ln => one.divided_by(own),
            BuiltIn::Power(0.0) => FloatRange::point(0.0),
            BuiltIn::Power(1.0) => one,
            BuiltIn::Power(p) => FloatRange::point(p) * power_less_one(x, p),
        }
    }

    /// All values over a range of the domain, which has no pole inside.
    fn values(self, x: FloatRange) -> FloatRange {
        let ends = self.value(x.lower).hull(self.value(x.upper));
        match self {
            BuiltIn::Sin => with_turns(ends, x, 0.5),
            BuiltIn::Cos => with_turns(ends, x, 0.0),
            BuiltIn::Cosh if x.has_inside(0.0) => ends.hull(FloatRange::point(1.0)),
            BuiltIn::Power(p) if is_even(p) && x.has_inside(0.0) => ends.hull(self.value(0.0)),
            _ => ends,
        }
    }

    /// Whether the function is infinite, or may be, inside a range.
    fn has_pole_in(self, x: FloatRange) -> bool {
        match self {
            BuiltIn::Tan => turns(x, 0.5).is_none_or(|(first, last)| first <= last),
            BuiltIn::Power(p) => p < 0.0 && x.has_inside(0.0),
            _ => false,
        }
    }

    /// Whether the curvature changes its sign at 0, and nowhere else.
    fn bends_at_zero(self) -> bool {
        use BuiltIn::{Acos, Asin, Atan, Power, Sinh, Tanh};
        match self {
            Asin | Acos | Atan | Sinh | Tanh => true,
            Power(p) => p.fract() == 0.0 && !is_even(p),
            _ => false,
        }
    }

    /// The curvature over a range without a pole, which 0 is not inside of if the curvature changes
    /// its sign there, and nowhere else.
    fn curvature(self, x: FloatRange) -> Curvature {
        use BuiltIn::{Acos, Asin, Atan, Cos, Cosh, Exp, Ln, Power, Sin, Sinh, Tan, Tanh};
        let is_right = x.lower >= 0.0;
        let is_convex = match self {
            Sin | Cos => {
                let second = -self.values(x);
                match (second.lower >= 0.0, second.upper <= 0.0) {
                    (true, _) => true,
                    (_, true) => false,
                    _ => return Curvature::Mixed(second),
                }
            }
            // 2 t (1 + t²) at the tangent t, which has no sign of x beyond the first branch.
            Tan => {
                let tangent = self.values(x);
                match (tangent.lower >= 0.0, tangent.upper <= 0.0) {
                    (true, _) => true,
                    (_, true) => false,
                    _ => {
                        let one = FloatRange::point(1.0);
                        let two = FloatRange::point(2.0);
                        return Curvature::Mixed(two * tangent * (one + tangent.square()));
                    }
                }
            }
            Exp | Cosh => true,
            Ln => false,
            Asin | Sinh => is_right,
            Acos | Atan | Tanh => !is_right,
            // p (p - 1) x^(p - 2), whose last factor has the sign of x if p is odd.
            Power(p) => {
                let is_positive = p * (p - 1.0) >= 0.0;
                is_positive == (is_right || is_even(p) || p == 1.0)
            }
        };
        if is_convex { Curvature::Convex } else { Curvature::Concave }
    }

    /// The derivative in floats, which nothing rests on.
    fn guessed_slope(self, x: f64) -> f64 {
        match self {
            BuiltIn::Sin => x.cos(),
            BuiltIn::Cos => -x.sin(),
            BuiltIn::Tan => 1.0 + x.tan() * x.tan(),
            BuiltIn::Asin => 1.0 / ((1.0 - x) * (1.0 + x)).sqrt(),
            BuiltIn::Acos => -1.0 / ((1.0 - x) * (1.0 + x)).sqrt(),
            BuiltIn::Atan => 1.0 / (1.0 + x * x),
            BuiltIn::Sinh => x.cosh(),
            BuiltIn::Cosh => x.sinh(),
            BuiltIn::Tanh => 1.0 - x.tanh() * x.tanh(),
            BuiltIn::Exp => x.exp(),
            BuiltIn::Ln => 1.0 / x,
            BuiltIn::Power(p) => p * x.powf(p - 1.0),
        }
    }
}

fn is_even(p: f64) -> bool {
    (p / 2.0).fract() == 0.0
}

/// The angle of a sine: twice that of the tangent x / (1 + sqrt(1 - x²)).
fn arc_sine(x: FloatRange) -> FloatRange {
    let one = FloatRange::point(1.0);
    let x = x.within(FloatRange::new(-1.0, 1.0));
    let root = ((one - x) * (one + x)).sqrt();
    series::atan(x.divided_by(one + root)) * FloatRange::point(2.0)
}

/// The numbers n from the first to the last for which (n + part) π may be in a range; `None` if
/// there may be any.
fn turns(x: FloatRange, part: f64) -> Option<(f64, f64)> {
    if !(x.lower.abs() <= 1e6 && x.upper.abs() <= 1e6) {
        return None;
    }
    // More than the rounding of the quotients.
    let spare = 1e-12 * (1.0 + x.lower.abs().max(x.upper.abs()));
    let first = (x.lower / std::f64::consts::PI - part - spare).ceil();
    let last = (x.upper / std::f64::consts::PI - part + spare).floor();
    Some((first, last))
}

/// The values of a sine or cosine, given those at the ends: 1 or -1 where it turns.
fn with_turns(ends: FloatRange, x: FloatRange, part: f64) -> FloatRange {
    let whole = FloatRange::new(-1.0, 1.0);
    let Some((first, last)) = turns(x, part) else { return whole };
    match (first <= last, first < last) {
        (_, true) => whole,
        (false, _) => ends,
        _ if is_even(first) => ends.hull(FloatRange::point(1.0)),
        _ => ends.hull(FloatRange::point(-1.0)),
    }
}

/// `x^p`; the limit at ends of the domain.
fn power(x: f64, p: f64) -> FloatRange {
    let own = FloatRange::point(x);
    let is_whole = p.fract() == 0.0;
    let infinite = FloatRange::point(f64::INFINITY);
    if p == 0.0 {
        return FloatRange::point(1.0);
    }
    if x < 0.0 {
        let positive = power(-x, p);
        return match (is_whole, is_even(p)) {
            (false, _) => FloatRange::ALL,
            (true, true) => positive,
            (true, false) => -positive,
        };
    }
    if x == 0.0 && p < 0.0 && is_whole && !is_even(p) {
        // The limit depends on the side.
        return FloatRange::ALL;
    }
    if x == 0.0 || x == f64::INFINITY {
        return if (x == 0.0) == (p > 0.0) { FloatRange::point(0.0) } else { infinite };
    }
    let value = match p {
        1.0 => return own,
        0.5 => own.sqrt(),
        _ if is_whole && p.abs() <= LARGEST_PRODUCT => {
            let (mut value, mut square) = (FloatRange::point(1.0), own);
            let mut left = p.abs() as u32;
            while left > 0 {
                if left % 2 == 1 {
                    value = value * square;
                }
                square = square.square();
                left /= 2;
            }
            if p > 0.0 { value } else { FloatRange::point(1.0).divided_by(value) }
        }
        _ => {
            let exponent = series::ln(x) * FloatRange::point(p);
            let ends = (series::exp(exponent.lower), series::exp(exponent.upper));
            FloatRange { lower: ends.0.lower, upper: ends.1.upper }
        }
    };
    FloatRange { lower: value.lower.max(0.0), ..value }
}

/// `x^(p - 1)` where `p - 1` may be rounded: as a quotient then.
fn power_less_one(x: f64, p: f64) -> FloatRange {
    let less = p - 1.0;
    if less + 1.0 == p && (p.fract() == 0.0 || (0.5..=2.0).contains(&p)) {
        // The difference is exact.
        return power(x, less);
    }
    power(x, p).divided_by(FloatRange::point(x))
}
