//! A set within one block of states, and the maps between such sets.

use std::sync::Arc;

use super::polygon::Polygon;
use super::rounding::EPSILON;
use super::template::{Combinations, Polyhedron, Template};
use crate::tolerance::largest_magnitude;

/// A set of a block's states.
#[derive(Debug, Clone)]
pub(super) enum Shape {
    /// Two states: exact polygons.
    Planar(Polygon),
    /// Other numbers of states: limits along fixed directions.
    Template(Polyhedron),
}

/// A dense matrix by rows.
pub(super) type Matrix = Vec<Vec<f64>>;

/// `z -> M z + c` with the data to apply and to invert it.
#[derive(Debug, Clone)]
pub(super) struct AffineMap {
    matrix: Matrix,
    offset: Vec<f64>,
    /// Per template direction d, the combinations of `Mᵀ d`.
    pull: Arc<Vec<Combinations>>,
    inverse: Option<Arc<Inverse>>,
}

#[derive(Debug, Clone)]
struct Inverse {
    matrix: Matrix,
    /// Bound of `|M⁻¹ - matrix| |z|` per unit of `|z|`, entry by entry.
    error: Matrix,
    pull: Vec<Combinations>,
}

pub(super) fn apply(matrix: &Matrix, z: &[f64]) -> Vec<f64> {
    matrix.iter().map(|row| row.iter().zip(z).map(|(a, b)| a * b).sum()).collect()
}

fn transposed(matrix: &Matrix, z: &[f64]) -> Vec<f64> {
    let column = |j: usize| matrix.iter().zip(z).map(|(row, v)| row[j] * v).sum();
    (0..matrix.len()).map(column).collect()
}

/// Bounds of the rounding errors of [`transposed`], entry by entry.
fn rounded(matrix: &Matrix, z: &[f64]) -> Vec<f64> {
    let size = |j: usize| matrix.iter().zip(z).map(|(row, v)| (row[j] * v).abs()).sum::<f64>();
    (0..matrix.len()).map(|j| (1 + z.len()) as f64 * EPSILON * size(j)).collect()
}

fn product(a: &Matrix, b: &Matrix, size: impl Fn(f64) -> f64) -> Matrix {
    let n = a.len();
    let entry = |i: usize, j: usize| (0..n).map(|k| size(a[i][k]) * size(b[k][j])).sum();
    (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect()
}

impl AffineMap {
    /// A map between sets of a template, or between polygons.
    pub(super) fn new(matrix: Matrix, offset: Vec<f64>, template: Option<&Template>) -> Self {
        let pull_back = |matrix: &Matrix| template.map_or_else(Vec::new, |t| pull_back(matrix, t));
        let pull = pull_back(&matrix);
        let inverse = invert(&matrix).map(|(inverse, error)| {
            let pull = pull_back(&inverse);
            Arc::new(Inverse { matrix: inverse, error, pull })
        });
        AffineMap { matrix, offset, pull: Arc::new(pull), inverse }
    }

    /// The same matrix with another offset.
    pub(super) fn with_offset(&self, offset: Vec<f64>) -> Self {
        AffineMap { offset, ..self.clone() }
    }

    pub(super) fn matrix(&self) -> &Matrix {
        &self.matrix
    }

    /// The inverse of the matrix, and a bound of its error, entry by entry. `None` if the matrix is
    /// nearly singular.
    pub(super) fn inverse(&self) -> Option<(&Matrix, &Matrix)> {
        self.inverse.as_ref().map(|inverse| (&inverse.matrix, &inverse.error))
    }
}

fn pull_back(matrix: &Matrix, template: &Template) -> Vec<Combinations> {
    let pulled = |d: &Vec<f64>| template.combinations(&transposed(matrix, d), &rounded(matrix, d));
    template.directions().iter().map(pulled).collect()
}

/// The inverse and a bound of its error, or `None` if the matrix is nearly singular.
fn invert(matrix: &Matrix) -> Option<(Matrix, Matrix)> {
    let n = matrix.len();
    let mut work: Matrix = (0..n)
        .map(|i| {
            let unit = (0..n).map(|j| f64::from(u8::from(i == j)));
            matrix[i].iter().copied().chain(unit).collect()
        })
        .collect();
    let size = largest_magnitude(matrix.iter().flatten());
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| work[i][k].abs().total_cmp(&work[j][k].abs()))?;
        work.swap(k, pivot);
        let head = work[k][k];
        if head.abs() <= 1e-7 * size {
            return None;
        }
        work[k].iter_mut().for_each(|entry| *entry /= head);
        let pivot_row = work[k].clone();
        for (i, row) in work.iter_mut().enumerate() {
            let factor = row[k];
            if i != k && factor != 0.0 {
                row.iter_mut().zip(&pivot_row).for_each(|(x, y)| *x -= factor * y);
            }
        }
    }
    let inverse: Matrix = work.into_iter().map(|row| row[n..].to_vec()).collect();
    // M⁻¹ - X = M⁻¹ (I - M X): with |M⁻¹| at most twice |X|, bounded entry by entry.
    let mut rest = product(matrix, &inverse, |x| x);
    let sizes = product(matrix, &inverse, f64::abs);
    for (i, row) in rest.iter_mut().enumerate() {
        for (j, entry) in row.iter_mut().enumerate() {
            let unit = f64::from(u8::from(i == j));
            *entry = (*entry - unit).abs() + 2.0 * n as f64 * EPSILON * (sizes[i][j] + unit);
        }
    }
    if largest_magnitude(rest.iter().flatten()) * n as f64 > 1e-3 {
        return None;
    }
    let error = product(&inverse, &rest, |x| 2.0_f64.sqrt() * x.abs());
    Some((inverse, error))
}

