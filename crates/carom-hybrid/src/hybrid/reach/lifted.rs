//! Sets of two states and one input, as images of pieces of polygons.
//!
//! For x in a polygon and guards on x and u, the possible u form an interval `[L(x), U(x)]`, where
//! U is the least of several affine functions and L the largest. The image of all (x, u) under an
//! affine map is the convex hull of the images of the graphs of L and U. The part of the polygon
//! where one of the affine functions is the least (or the largest) is cut out by half-planes, and
//! the graph over this part is its image under an affine map. So polygons are all that is needed,
//! and nothing is lost.

use super::polygon::{Point, Polygon, dot};
use super::rounding::EPSILON;
use crate::interval::Interval;

/// Guards whose input moves their left side by less than this share of the rest are treated as if
/// the input had its best value (no unit).
const FLAT: f64 = 1e-6;

/// `normal . x + gain u <= limit`.
#[derive(Debug, Clone)]
pub(super) struct Slab {
    pub(super) normal: Point,
    pub(super) gain: f64,
    pub(super) limit: f64,
}

/// `(x, u) -> matrix x + column u + offset`, for u in a range and (x, u) in slabs.
#[derive(Debug, Clone)]
pub(super) struct Lift {
    pub(super) matrix: [Point; 2],
    pub(super) column: Point,
    pub(super) offset: Point,
    pub(super) range: Interval,
    pub(super) slabs: Vec<Slab>,
}

/// A bound `slope . x + constant` of the input.
#[derive(Debug, Clone, Copy)]
struct Bound {
    slope: Point,
    constant: f64,
}

impl Bound {
    /// How large its terms are over a box.
    fn size(&self, reach: Point) -> f64 {
        self.slope[0].abs() * reach[0] + self.slope[1].abs() * reach[1] + self.constant.abs()
    }
}

fn reach(set: &Polygon) -> Point {
    let along = |axis: Point| set.support(axis).abs();
    [along([1.0, 0.0]).max(along([-1.0, 0.0])), along([0.0, 1.0]).max(along([0.0, -1.0]))]
}

fn empty() -> Polygon {
    Polygon::hull_of(Vec::new(), [0.0, 0.0])
}

/// Keeps the states at which one bound is at most another.
fn keep_below(set: &mut Polygon, low: &Bound, high: &Bound, reach: Point) {
    let normal = [low.slope[0] - high.slope[0], low.slope[1] - high.slope[1]];
    let noise = 16.0 * EPSILON * (low.size(reach) + high.size(reach));
    let limit = high.constant - low.constant + noise;
    if normal != [0.0, 0.0] {
        set.clip(normal, limit);
    } else if limit < 0.0 {
        *set = empty();
    }
}

impl Lift {
    /// The image of all states of a set with all inputs that the slabs allow.
    pub(super) fn image(&self, set: &Polygon) -> Polygon {
        let mut set = set.clone();
        if set.is_empty() {
            return set;
        }
        let around = reach(&set);
        let mut lower = vec![Bound { slope: [0.0, 0.0], constant: self.range.lower }];
        let mut upper = vec![Bound { slope: [0.0, 0.0], constant: self.range.upper }];
        for slab in &self.slabs {
            let rest = slab.normal[0].abs() * around[0] + slab.normal[1].abs() * around[1];
            let moved = slab.gain.abs() * (self.range.upper - self.range.lower);
            if moved <= FLAT * (rest + slab.limit.abs()) || moved == 0.0 {
                let best = (self.range * slab.gain).lower;
                let limit = slab.limit - best;
                let noise = 4.0 * EPSILON * (slab.limit.abs() + best.abs());
                if slab.normal != [0.0, 0.0] {
                    set.clip(slab.normal, limit + noise);
                } else if limit + noise < 0.0 {
                    return empty();
                }
                continue;
            }
            let slope = slab.normal.map(|n| -n / slab.gain);
            let bound = Bound { slope, constant: slab.limit / slab.gain };
            if slab.gain > 0.0 { upper.push(bound) } else { lower.push(bound) }
        }
        let mut image = empty();
        for k in 0..upper.len() + lower.len() {
            let is_upper = k < upper.len();
            let bound = if is_upper { upper[k] } else { lower[k - upper.len()] };
            let mut piece = set.clone();
            for (i, other) in upper.iter().enumerate() {
                if !piece.is_empty() && i != k {
                    keep_below(&mut piece, &bound, other, around);
                }
            }
            for (i, other) in lower.iter().enumerate() {
                if !piece.is_empty() && i + upper.len() != k {
                    keep_below(&mut piece, other, &bound, around);
                }
            }
            if !piece.is_empty() {
                image = image.join(&self.graph(&piece, &bound, around));
            }
        }
        image
    }

