//! Template polyhedra: outer approximations of sets of any number of states.
//!
//! A template is a fixed list of directions; a set is the list of its limits along them. The limit
//! of an image along `d` is the set's support along `Mᵀ d`, which is bounded by every way to write
//! `Mᵀ d` as a non-negative combination of template directions (linear programming duality). The
//! combinations are found once for each map, so a step needs no linear program. Sets of one state
//! are exact, and so are boxes under diagonal maps.

use std::sync::Arc;

use super::rounding::EPSILON;
use crate::tolerance::largest_magnitude;

/// The largest number of template directions for which combinations of three are tried.
const MOST_TRIPLES: usize = 20;

/// The directions of a template; the axes' come first, `+` before `-`.
#[derive(Debug)]
pub(super) struct Template {
    directions: Vec<Vec<f64>>,
    own: Vec<Combinations>,
}

/// A set, by its limits along the template's directions; the empty set if `limits` is empty.
#[derive(Debug, Clone)]
pub(super) struct Polyhedron {
    pub(super) template: Arc<Template>,
    pub(super) limits: Vec<f64>,
}

/// Ways to write one direction as a combination of template directions.
#[derive(Debug, Clone)]
pub(super) struct Combinations {
    ways: Vec<Vec<(usize, f64)>>,
    /// The residual of each way, whose product with the state is bounded over the set's box.
    rests: Vec<Vec<f64>>,
    /// Error bound of the direction, entry by entry.
    error: Vec<f64>,
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

impl Template {
    /// The axes, and further directions.
    pub(super) fn new(states: usize, further: &[Vec<f64>]) -> Self {
        let mut template = Template { directions: Vec::new(), own: Vec::new() };
        for axis in 0..states {
            for sign in [1.0, -1.0] {
                let mut direction = vec![0.0; states];
                direction[axis] = sign;
                template.directions.push(direction);
            }
        }
        for direction in further {
            for sign in [1.0, -1.0] {
                let signed: Vec<f64> = direction.iter().map(|x| sign * x).collect();
                if largest_magnitude(&signed) > 0.0 && template.multiple(&signed).is_none() {
                    template.directions.push(signed);
                }
            }
        }
        let exact = vec![0.0; states];
        template.own =
            template.directions.iter().map(|d| template.combinations(d, &exact)).collect();
        template
    }

    pub(super) fn states(&self) -> usize {
        self.directions[0].len()
    }

    pub(super) fn directions(&self) -> &[Vec<f64>] {
        &self.directions
    }

    /// The template direction of which `normal` is a positive multiple, with the factor.
    pub(super) fn multiple(&self, normal: &[f64]) -> Option<(usize, f64)> {
        let size = dot(normal, normal);
        if size == 0.0 {
            return None;
        }
        self.directions.iter().enumerate().find_map(|(k, direction)| {
            let factor = dot(normal, direction) / dot(direction, direction);
            let rest = normal.iter().zip(direction).map(|(n, d)| n - factor * d);
            (factor > 0.0 && largest_magnitude(rest) == 0.0).then_some((k, factor))
        })
    }

    /// The combinations that give a direction, which is known up to an error per entry.
    pub(super) fn combinations(&self, target: &[f64], error: &[f64]) -> Combinations {
        let (ways, rests) = (Vec::new(), Vec::new());
        let mut found = Combinations { ways, rests, error: error.to_vec() };
        // Along the axes, which always works.
        let axes = target.iter().enumerate().filter(|(_, t)| **t != 0.0);
        let along = axes.map(|(i, t)| (2 * i + usize::from(*t < 0.0), t.abs())).collect();
        self.keep(&mut found, target, along);
        if let Some(one) = self.multiple(target) {
            self.keep(&mut found, target, vec![one]);
        }
        let count = self.directions.len();
        for first in 0..count {
            for second in first + 1..count {
                self.solve(&mut found, target, &[first, second]);
                if count <= MOST_TRIPLES && self.states() > 2 {
                    for third in second + 1..count {
                        self.solve(&mut found, target, &[first, second, third]);
                    }
                }
            }
        }
        found
    }

    fn keep(&self, found: &mut Combinations, target: &[f64], way: Vec<(usize, f64)>) {
        let mut rest = target.to_vec();
        for &(k, factor) in &way {
            for (r, d) in rest.iter_mut().zip(&self.directions[k]) {
                *r -= factor * d;
            }
        }
        let size = largest_magnitude(target);
        if largest_magnitude(&rest) <= 1e-12 * size && !found.ways.contains(&way) {
            // The subtraction itself rounds, so the rest is enlarged a little.
            let rounding = (8 + target.len()) as f64 * EPSILON * size;
            let errors = rest.iter().zip(&found.error);
            found.rests.push(errors.map(|(r, error)| r.abs() + error + rounding).collect());
            found.ways.push(way);
        }
    }

