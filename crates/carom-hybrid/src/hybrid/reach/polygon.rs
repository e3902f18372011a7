//! Convex polygons with outward rounding: exact sets of two states.
//!
//! A polygon represents `hull(vertices) + [-r₀, r₀] x [-r₁, r₁]`. Every operation computes its
//! vertices in floating point and adds the possible rounding error to the margin `r`, so the result
//! always contains the exact result of the operation on the exact operands.

use super::rounding::EPSILON;
use crate::tolerance::largest_magnitude;

pub(super) type Point = [f64; 2];

/// A convex set of the plane: a polygon, a segment, a point, or the empty set.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Polygon {
    /// Counter-clockwise; empty for the empty set.
    vertices: Vec<Point>,
    /// How far the set may extend beyond the hull of the vertices, along each axis.
    margin: Point,
    /// Bounds of the vertices' magnitudes along each axis, for the size of rounding errors.
    size: Point,
}

const AXES: [Point; 4] = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];

/// The support of the empty set.
const NOWHERE: f64 = f64::NEG_INFINITY;

/// A line that separates two sets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Separation {
    pub(super) normal: Point,
    /// Largest value of `normal . z` over the first set.
    pub(super) first: f64,
    /// Smallest value over the second one; larger than `first`.
    pub(super) second: f64,
}

pub(super) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

fn plus(a: Point, b: Point) -> Point {
    [a[0] + b[0], a[1] + b[1]]
}

/// Positive if `b` points to the left of `a`.
fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

impl Polygon {
    /// The box `[low, high]`, whose sides may have length 0.
    pub(super) fn from_box(low: Point, high: Point) -> Self {
        let corners = vec![low, [high[0], low[1]], high, [low[0], high[1]]];
        Polygon::hull_of(corners, [0.0, 0.0])
    }

