//! A strictly convex program as a problem of least distance: with `P = L L'` and
//! `u = L'x + L⁻¹q`, the objective is `1/2 |u|²` up to a constant, and a row `a'x` becomes
//! `(L⁻¹a)'u` up to a constant.
//!
//! Where the curvature has no pivot, the program gets one: `1/2 e (x - c)²` around a centre `c`
//! that follows the optimum (Rockafellar, Monotone operators and the proximal point algorithm, SIAM
//! Journal on Control and Optimization 14, 1976).

use super::parameters::{MAX_CONCAVITY, MAX_ROW_VIOLATION, MIN_CHOLESKY_PIVOT};
use super::triangle::{LowerTriangle, dot};
use crate::presolve::Reduced;
use crate::tolerance::largest_magnitude;

/// A finite limit of a row or of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LimitSide {
    Lower,
    Upper,
    /// Both, at the same value: the multiplier may have either sign.
    Both,
}

impl LimitSide {
    /// Whether the multiplier of a limit has a sign that none may have.
    pub(super) fn refuses(self, multiplier: f64) -> bool {
        match self {
            LimitSide::Lower => multiplier > 0.0,
            LimitSide::Upper => multiplier < 0.0,
            LimitSide::Both => false,
        }
    }
}

/// A row of the program, or (from the number of rows on) a column, in the metric of `P`.
#[derive(Debug, Clone, Copy)]
struct Image {
    /// Where its unit vector begins.
    begin: usize,
    /// The factor from the unit vector to the vector itself.
    size: f64,
    /// The unit vector times `L⁻¹q`.
    shift: f64,
}

/// A reduced program, and its limits in the metric of its curvature.
#[derive(Debug)]
pub(super) struct Metric<'a> {
    pub(super) program: &'a Reduced,
    factor: LowerTriangle,
    /// `L⁻¹q`, with the pull towards the centre.
    shift: Vec<f64>,
    /// By column: what was added to its curvature.
    added: Vec<f64>,
    /// By column: the centre, where `added` is positive.
    centre: Vec<f64>,
    images: Vec<Option<Image>>,
    vectors: Vec<f64>,
    /// By row: its largest coefficient.
    largest: Vec<f64>,
}

impl<'a> Metric<'a> {
    /// `None` if the program is not convex, up to rounding.
    ///
    /// # Arguments
    ///
    /// * `proximal_pivot`: the pivot that a column without one gets, as a fraction of a typical
    ///   diagonal entry.
    pub(super) fn new(program: &'a Reduced, proximal_pivot: f64) -> Option<Self> {
        let n = program.columns.len();
        let mut added = vec![0.0; n];
        let diagonal = |j: usize| {
            let (index, value) = program.quadratic.vector(j);
            index.iter().zip(value).filter(|(i, _)| **i == j).map(|(_, p)| p).sum::<f64>()
        };
        let typical = (0..n).map(diagonal).sum::<f64>() / n.max(1) as f64;
        let mut factor = LowerTriangle::default();
        let mut row = vec![0.0; n];
        for j in 0..n {
            row[..=j].fill(0.0);
            let (index, value) = program.quadratic.vector(j);
            index.iter().zip(value).for_each(|(&i, &p)| row[i] += p);
            let diagonal = row[j];
            let zeros = index.iter().copied().min().unwrap_or(j).min(j);
            factor.solve(&mut row[..j], zeros);
            let mut pivot = diagonal - dot(&row[zeros..j], &row[zeros..j]);
            if !(pivot > MIN_CHOLESKY_PIVOT * diagonal && pivot.is_finite()) {
                let size = diagonal.max(typical);
                if !(pivot > -MAX_CONCAVITY * size && size > 0.0 && size.is_finite()) {
                    return None;
                }
                added[j] = proximal_pivot * size - pivot;
                pivot = proximal_pivot * size;
            }
            factor.push_sparse(&row[..j], pivot.sqrt(), zeros);
        }
        let mut shift = program.linear.clone();
        factor.solve(&mut shift, 0);
        let centre = vec![0.0; n];
        let most = |i| largest_magnitude(program.rows.vector(i).1);
        let largest: Vec<f64> = (0..program.rows.len()).map(most).collect();
        let images = vec![None; program.rows.len() + n];
        Some(Metric { program, factor, shift, added, centre, images, vectors: Vec::new(), largest })
    }