impl Shape {
    /// A box: a polygon without a template.
    pub(super) fn from_box(template: Option<&Arc<Template>>, low: &[f64], high: &[f64]) -> Self {
        match template {
            None => Shape::Planar(Polygon::from_box([low[0], low[1]], [high[0], high[1]])),
            Some(template) => Shape::Template(Polyhedron::from_box(template, low, high)),
        }
    }

    /// A box, represented like this set.
    pub(super) fn boxed(&self, low: &[f64], high: &[f64]) -> Self {
        match self {
            Shape::Planar(_) => Shape::from_box(None, low, high),
            Shape::Template(set) => Shape::from_box(Some(&set.template), low, high),
        }
    }

    /// The template, unless the set is a polygon.
    pub(super) fn template(&self) -> Option<&Arc<Template>> {
        match self {
            Shape::Planar(_) => None,
            Shape::Template(set) => Some(&set.template),
        }
    }

    /// A lower bound of `direction . z`, at the cost of one look-up; exact for polygons and along
    /// the directions of templates.
    pub(super) fn lowest(&self, direction: &[f64]) -> f64 {
        let opposite: Vec<f64> = direction.iter().map(|d| -d).collect();
        match self {
            Shape::Planar(_) => -self.support(&opposite),
            Shape::Template(set) => -set.rough_support(&opposite),
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        match self {
            Shape::Planar(polygon) => polygon.is_empty(),
            Shape::Template(set) => set.is_empty(),
        }
    }

    /// An upper bound of the magnitude of its coordinates.
    pub(super) fn size(&self) -> f64 {
        let worse = |a: f64, b: f64| if a.is_nan() || a >= b { a } else { b };
        match self {
            Shape::Planar(polygon) => {
                let axes = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
                axes.map(|axis| polygon.support(axis).abs()).into_iter().fold(0.0, worse)
            }
            Shape::Template(set) => set.limits.iter().map(|limit| limit.abs()).fold(0.0, worse),
        }
    }

    /// Propagates the limits of a template to each other, after some of them were lowered.
    pub(super) fn settle(&mut self) {
        if let Shape::Template(set) = self {
            set.settle();
        }
    }

    /// Keeps the part with `normal . z <= limit`. If that is empty, returns the smallest value of
    /// the left side. [`settle`](Shape::settle) updates the other limits of a template.
    pub(super) fn clip(&mut self, normal: &[f64], limit: f64) -> Option<f64> {
        match self {
            Shape::Planar(polygon) => polygon.clip([normal[0], normal[1]], limit),
            Shape::Template(set) => {
                let (direction, factor) = set.template.multiple(normal)?;
                // Opposite directions are adjacent.
                let nearest = -set.limits.get(direction ^ 1)?;
                let limit = limit / factor;
                set.lower(direction, limit + 2.0 * EPSILON * limit.abs());
                if set.limits[direction] >= nearest {
                    return None;
                }
                set.limits.clear();
                Some(nearest * factor)
            }
        }
    }

    /// The image under a map.
    pub(super) fn map(&self, map: &AffineMap) -> Shape {
        match self {
            Shape::Planar(polygon) => {
                let m = &map.matrix;
                let rows = [[m[0][0], m[0][1]], [m[1][0], m[1][1]]];
                Shape::Planar(polygon.map(rows, [map.offset[0], map.offset[1]]))
            }
            Shape::Template(set) => Shape::Template(pulled(set, &map.pull, &map.offset)),
        }
    }

    /// The part of `whole` that a map sends into this set.
    pub(super) fn preimage(&self, map: &AffineMap, whole: &Shape) -> Shape {
        if self.is_empty() {
            return self.clone();
        }
        match &map.inverse {
            Some(inverse) => self.unmap(map, inverse),
            None => self.restrict(map, whole),
        }
    }

    fn unmap(&self, map: &AffineMap, inverse: &Inverse) -> Shape {
        let back: Vec<f64> = map.offset.iter().map(|c| -c).collect();
        match self {
            Shape::Planar(polygon) => {
                let moved = polygon.map([[1.0, 0.0], [0.0, 1.0]], [back[0], back[1]]);
                let reach = |axis: usize| {
                    let (v, r) = (moved.vertices().iter().map(|v| v[axis]), moved.margin()[axis]);
                    largest_magnitude(v) + r
                };
                let error = apply(&inverse.error, &[reach(0), reach(1)]);
                let m = &inverse.matrix;
                let rows = [[m[0][0], m[0][1]], [m[1][0], m[1][1]]];
                let mut image = moved.map(rows, [0.0, 0.0]);
                image.widen([error[0], error[1]]);
                Shape::Planar(image)
            }
            Shape::Template(set) => {
                let mut moved = set.clone();
                for (limit, direction) in moved.limits.iter_mut().zip(set.template.directions()) {
                    let terms: Vec<f64> = direction.iter().zip(&back).map(|(d, c)| d * c).collect();
                    let size = terms.iter().map(|t| t.abs()).sum::<f64>() + limit.abs();
                    *limit += terms.iter().sum::<f64>() + 8.0 * EPSILON * size;
                }
                let n = set.template.states();
                let reach: Vec<f64> = (0..n)
                    .map(|i| moved.limits[2 * i].abs().max(moved.limits[2 * i + 1].abs()))
                    .collect();
                let error = apply(&inverse.error, &reach);
                let mut image = pulled(&moved, &inverse.pull, &vec![0.0; n]);
                for (limit, direction) in image.limits.iter_mut().zip(set.template.directions()) {
                    *limit += direction.iter().zip(&error).map(|(d, e)| d.abs() * e).sum::<f64>();
                }
                Shape::Template(image)
            }
        }
    }

    /// The preimage under a singular map: this set's limits, pulled back one by one.
    fn restrict(&self, map: &AffineMap, whole: &Shape) -> Shape {
        if map.matrix.iter().flatten().all(|&entry| entry == 0.0) {
            // Everything maps to one point.
            let misses = self.separation(&self.boxed(&map.offset, &map.offset)).is_some();
            return if misses { self.nothing() } else { whole.clone() };
        }
        let mut part = whole.clone();
        let mut limits: Vec<(Vec<f64>, f64)> = Vec::new();
        match self {
            Shape::Planar(polygon) => {
                let halfplanes = polygon.halfplanes().into_iter();
                limits.extend(halfplanes.map(|(normal, limit)| (normal.to_vec(), limit)));
            }
            Shape::Template(set) => {
                let directions = set.template.directions().iter().cloned();
                limits.extend(directions.zip(set.limits.iter().copied()));
            }
        }
        for (normal, limit) in limits {
            let pulled = transposed(&map.matrix, &normal);
            let shift: f64 = normal.iter().zip(&map.offset).map(|(n, c)| n * c).sum();
            let terms = normal.iter().zip(&map.offset).map(|(n, c)| (n * c).abs());
            let rest = limit - shift + 8.0 * EPSILON * (limit.abs() + terms.sum::<f64>());
            let rest = rest + rounded(&map.matrix, &normal).iter().sum::<f64>() * whole.size();
            if largest_magnitude(&pulled) > 0.0 {
                part.clip(&pulled, rest);
            } else if rest < 0.0 {
                return part.nothing();
            }
        }
        part
    }

    fn nothing(&self) -> Shape {
        match self {
            Shape::Planar(_) => Shape::Planar(Polygon::hull_of(Vec::new(), [0.0, 0.0])),
            Shape::Template(set) => Shape::Template(set.with_limits(Vec::new())),
        }
    }

    /// The sum with the segments from `-g` to `g`.
    pub(super) fn add_segments(&self, generators: &[Vec<f64>]) -> Shape {
        let mut sum = self.clone();
        if self.is_empty() {
            return sum;
        }
        match &mut sum {
            Shape::Planar(polygon) => {
                for g in generators {
                    *polygon = polygon.add_segment([g[0], g[1]]);
                }
            }
            Shape::Template(set) => {
                for (limit, direction) in set.limits.iter_mut().zip(set.template.directions()) {
                    let along = |g: &Vec<f64>| -> f64 {
                        direction.iter().zip(g).map(|(d, x)| d * x).sum::<f64>().abs()
                    };
                    let growth: f64 = generators.iter().map(along).sum();
                    *limit += growth + 8.0 * EPSILON * (growth + limit.abs());
                }
            }
        }
        sum
    }

    /// Becomes `whole`, which contains everything that matters, if rounding has grown beyond it.
    /// The inverse of a nearly singular map magnifies the margin, and limits do not cut it.
    pub(super) fn keep_within(&mut self, whole: &Shape) {
        if let (Shape::Planar(polygon), Shape::Planar(most)) = (&mut *self, whole)
            && !polygon.is_empty()
            && polygon.has_outgrown(most)
        {
            *polygon = most.clone();
        }
    }

    /// The sum with the box `[-r, r]`.
    pub(super) fn widen(&mut self, by: &[f64]) {
        match self {
            Shape::Planar(polygon) => polygon.widen([by[0], by[1]]),
            Shape::Template(set) => {
                for (limit, direction) in set.limits.iter_mut().zip(set.template.directions()) {
                    *limit += direction.iter().zip(by).map(|(d, r)| d.abs() * r).sum::<f64>();
                }
            }
        }
    }

    pub(super) fn join(&self, other: &Shape) -> Shape {
        match (self, other) {
            (Shape::Planar(a), Shape::Planar(b)) => Shape::Planar(a.join(b)),
            (Shape::Template(a), Shape::Template(b)) => Shape::Template(a.join(b)),
            _ => self.clone(),
        }
    }

    pub(super) fn simplify(&mut self, most: usize) {
        if let Shape::Planar(polygon) = self {
            polygon.simplify(most);
        }
    }

    /// Largest value of `direction . z`, rounded up.
    pub(super) fn support(&self, direction: &[f64]) -> f64 {
        if self.is_empty() {
            return f64::NEG_INFINITY;
        }
        match self {
            Shape::Planar(polygon) => polygon.support([direction[0], direction[1]]),
            Shape::Template(set) => set.support(direction),
        }
    }

    /// A direction that separates this set from another, with its largest value over this set and
    /// its smallest one over the other. The second is larger. `None` if separation is not certain.
    pub(super) fn separation(&self, other: &Shape) -> Option<(Vec<f64>, f64, f64)> {
        if self.is_empty() || other.is_empty() {
            return None;
        }
        match (self, other) {
            (Shape::Planar(a), Shape::Planar(b)) => {
                a.separation(b).map(|s| (s.normal.to_vec(), s.first, s.second))
            }
            (Shape::Template(a), Shape::Template(b)) => {
                (0..a.limits.len()).find_map(|k| {
                    // Opposite directions are adjacent.
                    let (high, low) = (a.limits[k], -b.limits[k ^ 1]);
                    (high < low).then(|| (a.template.directions()[k].clone(), high, low))
                })
            }
            _ => None,
        }
    }
}

/// The limits of `{M z + c}` along every template direction, for z in a set.
fn pulled(set: &Polyhedron, pull: &[Combinations], offset: &[f64]) -> Polyhedron {
    if set.is_empty() {
        return set.clone();
    }
    let limit = |(direction, combinations): (&Vec<f64>, &Combinations)| {
        let bound = combinations.bound(&set.limits);
        let terms: Vec<f64> = direction.iter().zip(offset).map(|(d, c)| d * c).collect();
        let size = terms.iter().map(|t| t.abs()).sum::<f64>() + bound.abs();
        bound + terms.iter().sum::<f64>() + 8.0 * EPSILON * size
    };
    set.with_limits(set.template.directions().iter().zip(pull).map(limit).collect())
}