    /// The convex hull of points that already have a margin.
    pub(super) fn hull_of(mut points: Vec<Point>, margin: Point) -> Self {
        let size = sizes(&points);
        let mut polygon = Polygon { vertices: Vec::new(), margin, size };
        let order = |a: &Point, b: &Point| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]));
        // Stable sorting takes linear time on the few sorted runs that polygons consist of.
        points.sort_by(order);
        points.dedup();
        if points.len() <= 2 {
            polygon.vertices = points;
            return polygon;
        }
        let mut lost = 0.0;
        let mut hull: Vec<Point> = Vec::with_capacity(points.len() + 1);
        let lower = points.iter().copied();
        let upper = points.iter().rev().copied();
        extend_chain(&mut hull, lower, 0, &mut lost);
        let base = hull.len() - 1;
        extend_chain(&mut hull, upper.skip(1), base, &mut lost);
        hull.pop();
        polygon.vertices = hull;
        polygon.loosen(8);
        polygon.margin[1] += lost;
        polygon
    }

    pub(super) fn is_empty(&self) -> bool {
        self.vertices.is_empty()
    }

    pub(super) fn vertices(&self) -> &[Point] {
        &self.vertices
    }

    pub(super) fn margin(&self) -> Point {
        self.margin
    }

    /// The sum with the box `[-by, by]`.
    pub(super) fn widen(&mut self, by: Point) {
        for (margin, by) in self.margin.iter_mut().zip(by).filter(|(_, by)| *by > 0.0) {
            *margin = (*margin + by).next_up();
        }
    }

    /// Whether its margin is wider than another polygon, or NaN.
    pub(super) fn has_outgrown(&self, other: &Polygon) -> bool {
        AXES.chunks(2).zip(self.margin).zip(self.size).any(|((axis, margin), size)| {
            let width = other.support(axis[0]) + other.support(axis[1]);
            !(margin <= width && size.is_finite())
        })
    }

    /// Adds `count` roundings of the coordinates to the margin.
    fn loosen(&mut self, count: usize) {
        for axis in 0..2 {
            self.margin[axis] += count as f64 * EPSILON * self.size[axis];
        }
    }

    /// The image under `z -> M z + c`.
    pub(super) fn map(&self, matrix: [Point; 2], offset: Point) -> Self {
        let apply = |z: &Point| plus([dot(matrix[0], *z), dot(matrix[1], *z)], offset);
        let vertices: Vec<Point> = self.vertices.iter().map(apply).collect();
        let (mut margin, mut size) = ([0.0; 2], [0.0; 2]);
        for axis in 0..2 {
            let row = [matrix[axis][0].abs(), matrix[axis][1].abs()];
            size[axis] = (dot(row, self.size) + offset[axis].abs()) * (1.0 + 4.0 * EPSILON);
            margin[axis] =
                dot(row, self.margin) * (1.0 + 4.0 * EPSILON) + 4.0 * EPSILON * size[axis];
        }
        let determinant = cross(matrix[0], matrix[1]);
        let scale = dot(matrix[0], matrix[0]).max(dot(matrix[1], matrix[1]));
        if vertices.len() < 3 || determinant.abs() <= 1e-9 * scale {
            // Singular map: the order of the vertices is lost.
            return Polygon::hull_of(vertices, margin);
        }
        let mut image = Polygon { vertices, margin, size };
        if determinant < 0.0 {
            image.vertices.reverse();
        }
        if image.is_surely_convex() {
            return image;
        }
        // Nearly singular map: rounding may have changed the order of the vertices.
        let mut hull = Polygon::hull_of(image.vertices, margin);
        hull.size = size;
        hull
    }

    /// Whether the vertices certainly go round once and turn left at each of them, despite
    /// rounding.
    fn is_surely_convex(&self) -> bool {
        let n = self.vertices.len();
        let mut edge = minus(self.vertices[0], self.vertices[n - 1]);
        let mut turns_back = 0;
        for k in 0..n {
            let next = minus(self.vertices[(k + 1) % n], self.vertices[k]);
            let is_left = cross(edge, next) > 4.0 * EPSILON * turn_size(edge, next);
            if !is_left {
                return false;
            }
            // The end of a run to the right.
            let goes_right = |e: Point| e[0] > 0.0 || (e[0] == 0.0 && e[1] < 0.0);
            turns_back += usize::from(goes_right(edge) && !goes_right(next));
            edge = next;
        }
        turns_back == 1
    }

    /// The sum with the segment from `-generator` to `generator`.
    pub(super) fn add_segment(&self, generator: Point) -> Self {
        if generator == [0.0, 0.0] || self.is_empty() {
            return self.clone();
        }
        let n = self.vertices.len();
        let both = |v: &Point| [minus(*v, generator), plus(*v, generator)];
        if n < 3 {
            let points = self.vertices.iter().flat_map(both).collect();
            let mut sum = Polygon::hull_of(points, self.margin);
            sum.loosen(8);
            return sum;
        }
        // Vertices to the right of the generator move with it, those to the left against it.
        let sides: Vec<f64> = self.vertices.iter().map(|&v| cross(generator, v)).collect();
        let (mut right, mut left) = (0, 0);
        for k in 1..n {
            if sides[k] < sides[right] {
                right = k;
            }
            if sides[k] > sides[left] {
                left = k;
            }
        }
        let noise = 16.0 * EPSILON * dot([generator[1].abs(), generator[0].abs()], self.size);
        let is_wide = sides[left] - sides[right] > noise;
        if !is_wide {
            // A sliver along the generator: with rounding, its two ends cannot be told apart.
            let points = self.vertices.iter().flat_map(both).collect();
            return Polygon::hull_of(points, self.margin);
        }
        let mut vertices = Vec::with_capacity(n + 2);
        vertices.push(minus(self.vertices[right], generator));
        let mut k = right;
        loop {
            vertices.push(plus(self.vertices[k], generator));
            if k == left {
                break;
            }
            k = (k + 1) % n;
        }
        vertices.push(minus(self.vertices[left], generator));
        let mut k = (left + 1) % n;
        while k != right {
            vertices.push(minus(self.vertices[k], generator));
            k = (k + 1) % n;
        }
        let size = [self.size[0] + generator[0].abs(), self.size[1] + generator[1].abs()];
        let mut sum = Polygon { vertices, margin: self.margin, size };
        sum.loosen(8);
        sum
    }

    /// Keeps the part with `normal . z <= limit`. If that is empty, returns the smallest value of
    /// the left side.
    pub(super) fn clip(&mut self, normal: Point, limit: f64) -> Option<f64> {
        if self.is_empty() {
            return None;
        }
        let factors = [normal[0].abs(), normal[1].abs()];
        let limit = limit + dot(factors, self.margin);
        let limit = limit + 16.0 * EPSILON * (dot(factors, self.size) + limit.abs());
        let excess = |v: &Point| dot(normal, *v) - limit;
        if self.vertices.iter().all(|v| excess(v) <= 0.0) {
            return None;
        }
        let excess: Vec<f64> = self.vertices.iter().map(excess).collect();
        if excess.iter().all(|&e| e > 0.0) {
            let nearest = -self.support([-normal[0], -normal[1]]);
            self.vertices.clear();
            return Some(nearest);
        }
        let n = self.vertices.len();
        let mut kept = Vec::with_capacity(n + 2);
        for k in 0..n {
            let next = (k + 1) % n;
            if excess[k] <= 0.0 {
                kept.push(self.vertices[k]);
            }
            // A segment has one edge, not two.
            let is_edge = n > 2 || (n == 2 && k == 0);
            if is_edge && (excess[k] <= 0.0) != (excess[next] <= 0.0) {
                let share = (excess[k] / (excess[k] - excess[next])).clamp(0.0, 1.0);
                let edge = minus(self.vertices[next], self.vertices[k]);
                kept.push(plus(self.vertices[k], [share * edge[0], share * edge[1]]));
            }
        }
        kept.dedup();
        self.loosen(4);
        self.vertices = kept;
        None
    }

    /// The convex hull of both.
    pub(super) fn join(&self, other: &Polygon) -> Self {
        if self.is_empty() {
            return other.clone();
        }
        if other.is_empty() {
            return self.clone();
        }
        let points = self.vertices.iter().chain(&other.vertices).copied().collect();
        let widest = |axis: usize| self.margin[axis].max(other.margin[axis]);
        Polygon::hull_of(points, [widest(0), widest(1)])
    }

    /// Largest value of `direction . z`; minus infinity for the empty set.
    pub(super) fn support(&self, direction: Point) -> f64 {
        let factors = [direction[0].abs(), direction[1].abs()];
        let best = self.vertices.iter().map(|&v| dot(direction, v)).fold(NOWHERE, f64::max);
        best + dot(factors, self.margin) + 4.0 * EPSILON * dot(factors, self.size)
    }

    /// Outward normals of the edges, each with a vertex of its edge.
    fn edges(&self) -> impl Iterator<Item = (Point, Point)> {
        let n = self.vertices.len();
        let edge = move |k: usize| {
            let (from, to) = (self.vertices[k], self.vertices[(k + 1) % n]);
            ([to[1] - from[1], from[0] - to[0]], from)
        };
        (0..n).map(edge).filter(|(normal, _)| *normal != [0.0, 0.0])
    }

    /// Limits `normal . z <= limit` whose intersection is this set, with its margin.
    pub(super) fn halfplanes(&self) -> Vec<(Point, f64)> {
        let normals = self.edges().map(|(normal, _)| normal).chain(AXES);
        normals.map(|normal| (normal, self.support(normal))).collect()
    }

    /// Whether every point of another set certainly lies in this one.
    pub(super) fn covers(&self, other: &Polygon) -> bool {
        let edges = self.edges().map(|(normal, _)| normal);
        let mut normals = AXES.into_iter().chain(edges);
        normals.all(|normal| other.support(normal) <= self.support(normal))
    }

    /// A line that separates two non-empty sets, or `None` if none was found. There is never one if
    /// they have a common point.
    pub(super) fn separation(&self, other: &Polygon) -> Option<Separation> {
        let forward = one_sided(self, other);
        forward.or_else(|| {
            // The same line, seen from the other set.
            one_sided(other, self).map(|s| Separation {
                normal: [-s.normal[0], -s.normal[1]],
                first: -s.second,
                second: -s.first,
            })
        })
    }

    /// Replaces short edges by extending their neighbours, outward, until at most `most` vertices
    /// are left, if possible.
    pub(super) fn simplify(&mut self, most: usize) {
        let most = most.max(8);
        while self.vertices.len() > most {
            let before = self.vertices.len();
            let target = most - most / 4;
            self.drop_edges(before - target);
            if self.vertices.len() == before {
                break;
            }
        }
    }

    /// Drops up to `count` edges, no two of them adjacent, smallest added area first.
    fn drop_edges(&mut self, count: usize) {
        let n = self.vertices.len();
        let at = |k: usize| self.vertices[k % n];
        let mut candidates: Vec<(f64, usize, Point)> = Vec::with_capacity(n);
        for k in 0..n {
            // Drop the edge from b to c; the lines through a, b and through c, d meet in q.
            let (a, b, c, d) = (at(k + n - 1), at(k), at(k + 1), at(k + 2));
            let (before, edge, after) = (minus(b, a), minus(c, b), minus(d, c));
            let turn = cross(before, after);
            let size = dot(before, before).max(dot(after, after));
            if turn <= 1e-12 * size {
                continue;
            }
            let reach = cross(edge, after) / turn;
            let q = plus(b, [reach * before[0], reach * before[1]]);
            let area = cross(minus(c, b), minus(b, q)).abs();
            // Despite rounding of q, b and c must be inside.
            let slack = |axis: usize| 4.0 * EPSILON * (q[axis].abs() + b[axis].abs());
            let covers = |from: Point, to: Point, p: Point| {
                let side = minus(to, from);
                let most = side[0].abs() * slack(1) + side[1].abs() * slack(0);
                cross(side, minus(p, from)) >= -most
            };
            if reach >= 0.0 && area.is_finite() && covers(a, q, b) && covers(q, d, c) {
                candidates.push((area, k, q));
            }
        }
        candidates.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        let mut apex: Vec<Option<Point>> = vec![None; n];
        let mut dropped = 0;
        for (_, k, q) in candidates {
            // Not adjacent to a dropped edge, because each apex needs its neighbours' lines.
            let near = [k + n - 2, k + n - 1, k, k + 1, k + 2];
            if dropped < count && near.iter().all(|&i| apex[i % n].is_none()) {
                apex[k] = Some(q);
                dropped += 1;
            }
        }
        let mut vertices = Vec::with_capacity(n);
        for k in 0..n {
            match apex[k] {
                Some(q) => vertices.push(q),
                None if apex[(k + n - 1) % n].is_some() => {}
                None => vertices.push(self.vertices[k]),
            }
        }
        self.size = sizes(&vertices);
        self.vertices = vertices;
        self.loosen(16);
    }
}

