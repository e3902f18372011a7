//! Where a function is convex, and where it is concave.

use std::f64::consts::{FRAC_PI_2, PI};

use super::function::{Elementary, is_odd, is_whole};
use crate::interval::Interval;

/// The sign of the second derivative over a range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CurvatureSign {
    /// At least 0.
    Convex,
    /// At most 0.
    Concave,
    /// Not known, or both.
    Unknown,
}

/// Most pieces of a range; what is left is a piece of unknown curvature.
const MAX_PIECES: usize = 12;

/// The half width of the piece around an inflection that floats only approximate, relative (no
/// unit).
const INFLECTION: f64 = 1e-14;

impl Elementary {
    /// The parts of a range inside the domain, in order, with the curvature of each.
    pub(super) fn pieces(&self, x: Interval) -> Vec<(Interval, CurvatureSign)> {
        use CurvatureSign::{Concave, Convex};
        match self {
            Elementary::Exp | Elementary::Cosh => vec![(x, Convex)],
            Elementary::Ln => vec![(x, Concave)],
            Elementary::Sin => alternating(x, 0.0, PI, Concave),
            Elementary::Cos => alternating(x, -FRAC_PI_2, PI, Concave),
            Elementary::Tan => match self.has_pole_in(x) {
                true => vec![(x, CurvatureSign::Unknown)],
                false => {
                    // Concave to the left of a multiple of π and convex to the right of it.
                    let middle =
                        if x.is_bounded() { (0.5 * (x.lower + x.upper) / PI).round() } else { 0.0 };
                    split(x, middle * PI, Concave, Convex)
                }
            },
            Elementary::Asin | Elementary::Sinh => split(x, 0.0, Concave, Convex),
            Elementary::Acos | Elementary::Atan | Elementary::Tanh => {
                split(x, 0.0, Convex, Concave)
            }
            Elementary::Power(p) => {
                let above = if *p * (*p - 1.0) >= 0.0 { Convex } else { Concave };
                match () {
                    () if !is_whole(*p) => vec![(x, above)],
                    () if *p == 0.0 || *p == 1.0 => vec![(x, Convex)],
                    () if !is_odd(*p) => vec![(x, Convex)],
                    () => split(x, 0.0, Concave, Convex),
                }
            }
            Elementary::Own(own) => {
                let mut pieces = Vec::new();
                bisected(x, &mut pieces, &|x| sign_of(own.function().curvature_range(x)));
                pieces
            }
        }
    }
}

/// The sign of a second derivative.
fn sign_of(range: Interval) -> CurvatureSign {
    match () {
        () if range.lower >= 0.0 => CurvatureSign::Convex,
        () if range.upper <= 0.0 => CurvatureSign::Concave,
        () => CurvatureSign::Unknown,
    }
}

/// A range at an inflection, which floats only approximate if it is not 0.
fn split(
    x: Interval,
    at: f64,
    left: CurvatureSign,
    right: CurvatureSign,
) -> Vec<(Interval, CurvatureSign)> {
    let slack = if at == 0.0 { 0.0 } else { INFLECTION * at.abs() };
    match () {
        () if x.upper <= at - slack => vec![(x, left)],
        () if x.lower >= at + slack => vec![(x, right)],
        () => {
            let mut pieces = Vec::with_capacity(3);
            let (from, to) = ((at - slack).max(x.lower), (at + slack).min(x.upper));
            if x.lower < from {
                pieces.push((Interval::new(x.lower, from), left));
            }
            if from < to {
                pieces.push((Interval::new(from, to), CurvatureSign::Unknown));
            }
            if to < x.upper {
                pieces.push((Interval::new(to, x.upper), right));
            }
            pieces
        }
    }
}

/// A range with an inflection at each `first + k * period`, of the given curvature from `first` on.
fn alternating(
    x: Interval,
    first: f64,
    period: f64,
    from_first: CurvatureSign,
) -> Vec<(Interval, CurvatureSign)> {
    let count = x.width() / period;
    if !x.is_bounded() || x.magnitude() > 1e8 || count > MAX_PIECES as f64 / 2.0 {
        return vec![(x, CurvatureSign::Unknown)];
    }
    let other = match from_first {
        CurvatureSign::Convex => CurvatureSign::Concave,
        _ => CurvatureSign::Convex,
    };
    let of = |k: f64| if (k / 2.0).fract() == 0.0 { from_first } else { other };
    let mut k = ((x.lower - first) / period).floor();
    let mut pieces = Vec::new();
    let mut rest = x;
    while rest.lower <= rest.upper {
        let end = first + (k + 1.0) * period;
        let parts = split(rest, end, of(k), of(k + 1.0));
        let Some((last, _)) = parts.last() else { break };
        let is_last = end + INFLECTION * end.abs() >= rest.upper || parts.len() == 1;
        if is_last {
            pieces.extend(parts);
            break;
        }
        rest = *last;
        pieces.extend(parts.into_iter().rev().skip(1).collect::<Vec<_>>().into_iter().rev());
        k += 1.0;
    }
    pieces
}

/// Halves a range until the curvature of each part is known, or there are too many.
fn bisected(
    x: Interval,
    pieces: &mut Vec<(Interval, CurvatureSign)>,
    curvature: &dyn Fn(Interval) -> CurvatureSign,
) {
    let own = curvature(x);
    let is_small = x.width() <= 1e-9 * x.magnitude().max(1e-9);
    if own != CurvatureSign::Unknown || !x.is_bounded() || is_small || pieces.len() >= MAX_PIECES {
        match pieces.last_mut() {
            Some((last, same)) if *same == own && own != CurvatureSign::Unknown => {
                last.upper = x.upper;
            }
            _ => pieces.push((x, own)),
        }
        return;
    }
    let middle = 0.5 * x.lower + 0.5 * x.upper;
    bisected(Interval::new(x.lower, middle), pieces, curvature);
    bisected(Interval::new(middle, x.upper), pieces, curvature);
}
