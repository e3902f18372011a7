//! Whether a line is below or above a function over a range.
//!
//! The difference between function and line has the function's curvature. Where it is concave, it
//! is least at an end of the range. Where it is convex, it is above its tangent at any point, which
//! is least at an end, too; the point at which the slope is nearly 0 serves best. Where the
//! curvature has no sign, the difference is at least its tangent in the middle and half the least
//! second derivative times the square of the distance; if that is not enough, the range is halved.

use super::{BuiltIn, Curvature, FloatRange};

/// Most halvings of a range, and most parts that are looked at.
const MOST_HALVINGS: u32 = 60;
const MOST_PARTS: u32 = 4000;

/// Steps towards the point with a slope.
const MOST_GUESSES: u32 = 70;

/// Whether `f(x) - slope x >= offset` (or `> offset`, if it is strict) for all x of a range that
/// have a value.
pub(crate) fn holds_below(
    function: BuiltIn,
    x: FloatRange,
    line: (f64, f64),
    is_strict: bool,
) -> bool {
    let own = Difference { function, sign: 1.0, slope: line.0, offset: line.1, is_strict };
    own.is_positive(x)
}

/// Whether `f(x) - slope x <= offset` (or `< offset`, if it is strict) for all x of a range that
/// have a value.
pub(crate) fn holds_above(
    function: BuiltIn,
    x: FloatRange,
    line: (f64, f64),
    is_strict: bool,
) -> bool {
    let own = Difference { function, sign: -1.0, slope: -line.0, offset: -line.1, is_strict };
    own.is_positive(x)
}

/// `sign f(x) - slope x - offset`.
struct Difference {
    function: BuiltIn,
    sign: f64,
    slope: f64,
    offset: f64,
    is_strict: bool,
}

impl Difference {
    fn is_positive(&self, x: FloatRange) -> bool {
        let x = x.within(self.function.domain());
        if x.is_empty() {
            return true;
        }
        if self.function.has_pole_in(x) {
            return false;
        }
        let mut parts = match self.function.bends_at_zero() && x.has_inside(0.0) {
            true => vec![(FloatRange::new(x.lower, 0.0), 0), (FloatRange::new(0.0, x.upper), 0)],
            false => vec![(x, 0)],
        };
        let mut looked_at = 0;
        while let Some((part, halvings)) = parts.pop() {
            looked_at += 1;
            match self.part(part) {
                Some(true) => {}
                Some(false) => return false,
                None => {
                    let middle = part.middle();
                    let is_done = halvings >= MOST_HALVINGS || looked_at >= MOST_PARTS;
                    if is_done || !part.has_inside(middle) {
                        return false;
                    }
                    parts.push((FloatRange::new(middle, part.upper), halvings + 1));
                    parts.push((FloatRange::new(part.lower, middle), halvings + 1));
                }
            }
        }
        true
    }

    /// Whether it holds in a part; `None` if parts of that have to be looked at.
    fn part(&self, x: FloatRange) -> Option<bool> {
        let rough = match self.slope == 0.0 {
            true => self.values(x),
            false => self.values(x) - x * FloatRange::point(self.slope),
        };
        if self.is_enough(rough) {
            return Some(true);
        }
        match (self.function.curvature(x), self.sign > 0.0) {
            (Curvature::Concave, true) | (Curvature::Convex, false) => {
                let holds = [x.lower, x.upper].iter().all(|&end| self.is_enough(self.at(end)));
                Some(holds)
            }
            (Curvature::Convex, true) | (Curvature::Concave, false) => {
                Some(self.is_above_tangent(x, self.flat_place(x), None))
            }
            (Curvature::Mixed(second), _) => {
                if !x.is_bounded() {
                    return Some(false);
                }
                let second = if self.sign > 0.0 { second } else { -second };
                self.is_above_tangent(x, x.middle(), Some(second.lower)).then_some(true)
            }
        }
    }

    /// Whether a lower bound of the difference is enough. The exact 0 of a constant line counts.
    fn is_enough(&self, difference: FloatRange) -> bool {
        if self.is_strict { difference.lower > 0.0 } else { difference.lower >= 0.0 }
    }

    fn values(&self, x: FloatRange) -> FloatRange {
        let values = self.function.values(x);
        self.above_offset(if self.sign > 0.0 { values } else { -values })
    }

    /// The value less the offset: 0 from both sides if they are the same float.
    fn above_offset(&self, value: FloatRange) -> FloatRange {
        let own = value - FloatRange::point(self.offset);
        if value.lower == self.offset { FloatRange { lower: 0.0, ..own } } else { own }
    }

    fn at(&self, x: f64) -> FloatRange {
        let point = FloatRange::point(x);
        if x.is_infinite() && self.slope != 0.0 {
            return FloatRange::ALL;
        }
        let value = self.values(point);
        if self.slope == 0.0 { value } else { value - point * FloatRange::point(self.slope) }
    }

    /// Whether it is positive by its tangent at a point, less what a second derivative that is
    /// negative takes away.
    fn is_above_tangent(&self, x: FloatRange, at: f64, second: Option<f64>) -> bool {
        let slope = self.function.slope(at);
        let slope = if self.sign > 0.0 { slope } else { -slope };
        let slope = slope - FloatRange::point(self.slope);
        let value = self.at(at);
        let mut least = value;
        for end in [x.lower, x.upper] {
            if end == at {
                continue;
            }
            let way = FloatRange::point(end) - FloatRange::point(at);
            let rise = match end {
                f64::INFINITY if slope.lower >= 0.0 => continue,
                f64::NEG_INFINITY if slope.upper <= 0.0 => continue,
                _ if end.is_infinite() => return false,
                _ => slope * way,
            };
            let bend = second.map_or(0.0, |second| second.min(0.0));
            let bend = (FloatRange::point(bend) * way.square()).half();
            let sum = match bend.lower < -f64::MIN_POSITIVE {
                true => value + rise + bend,
                false => value + rise,
            };
            least = FloatRange { lower: least.lower.min(sum.lower), ..least };
        }
        self.is_enough(least)
    }

    /// A point of a convex part near which the difference is least.
    fn flat_place(&self, x: FloatRange) -> f64 {
        let slope = |at: f64| self.sign * self.function.guessed_slope(at) - self.slope;
        let within = |end: f64| end.clamp(-1e300, 1e300).max(x.lower).min(x.upper);
        let (mut lower, mut upper) = (within(x.lower), within(x.upper));
        if slope(lower) >= 0.0 {
            return lower;
        }
        if slope(upper) <= 0.0 {
            return upper;
        }
        for _ in 0..MOST_GUESSES {
            // Ranges over many magnitudes are halved by these.
            let middle = match lower > 0.0 && upper > 4.0 * lower {
                true => lower.sqrt() * upper.sqrt(),
                false => 0.5 * lower + 0.5 * upper,
            };
            if middle <= lower || middle >= upper {
                break;
            }
            if slope(middle) < 0.0 { lower = middle } else { upper = middle }
        }
        if lower == x.lower { upper } else { lower }
    }
}