/// The largest magnitudes along each axis.
fn sizes(points: &[Point]) -> Point {
    let along = |axis: usize| largest_magnitude(points.iter().map(|v| v[axis]));
    [along(0), along(1)]
}

/// Adds a sorted run to a hull and keeps only turns that are certainly to the left, because an
/// uncertain turn would hide that earlier points must be dropped. `lost` sums how far the dropped
/// points may lie outside, along the second axis.
fn extend_chain(
    hull: &mut Vec<Point>,
    points: impl Iterator<Item = Point>,
    base: usize,
    lost: &mut f64,
) {
    for point in points {
        while hull.len() >= base + 2 {
            let (a, b) = (hull[hull.len() - 2], hull[hull.len() - 1]);
            // Edges between neighbouring points, because the rounding of longer differences would
            // hide short ones.
            let (first, second) = (minus(b, a), minus(point, b));
            let turn = cross(first, second);
            let noise = 4.0 * EPSILON * turn_size(first, second);
            if turn > noise {
                break;
            }
            if turn >= -noise {
                *lost += 8.0 * EPSILON * (first[1].abs() + second[1].abs());
            }
            hull.pop();
        }
        hull.push(point);
    }
}

/// The size of the terms of a cross product, for its rounding.
fn turn_size(first: Point, second: Point) -> f64 {
    (first[0] * second[1]).abs() + (first[1] * second[0]).abs()
}

/// Looks for a separating line along the edges of `first` and along the axes.
fn one_sided(first: &Polygon, second: &Polygon) -> Option<Separation> {
    let separates = |normal: Point| {
        let edge = first.support(normal);
        let against = -second.support([-normal[0], -normal[1]]);
        (against > edge).then_some(Separation { normal, first: edge, second: against })
    };
    if let Some(found) = AXES.into_iter().find_map(separates) {
        return Some(found);
    }
    let count = second.vertices.len();
    let mut at = 0;
    for (normal, on_edge) in first.edges() {
        // The extreme vertex of the second set against the normal moves round with the normals.
        // Stopping too early can only miss a line, because a line that is found is checked on all
        // vertices.
        let value = |k: usize| dot(normal, second.vertices[k % count]);
        for _ in 0..count {
            if value(at + 1) > value(at) {
                break;
            }
            at = (at + 1) % count;
        }
        for _ in 0..count {
            if value(at + count - 1) >= value(at) {
                break;
            }
            at = (at + count - 1) % count;
        }
        if value(at) > dot(normal, on_edge)
            && let Some(found) = separates(normal)
        {
            return Some(found);
        }
    }
    None
}
