//! Piecewise-affine functions of one variable, given by their breakpoints.

use std::ops::Bound;

use crate::error::Error;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::interval::Interval;
use crate::tolerance;

/// A continuous piecewise-affine function on a bounded domain, linear between its breakpoints.
///
/// ```
/// use carom::model::PiecewiseAffine;
///
/// let dead_zone = PiecewiseAffine::new([(-3.0, -2.0), (-1.0, 0.0), (1.0, 0.0), (3.0, 2.0)])?;
/// assert_eq!(dead_zone.value_at(2.0), Some(1.0));
/// assert_eq!(dead_zone.value_at(4.0), None);
/// assert_eq!(dead_zone.extended(-9.0, 9.0)?.value_at(4.0), Some(3.0));
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Vec<(f64, f64)>", into = "Vec<(f64, f64)>"))]
pub struct PiecewiseAffine {
    points: Vec<(f64, f64)>,
}

impl PiecewiseAffine {
    /// The function through the points `(x, y)`. Its domain is from the first `x` to the last.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`] if there are fewer than two points, if the `x` do not increase
    /// strictly, or if a number is not finite.
    pub fn new(points: impl IntoIterator<Item = (f64, f64)>) -> Result<Self, Error> {
        let points: Vec<(f64, f64)> = points.into_iter().collect();
        if points.len() < 2 {
            let what = "the number of breakpoints of a piecewise-affine function";
            return Err(Error::out_of_range(what, points.len() as f64, 2.0..));
        }
        for (k, &(x, y)) in points.iter().enumerate() {
            for (value, axis) in [(x, "x"), (y, "y")] {
                if value.is_nan() || value.abs() >= tolerance::INFINITE {
                    let what = format!("the {axis} of breakpoint {k}");
                    return Err(Error::out_of_range_in_words(what, value, .., "finite"));
                }
            }
            if k > 0 && x <= points[k - 1].0 {
                let range = format!("greater than {}, the one before", points[k - 1].0);
                let (what, after) = (format!("the x of breakpoint {k}"), points[k - 1].0);
                let limits = (Bound::Excluded(after), Bound::Unbounded);
                return Err(Error::out_of_range_in_words(what, x, limits, range));
            }
        }
        Ok(PiecewiseAffine { points })
    }

    /// The breakpoints in the order of `x`.
    pub fn points(&self) -> &[(f64, f64)] {
        &self.points
    }

    /// The domain of the function.
    pub fn domain(&self) -> Interval {
        Interval::new(self.points[0].0, self.points[self.points.len() - 1].0)
    }

    /// The value at `x`, or `None` outside the domain.
    pub fn value_at(&self, x: f64) -> Option<f64> {
        self.domain().contains(x).then(|| self.value_near(x))
    }

    /// The function with its first and last pieces extended so that the domain includes
    /// `[lower, upper]`.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`] if `lower` or `upper` is not finite.
    pub fn extended(&self, lower: f64, upper: f64) -> Result<Self, Error> {
        let mut points = self.points.clone();
        let line = |(x0, y0): (f64, f64), (x1, y1): (f64, f64), x: f64| {
            (x, y0 + (y1 - y0) / (x1 - x0) * (x - x0))
        };
        let n = points.len();
        let (first, last) = ([points[0], points[1]], [points[n - 2], points[n - 1]]);
        if lower < first[0].0 || lower.is_nan() {
            points[0] = line(first[0], first[1], lower);
        }
        if upper > last[1].0 || upper.is_nan() {
            points[n - 1] = line(last[0], last[1], upper);
        }
        PiecewiseAffine::new(points)
    }

    /// The value at `x`, clamped to the domain.
    #[doc(hidden)]
    pub fn value_near(&self, x: f64) -> f64 {
        let after = self.points.partition_point(|point| point.0 < x);
        let (first, last) = (self.points[0], self.points[self.points.len() - 1]);
        match after {
            0 => first.1,
            k if k == self.points.len() => last.1,
            k => {
                let ((x0, y0), (x1, y1)) = (self.points[k - 1], self.points[k]);
                let share = (x - x0) / (x1 - x0);
                (1.0 - share) * y0 + share * y1
            }
        }
    }

    /// The smallest and the largest value within `[lower, upper]`, clamped to the domain.
    #[doc(hidden)]
    pub fn values_within(&self, lower: f64, upper: f64) -> Interval {
        let ends = [self.value_near(lower), self.value_near(upper)];
        let inside = self.points.iter().filter(|point| lower < point.0 && point.0 < upper);
        let values = ends.into_iter().chain(inside.map(|point| point.1));
        let start = Interval::new(f64::INFINITY, f64::NEG_INFINITY);
        values.fold(start, |range, y| Interval::new(range.lower.min(y), range.upper.max(y)))
    }

    /// The part over `range`, without breakpoints between pieces of equal slope. Returns the whole
    /// function if `range` and the domain share at most one point. Pieces that would become very
    /// short are kept whole, because their slope would be rounding noise.
    #[doc(hidden)]
    pub fn restricted(&self, range: Interval) -> PiecewiseAffine {
        let part = self.domain().intersection(range);
        let mut points = Vec::with_capacity(self.points.len());
        if part.lower < part.upper {
            for pair in self.points.windows(2) {
                let ((left, _), (right, _)) = (pair[0], pair[1]);
                if right <= part.lower || part.upper <= left {
                    continue;
                }
                let sliver = tolerance::FEASIBILITY * (right - left);
                let (low, high) = (left.max(part.lower), right.min(part.upper));
                let (low, high) = if high - low > sliver { (low, high) } else { (left, right) };
                if points.is_empty() {
                    points.push((low, self.value_near(low)));
                }
                points.push((high, self.value_near(high)));
            }
        } else {
            points.clone_from(&self.points);
        }
        let mut kept: Vec<(f64, f64)> = Vec::with_capacity(points.len());
        for (k, &point) in points.iter().enumerate() {
            let needless = match (kept.last(), points.get(k + 1)) {
                (Some(&before), Some(&after)) => {
                    same_slope(slope(before, point), slope(point, after))
                }
                _ => false,
            };
            if !needless {
                kept.push(point);
            }
        }
        PiecewiseAffine { points: kept }
    }

    /// The pieces as `(slope, value at 0)`.
    #[doc(hidden)]
    pub fn pieces(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.points.windows(2).map(|pair| {
            let slope = slope(pair[0], pair[1]);
            (slope, pair[0].1 - slope * pair[0].0)
        })
    }

    /// Whether the slopes never decrease (`sign` = 1) or never increase (`sign` = -1).
    #[doc(hidden)]
    pub fn bends(&self, sign: f64) -> bool {
        let slopes: Vec<f64> = self.pieces().map(|(slope, _)| sign * slope).collect();
        slopes.windows(2).all(|pair| pair[0] <= pair[1] || same_slope(pair[0], pair[1]))
    }
}

fn slope((x0, y0): (f64, f64), (x1, y1): (f64, f64)) -> f64 {
    (y1 - y0) / (x1 - x0)
}

fn same_slope(a: f64, b: f64) -> bool {
    (a - b).abs() <= tolerance::SLOPE * a.abs().max(b.abs())
}

impl TryFrom<Vec<(f64, f64)>> for PiecewiseAffine {
    type Error = Error;

    fn try_from(points: Vec<(f64, f64)>) -> Result<Self, Error> {
        PiecewiseAffine::new(points)
    }
}

impl From<PiecewiseAffine> for Vec<(f64, f64)> {
    fn from(function: PiecewiseAffine) -> Self {
        function.points
    }
}
