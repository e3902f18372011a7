//! Lines below and above a function over a range, tight at a point.
//!
//! The slope is chosen in floats: that of the tangent where the function is convex, of the chord
//! where it is concave, and of the convex hull of samples where it is both. Any slope will do for
//! the proof: the offset is the least difference between the function and the line through 0,
//! bounded piece by piece. A concave piece is least at an end, and a convex one is above its
//! tangent at any point.

use super::curvature::CurvatureSign;
use super::function::Elementary;
use crate::interval::Interval;
use crate::rounding::add_down;

/// Samples of a function that is convex in a part of the range only.
const HULL_SAMPLES: usize = 16;

/// Halvings that look for the point of a convex piece at which a slope is reached.
const SLOPE_HALVINGS: usize = 30;

/// The distance from an end at which the slope is infinite, relative to the range (no unit).
const SLOPE_INSIDE: f64 = 1e-6;

/// The line `slope * x + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SupportLine {
    /// In the unit of the value per unit of the argument.
    pub slope: f64,
    /// In the unit of the value.
    pub offset: f64,
}

impl Elementary {
    /// A line that is nowhere above the function (or nowhere below it) for arguments of a range,
    /// and tight at one of them as far as a line can be; `None` if there is no such line.
    ///
    /// # Arguments
    ///
    /// * `x`: the range; parts outside the domain do not count.
    /// * `at`: the argument of the range at which the line is to be tight.
    /// * `is_below`: which of the two.
    #[doc(hidden)]
    pub fn line(&self, x: Interval, at: f64, is_below: bool) -> Option<SupportLine> {
        let x = x.intersection(self.domain());
        if x.is_empty() || self.has_pole_in(x) {
            return None;
        }
        let sign = if is_below { 1.0 } else { -1.0 };
        let of = Signed { function: self, sign };
        let pieces = of.pieces(x);
        let slope = of.slope_at(x, x.nearest(at), &pieces);
        let line = slope.and_then(|slope| of.below(slope, x.nearest(at), &pieces));
        let line = line.or_else(|| {
            let least = of.range(x).lower;
            least.is_finite().then_some(SupportLine { slope: 0.0, offset: least })
        })?;
        Some(SupportLine { slope: sign * line.slope, offset: sign * line.offset })
    }
}

/// A function or its negative.
struct Signed<'a> {
    function: &'a Elementary,
    sign: f64,
}