    /// The image of a set with the input on a bound.
    fn graph(&self, piece: &Polygon, bound: &Bound, around: Point) -> Polygon {
        let row = |i: usize| {
            let [p, q] = self.matrix[i];
            [p + self.column[i] * bound.slope[0], q + self.column[i] * bound.slope[1]]
        };
        let offset = |i: usize| self.offset[i] + self.column[i] * bound.constant;
        let mut image = piece.map([row(0), row(1)], [offset(0), offset(1)]);
        let noise = |i: usize| {
            let flow = self.matrix[i][0].abs() * around[0] + self.matrix[i][1].abs() * around[1];
            let pushed = self.column[i].abs() * bound.size(around);
            16.0 * EPSILON * (flow + pushed + self.offset[i].abs())
        };
        image.widen([noise(0), noise(1)]);
        image
    }

    /// The states from which an allowed input leads into a set, by the inverse of the matrix, which
    /// is known up to `error`.
    pub(super) fn preimage(
        &self,
        set: &Polygon,
        inverse: &[Vec<f64>],
        error: &[Vec<f64>],
    ) -> Polygon {
        if set.is_empty() {
            return set.clone();
        }
        // With w = z - offset - column u, the state is x = inverse w, up to error |w|.
        let around = reach(set);
        let input = self.range.magnitude();
        let size = |i: usize| around[i] + self.offset[i].abs() + self.column[i].abs() * input;
        let sizes = [size(0), size(1)];
        let rows = [[inverse[0][0], inverse[0][1]], [inverse[1][0], inverse[1][1]]];
        let miss = |i: usize| {
            let rounding = rows[i][0].abs() * sizes[0] + rows[i][1].abs() * sizes[1];
            error[i][0] * sizes[0] + error[i][1] * sizes[1] + 16.0 * EPSILON * rounding
        };
        let miss = [miss(0), miss(1)];
        let turned = |v: Point| [-dot(rows[0], v), -dot(rows[1], v)];
        let slabs = self.slabs.iter().map(|slab| {
            let normal = [
                slab.normal[0] * rows[0][0] + slab.normal[1] * rows[1][0],
                slab.normal[0] * rows[0][1] + slab.normal[1] * rows[1][1],
            ];
            let gain = slab.gain - dot(normal, self.column);
            let moved = dot(normal, self.offset);
            let factors = slab.normal.map(f64::abs);
            let reached = |i: usize| rows[i][0].abs() * sizes[0] + rows[i][1].abs() * sizes[1];
            let terms = dot(factors, [reached(0), reached(1)]) + slab.gain.abs() * input;
            let noise = 32.0 * EPSILON * (terms + slab.limit.abs()) + dot(factors, miss);
            Slab { normal, gain, limit: slab.limit + moved + noise }
        });
        let back = Lift {
            matrix: rows,
            column: turned(self.column),
            offset: turned(self.offset),
            range: self.range,
            slabs: slabs.collect(),
        };
        let mut image = back.image(set);
        image.widen(miss);
        image
    }
}

/// One state and one input: a polygon of both.
pub(super) struct Pair(Polygon);

impl Pair {
    /// States and inputs within ranges, and within slabs, which use the first entry of their
    /// normals.
    pub(super) fn new(state: Interval, input: Interval, slabs: &[Slab]) -> Self {
        let polygon = Polygon::from_box([state.lower, input.lower], [state.upper, input.upper]);
        let mut pair = Pair(polygon);
        slabs.iter().for_each(|slab| pair.clip([slab.normal[0], slab.gain], slab.limit));
        pair
    }

    /// Keeps what satisfies a limit.
    pub(super) fn clip(&mut self, normal: Point, limit: f64) {
        if normal != [0.0, 0.0] {
            self.0.clip(normal, limit);
        } else if limit < 0.0 {
            self.0 = empty();
        }
    }

    /// The range of `factors . (state, input)`, or `None` if nothing is left.
    pub(super) fn range(&self, factors: Point) -> Option<Interval> {
        let lower = -self.0.support(factors.map(|f| -f));
        (!self.0.is_empty()).then(|| Interval::new(lower, self.0.support(factors)))
    }
}