    /// Keeps the combination of a few directions, if it has no negative coefficient.
    fn solve(&self, found: &mut Combinations, target: &[f64], chosen: &[usize]) {
        // Normal equations of at most three unknowns, by elimination with pivots.
        let n = chosen.len();
        let mut rows = [[0.0_f64; 4]; 3];
        for (row, &p) in rows.iter_mut().zip(chosen) {
            for (entry, &q) in row.iter_mut().zip(chosen) {
                *entry = dot(&self.directions[p], &self.directions[q]);
            }
            row[3] = dot(&self.directions[p], target);
        }
        for k in 0..n {
            let pivot = (k..n).max_by(|&i, &j| rows[i][k].abs().total_cmp(&rows[j][k].abs()));
            let Some(pivot) = pivot else { return };
            rows.swap(k, pivot);
            if rows[k][k].abs() < 1e-9 {
                return;
            }
            for i in 0..n {
                if i != k {
                    let factor = rows[i][k] / rows[k][k];
                    let above = rows[k];
                    rows[i].iter_mut().zip(above).for_each(|(x, y)| *x -= factor * y);
                }
            }
        }
        let factors = (0..n).map(|k| rows[k][3] / rows[k][k]);
        let way: Vec<(usize, f64)> = chosen.iter().copied().zip(factors).collect();
        if way.iter().all(|&(_, factor)| factor > 0.0) {
            self.keep(found, target, way);
        }
    }
}

impl Combinations {
    /// An upper bound of the direction over the set with these limits along the template.
    pub(super) fn bound(&self, limits: &[f64]) -> f64 {
        let mut best = f64::INFINITY;
        for (way, rest) in self.ways.iter().zip(&self.rests) {
            let mut sum = 0.0;
            let mut size = 0.0;
            for &(k, factor) in way {
                sum += factor * limits[k];
                size += (factor * limits[k]).abs();
            }
            for (i, r) in rest.iter().enumerate() {
                sum += r * limits[2 * i].abs().max(limits[2 * i + 1].abs());
            }
            best = best.min(sum + (8 + rest.len()) as f64 * EPSILON * size);
        }
        best
    }
}

impl Polyhedron {
    /// The box `[low, high]`.
    pub(super) fn from_box(template: &Arc<Template>, low: &[f64], high: &[f64]) -> Self {
        let limit = |direction: &Vec<f64>| {
            let ends = direction.iter().zip(low.iter().zip(high));
            let terms: Vec<f64> = ends.map(|(d, (l, h))| (d * l).max(d * h)).collect();
            terms.iter().sum::<f64>() + 8.0 * EPSILON * terms.iter().map(|t| t.abs()).sum::<f64>()
        };
        Polyhedron {
            template: Arc::clone(template),
            limits: template.directions.iter().map(limit).collect(),
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.limits.is_empty()
    }

    /// An upper bound of `direction . z`. The combinations of template directions are known, those
    /// of others are found first.
    pub(super) fn support(&self, direction: &[f64]) -> f64 {
        let known = self.template.directions.iter().position(|own| own == direction);
        if let Some(own) = known.and_then(|k| self.template.own.get(k)) {
            return own.bound(&self.limits);
        }
        let exact = vec![0.0; direction.len()];
        self.template.combinations(direction, &exact).bound(&self.limits)
    }

    /// An upper bound of `direction . z`, from one template direction or from the axes.
    pub(super) fn rough_support(&self, direction: &[f64]) -> f64 {
        if self.is_empty() {
            return f64::NEG_INFINITY;
        }
        let (mut sum, mut size) = (0.0, 0.0);
        for (i, d) in direction.iter().enumerate().filter(|(_, d)| **d != 0.0) {
            let term = d.abs() * self.limits[2 * i + usize::from(*d < 0.0)];
            sum += term;
            size += term.abs();
        }
        let axes = sum + (8 + direction.len()) as f64 * EPSILON * size;
        match self.template.multiple(direction) {
            Some((k, factor)) => {
                let along = factor * self.limits[k];
                axes.min(along + 4.0 * EPSILON * along.abs())
            }
            None => axes,
        }
    }

    /// A set of the same template.
    pub(super) fn with_limits(&self, limits: Vec<f64>) -> Self {
        Polyhedron { template: Arc::clone(&self.template), limits }
    }

    /// Lowers the limit along a template direction.
    pub(super) fn lower(&mut self, direction: usize, limit: f64) {
        if let Some(current) = self.limits.get_mut(direction) {
            *current = current.min(limit);
        }
    }

    /// Propagates every limit to the others. Crossed limits of opposite directions mean that the
    /// set is empty.
    pub(super) fn settle(&mut self) {
        if self.is_empty() {
            return;
        }
        for (k, combinations) in self.template.own.iter().enumerate() {
            let bound = combinations.bound(&self.limits);
            self.limits[k] = self.limits[k].min(bound);
        }
        // Opposite directions are adjacent.
        let crossed = self.limits.chunks(2).any(|pair| pair.len() == 2 && pair[0] + pair[1] < 0.0);
        if crossed {
            self.limits.clear();
        }
    }

    /// The smallest set of the template that contains both.
    pub(super) fn join(&self, other: &Polyhedron) -> Self {
        if self.is_empty() {
            return other.clone();
        }
        if other.is_empty() {
            return self.clone();
        }
        let limits = self.limits.iter().zip(&other.limits).map(|(a, b)| a.max(*b)).collect();
        self.with_limits(limits)
    }
}