impl Signed<'_> {
    fn value(&self, x: f64) -> f64 {
        self.sign * self.function.value(x)
    }

    fn derivative(&self, x: f64) -> f64 {
        self.sign * self.function.derivative(x)
    }

    fn range(&self, x: Interval) -> Interval {
        self.function.range(x) * self.sign
    }

    fn pieces(&self, x: Interval) -> Vec<(Interval, CurvatureSign)> {
        let mut pieces = self.function.pieces(x);
        if self.sign < 0.0 {
            for (_, curvature) in &mut pieces {
                *curvature = match curvature {
                    CurvatureSign::Convex => CurvatureSign::Concave,
                    CurvatureSign::Concave => CurvatureSign::Convex,
                    CurvatureSign::Unknown => CurvatureSign::Unknown,
                };
            }
        }
        pieces
    }

    /// The slope of a line that is tight at a point.
    fn slope_at(&self, x: Interval, at: f64, pieces: &[(Interval, CurvatureSign)]) -> Option<f64> {
        let slope = match pieces {
            [(_, CurvatureSign::Convex)] => self.tangent(x, at),
            [(_, CurvatureSign::Concave)] => {
                let rise = self.value(x.upper) - self.value(x.lower);
                let chord = rise / (x.upper - x.lower);
                if x.upper > x.lower { chord } else { self.tangent(x, at) }
            }
            _ if !x.is_bounded() => self.tangent(x, at),
            _ => self.hull_slope(x, at, pieces),
        };
        slope.is_finite().then_some(slope)
    }

    /// The derivative at a point, or near it if it is infinite there.
    fn tangent(&self, x: Interval, at: f64) -> f64 {
        let slope = self.derivative(at);
        if slope.is_finite() {
            return slope;
        }
        let step = if x.is_bounded() { SLOPE_INSIDE * x.width() } else { SLOPE_INSIDE };
        let inside = if at <= x.lower { at + step } else { at - step };
        self.derivative(inside)
    }

    /// The slope of the convex hull of samples at a point.
    fn hull_slope(&self, x: Interval, at: f64, pieces: &[(Interval, CurvatureSign)]) -> f64 {
        let step = (x.upper - x.lower) / HULL_SAMPLES as f64;
        let mut places: Vec<f64> = (0..HULL_SAMPLES).map(|k| x.lower + k as f64 * step).collect();
        places.extend([x.upper, at]);
        places.extend(pieces.iter().map(|(piece, _)| piece.upper));
        places.sort_by(f64::total_cmp);
        places.dedup();
        let mut hull: Vec<(f64, f64)> = Vec::with_capacity(places.len());
        for p in places {
            let next = (p, self.value(p));
            if !next.1.is_finite() {
                continue;
            }
            while let [.., a, b] = hull.as_slice() {
                let is_above = (b.1 - a.1) * (next.0 - a.0) >= (next.1 - a.1) * (b.0 - a.0);
                if !is_above {
                    break;
                }
                hull.pop();
            }
            hull.push(next);
        }
        let is_convex = pieces
            .iter()
            .any(|(piece, curvature)| *curvature == CurvatureSign::Convex && piece.contains(at));
        // A sample on the hull, in a convex piece: the tangent is the envelope.
        if is_convex && hull.iter().any(|(p, _)| *p == at) {
            return self.tangent(x, at);
        }
        let after = hull.partition_point(|(p, _)| *p < at).clamp(1, hull.len().max(2) - 1);
        match (hull.get(after - 1), hull.get(after)) {
            (Some(a), Some(b)) => (b.1 - a.1) / (b.0 - a.0),
            _ => self.tangent(x, at),
        }
    }

    /// The line of a slope that is nowhere above the function.
    fn below(
        &self,
        slope: f64,
        at: f64,
        pieces: &[(Interval, CurvatureSign)],
    ) -> Option<SupportLine> {
        let mut offset = f64::INFINITY;
        for (piece, curvature) in pieces {
            let least = match curvature {
                CurvatureSign::Concave => {
                    self.difference(piece.lower, slope).min(self.difference(piece.upper, slope))
                }
                CurvatureSign::Convex => self.least_convex(*piece, slope, at),
                CurvatureSign::Unknown => {
                    let line = *piece * slope;
                    add_down(self.range(*piece).lower, -line.upper)
                }
            };
            offset = if least.is_nan() { f64::NEG_INFINITY } else { offset.min(least) };
        }
        offset.is_finite().then_some(SupportLine { slope, offset })
    }

    /// `f(x) - slope x` at a point, rounded down; -inf at infinity.
    fn difference(&self, x: f64, slope: f64) -> f64 {
        if !x.is_finite() {
            return f64::NEG_INFINITY;
        }
        let line = Interval::point(x) * slope;
        add_down(self.range(Interval::point(x)).lower, -line.upper)
    }

    /// A lower bound on `f(x) - slope x` over a convex piece.
    fn least_convex(&self, piece: Interval, slope: f64, at: f64) -> f64 {
        let place = self.place_of(piece, slope, at);
        let value = self.difference(place, slope);
        let own = self.function.slope(place) * self.sign;
        let missed = own + Interval::point(-slope);
        // f(x) - slope x >= value + (f'(place) - slope) (x - place) for each x of the piece.
        let to = |end: f64, missed: f64| match (end - place == 0.0, missed == 0.0) {
            (true, _) | (_, true) => 0.0,
            _ => {
                let reach = Interval::new((end - place).next_down(), (end - place).next_up());
                (reach * missed).lower
            }
        };
        let fall = to(piece.upper, missed.lower).min(to(piece.lower, missed.upper)).min(0.0);
        add_down(value, fall)
    }

    /// The point of a convex piece at which the derivative is nearest to a slope.
    fn place_of(&self, piece: Interval, slope: f64, at: f64) -> f64 {
        if piece.contains(at) && self.derivative(at) == slope {
            return at;
        }
        let (mut low, mut high) = (piece.lower, piece.upper);
        // NaN counts as steep at an end.
        if low.is_finite() && self.derivative(low) >= slope {
            return low;
        }
        if high.is_finite() && self.derivative(high) <= slope {
            return high;
        }
        let reach = |from: f64, side: f64| from + side * from.abs().max(1.0) * 1e3;
        if !low.is_finite() {
            low = reach(high.min(at), -1.0);
        }
        if !high.is_finite() {
            high = reach(low.max(at), 1.0);
        }
        for _ in 0..SLOPE_HALVINGS {
            let middle = 0.5 * low + 0.5 * high;
            if self.derivative(middle) < slope { low = middle } else { high = middle }
        }
        0.5 * low + 0.5 * high
    }
}
