//! The functions: their values, derivatives and domains.

use std::fmt;

use super::smooth::OwnFunction;
use crate::interval::Interval;

/// The relative error that a value of a function of the standard library may have (no unit).
pub(super) const VALUE_ROUNDING: f64 = 4.0 * f64::EPSILON;

/// A function of one variable, whose argument and value have no unit, if it is not a power.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Elementary {
    /// The sine of an angle in rad.
    Sin,
    /// The cosine of an angle in rad.
    Cos,
    /// The tangent of an angle in rad.
    Tan,
    /// The angle of a sine, in rad, from -π/2 to π/2.
    Asin,
    /// The angle of a cosine, in rad, from 0 to π.
    Acos,
    /// The angle of a tangent, in rad, between -π/2 and π/2.
    Atan,
    /// The hyperbolic sine.
    Sinh,
    /// The hyperbolic cosine.
    Cosh,
    /// The hyperbolic tangent.
    Tanh,
    /// The exponential function.
    Exp,
    /// The natural logarithm.
    Ln,
    /// A power with a constant exponent: for an exponent that is not whole, of arguments from 0
    /// on; for a negative one, of arguments other than 0.
    Power(f64),
    /// A function of one's own.
    Own(OwnFunction),
}

impl Elementary {
    /// The value at an argument; NaN outside the domain.
    pub fn value(&self, x: f64) -> f64 {
        match self {
            Elementary::Sin => x.sin(),
            Elementary::Cos => x.cos(),
            Elementary::Tan => x.tan(),
            Elementary::Asin => x.asin(),
            Elementary::Acos => x.acos(),
            Elementary::Atan => x.atan(),
            Elementary::Sinh => x.sinh(),
            Elementary::Cosh => x.cosh(),
            Elementary::Tanh => x.tanh(),
            Elementary::Exp => x.exp(),
            Elementary::Ln => x.ln(),
            Elementary::Power(p) => power(x, *p),
            Elementary::Own(own) => own.value(x),
        }
    }

    /// The derivative at an argument; infinite or NaN where there is none.
    pub fn derivative(&self, x: f64) -> f64 {
        match self {
            Elementary::Sin => x.cos(),
            Elementary::Cos => -x.sin(),
            Elementary::Tan => 1.0 + x.tan().powi(2),
            Elementary::Asin => 1.0 / ((1.0 - x) * (1.0 + x)).sqrt(),
            Elementary::Acos => -1.0 / ((1.0 - x) * (1.0 + x)).sqrt(),
            Elementary::Atan => 1.0 / (1.0 + x * x),
            Elementary::Sinh => x.cosh(),
            Elementary::Cosh => x.sinh(),
            Elementary::Tanh => 1.0 / x.cosh().powi(2),
            Elementary::Exp => x.exp(),
            Elementary::Ln => 1.0 / x,
            Elementary::Power(p) if *p == 1.0 => 1.0,
            Elementary::Power(p) => p * power(x, p - 1.0),
            Elementary::Own(own) => own.derivative(x),
        }
    }

    /// The second derivative at an argument, for local methods only; a difference for a function of
    /// one's own.
    #[doc(hidden)]
    pub fn second_derivative(&self, x: f64) -> f64 {
        match self {
            Elementary::Sin => -x.sin(),
            Elementary::Cos => -x.cos(),
            Elementary::Tan => 2.0 * x.tan() * (1.0 + x.tan().powi(2)),
            Elementary::Asin => x * ((1.0 - x) * (1.0 + x)).powf(-1.5),
            Elementary::Acos => -x * ((1.0 - x) * (1.0 + x)).powf(-1.5),
            Elementary::Atan => -2.0 * x / (1.0 + x * x).powi(2),
            Elementary::Sinh => x.sinh(),
            Elementary::Cosh => x.cosh(),
            Elementary::Tanh => -2.0 * x.tanh() / x.cosh().powi(2),
            Elementary::Exp => x.exp(),
            Elementary::Ln => -1.0 / (x * x),
            Elementary::Power(p) if *p == 1.0 => 0.0,
            Elementary::Power(p) if *p == 2.0 => 2.0,
            Elementary::Power(p) => p * (p - 1.0) * power(x, p - 2.0),
            Elementary::Own(own) => {
                let step = 1e-5 * x.abs().max(1.0);
                (own.derivative(x + step) - own.derivative(x - step)) / (2.0 * step)
            }
        }
    }

    /// The derivative at an argument, with its rounding.
    pub(super) fn slope(&self, x: f64) -> Interval {
        if let Elementary::Own(own) = self {
            return own.function().slope_range(Interval::point(x));
        }
        let slope = self.derivative(x);
        // Some ten operations, none of which cancels.
        let error = 32.0 * f64::EPSILON * slope.abs() + f64::MIN_POSITIVE;
        Interval::new((slope - error).next_down(), (slope + error).next_up())
    }

    /// The arguments at which the function has a value.
    pub fn domain(&self) -> Interval {
        match self {
            Elementary::Asin | Elementary::Acos => Interval::new(-1.0, 1.0),
            Elementary::Ln => Interval::new(0.0, f64::INFINITY),
            Elementary::Power(p) if !is_whole(*p) => Interval::new(0.0, f64::INFINITY),
            Elementary::Own(own) => own.function().domain(),
            _ => Interval::REALS,
        }
    }

    /// The function of an argument that is given as text.
    pub(crate) fn text(&self, of: &str) -> String {
        match self {
            Elementary::Power(2.0) => format!("({of})²"),
            Elementary::Power(0.5) => format!("sqrt({of})"),
            Elementary::Power(p) => format!("({of})^{p}"),
            other => format!("{other}({of})"),
        }
    }
}

impl fmt::Display for Elementary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Elementary::Sin => "sin",
            Elementary::Cos => "cos",
            Elementary::Tan => "tan",
            Elementary::Asin => "asin",
            Elementary::Acos => "acos",
            Elementary::Atan => "atan",
            Elementary::Sinh => "sinh",
            Elementary::Cosh => "cosh",
            Elementary::Tanh => "tanh",
            Elementary::Exp => "exp",
            Elementary::Ln => "ln",
            Elementary::Power(p) => return write!(f, "power {p}"),
            Elementary::Own(own) => own.function().name(),
        })
    }
}

/// Whether a number is whole.
pub(super) fn is_whole(p: f64) -> bool {
    p.fract() == 0.0
}

/// Whether an exponent is odd.
pub(super) fn is_odd(p: f64) -> bool {
    is_whole(p) && (p / 2.0).fract() != 0.0
}

pub(super) fn power(x: f64, p: f64) -> f64 {
    match p {
        2.0 => x * x,
        0.5 => x.sqrt(),
        -1.0 => 1.0 / x,
        _ => x.powf(p),
    }
}