    /// The columns whose curvature was added to.
    pub(super) fn flat(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.added.len()).filter(|&j| self.added[j] > 0.0)
    }

    /// Begins with a centre at some values; the other columns stay at 0.
    pub(super) fn begin_at(&mut self, values: impl Iterator<Item = (usize, f64)>) {
        let mut centre = std::mem::take(&mut self.centre);
        values.for_each(|(k, value)| centre[k] = value);
        let is_elsewhere = self.flat().any(|k| centre[k] != 0.0);
        self.centre = centre.clone();
        if is_elsewhere {
            self.move_centre(&centre);
        }
    }

    /// At most what the objective of a point may be above the optimum because the point is pulled
    /// towards the centre: within the bounds, and in their absence near the point.
    pub(super) fn pull(&self, x: &[f64]) -> [f64; 2] {
        let mut sums = [0.0; 2];
        for j in self.flat() {
            let pull = self.added[j] * (x[j] - self.centre[j]).abs();
            let width = self.program.upper[j] - self.program.lower[j];
            if pull > 0.0 {
                sums[0] += pull * width;
                sums[1] += pull * width.min(x[j].abs() + 1.0);
            }
        }
        sums
    }

    /// Moves the centre to a point. Levels of limits are others then.
    pub(super) fn move_centre(&mut self, x: &[f64]) {
        self.centre.copy_from_slice(x);
        let pulled = self.program.linear.iter().zip(&self.added).zip(x);
        self.shift = pulled.map(|((q, e), x)| q - e * x).collect();
        self.factor.solve(&mut self.shift, 0);
        for image in self.images.iter_mut().flatten() {
            let vector = &self.vectors[image.begin..image.begin + self.shift.len()];
            image.shift = dot(vector, &self.shift);
        }
    }

    /// Number of rows and columns.
    pub(super) fn len(&self) -> usize {
        self.images.len()
    }

    fn image(&mut self, k: usize) -> Image {
        if let Some(image) = self.images[k] {
            return image;
        }
        let (n, m) = (self.program.columns.len(), self.program.rows.len());
        let begin = self.vectors.len();
        self.vectors.resize(begin + n, 0.0);
        let vector = &mut self.vectors[begin..];
        let mut first = n;
        if k < m {
            let (index, value) = self.program.rows.vector(k);
            for (&j, &a) in index.iter().zip(value) {
                vector[j] += a;
                first = first.min(j);
            }
        } else {
            first = k - m;
            vector[first] = 1.0;
        }
        self.factor.solve(vector, first);
        let size = dot(vector, vector).sqrt();
        // A row without coefficients keeps its vector of zeros, which depends on any others.
        let size = if size > 0.0 { size } else { 1.0 };
        vector.iter_mut().for_each(|v| *v /= size);
        let image = Image { begin, size, shift: dot(vector, &self.shift) };
        self.images[k] = Some(image);
        image
    }

    /// The unit vector of a row or column, and its size.
    pub(super) fn unit(&mut self, k: usize) -> (&[f64], f64) {
        let image = self.image(k);
        (&self.vectors[image.begin..image.begin + self.shift.len()], image.size)
    }

    /// The unit vector of a row or column that [`unit`](Self::unit) has computed.
    pub(super) fn known(&self, k: usize) -> &[f64] {
        let begin = self.images[k].map_or(0, |image| image.begin);
        &self.vectors[begin..begin + self.shift.len()]
    }

    /// The value that the unit vector takes at a limit.
    pub(super) fn level(&mut self, k: usize, side: LimitSide) -> f64 {
        let image = self.image(k);
        self.limit(k, side) / image.size + image.shift
    }

    /// The limit itself.
    pub(super) fn limit(&self, k: usize, side: LimitSide) -> f64 {
        let [lower, upper] = self.limits(k);
        if side == LimitSide::Upper { upper } else { lower }
    }

    /// Both limits of a row or column.
    pub(super) fn limits(&self, k: usize) -> [f64; 2] {
        let (program, m) = (self.program, self.program.rows.len());
        match k.checked_sub(m) {
            None => [program.row_lower[k], program.row_upper[k]],
            Some(j) => [program.lower[j], program.upper[j]],
        }
    }

    /// The point of a `u`.
    pub(super) fn point(&self, u: &[f64]) -> Vec<f64> {
        let mut x: Vec<f64> = u.iter().zip(&self.shift).map(|(u, v)| u - v).collect();
        self.factor.solve_transposed(&mut x);
        x
    }

    /// The objective of a `u`.
    pub(super) fn objective(&self, u: &[f64]) -> f64 {
        let halves = u.iter().zip(&self.shift).map(|(u, v)| 0.5 * (u - v) * (u + v));
        halves.sum::<f64>() + self.program.offset
    }

    /// The value of a row or column at a point.
    pub(super) fn value(&self, k: usize, x: &[f64]) -> f64 {
        match k.checked_sub(self.largest.len()) {
            None => {
                let (index, value) = self.program.rows.vector(k);
                index.iter().zip(value).map(|(&j, a)| a * x[j]).sum()
            }
            Some(j) => x[j],
        }
    }

    /// The row or column that a point violates most, in units of its largest coefficient.
    pub(super) fn most_violated(&self, x: &[f64], skip: &[bool]) -> Option<(usize, LimitSide)> {
        let mut most = 0.0;
        let mut found = None;
        for k in (0..self.len()).filter(|&k| !skip[k]) {
            let [lower, upper] = self.limits(k);
            if lower == f64::NEG_INFINITY && upper == f64::INFINITY {
                continue;
            }
            let value = self.value(k, x);
            let (by, side) = if lower - value > value - upper {
                (lower - value, LimitSide::Lower)
            } else {
                (value - upper, LimitSide::Upper)
            };
            let unit = self.largest.get(k).copied().unwrap_or(1.0);
            let limit = if side == LimitSide::Lower { lower } else { upper };
            if by > MAX_ROW_VIOLATION * unit.max(limit.abs()) && by / unit > most {
                (most, found) = (by / unit, Some((k, side)));
            }
        }
        let both = |(k, side): (usize, LimitSide)| {
            let [lower, upper] = self.limits(k);
            (k, if lower == upper { LimitSide::Both } else { side })
        };
        found.map(both)
    }
}
