//! Bounds of columns without any, from the curvature of the objective: what is not worse than the
//! claim lies around the least point.
//!
//! With `P + diag(d)` positive semidefinite and `d_j = -s_j` where the objective is steep,
//! `f(x) >= f(p) + sum_j (g_j (x_j - p_j) + s_j / 2 (x_j - p_j)^2)`, and each term is at least
//! `-g_j^2 / (2 s_j)`.

use super::claim::Claim;
use super::conjugate_gradients::curved_solution;
use super::tree::ProofWriter;

/// Steps of the method of conjugate gradients, for each column with curvature.
const STEPS_A_COLUMN: usize = 3;

/// How much larger than necessary the bounds are, for rounding (no unit).
const WIDENED: f64 = 1e-6;

/// A point, the gradient there, and how much the objective may still grow.
struct CurvaturePoint<'a> {
    point: &'a [f64],
    gradient: &'a [f64],
    room: f64,
}

impl ProofWriter<'_, '_> {
    /// Bounds the columns with curvature that have no bounds.
    pub(super) fn bound_by_curvature(&mut self) {
        let Claim::Bound(limit) = self.relaxer.claim else { return };
        let (program, deficits) = (&self.relaxer.program, &self.relaxer.deficits);
        let is_open = |j: usize| self.bounds.of(j).iter().any(|bound| bound.is_infinite());
        let steep: Vec<usize> = (0..deficits.len()).filter(|&j| deficits[j] < 0.0).collect();
        if !(0..deficits.len())
            .any(|j| is_open(j) && (deficits[j] < 0.0 || program.linear[j] != 0.0))
        {
            return;
        }
        let point = self.least_point(&steep);
        let gradient = program.gradient(&point);
        let (mut sizes, constant) = self.relaxer.terms.sizes(program.column_count());
        for (j, &p) in point.iter().enumerate().filter(|(_, p)| **p != 0.0) {
            let (rows, values) = program.quadratic_column(j);
            rows.iter().zip(values).for_each(|(&i, a)| sizes[i] += (a * p).abs());
        }
        // By how much each column can lower the objective.
        let (mut falls, mut sloped) = (Vec::new(), Vec::new());
        let mut least = program.objective(&point);
        let mut size = least.abs() + limit.abs() + constant;
        for (j, &g) in gradient.iter().enumerate() {
            let (surplus, [lower, upper]) = (-deficits[j], self.bounds.of(j));
            let rounding = f64::EPSILON * program.column_count() as f64 * sizes[j];
            let g = g.abs() + rounding;
            if surplus > 0.0 {
                let fall = (g * g / (2.0 * surplus)) * (1.0 + WIDENED);
                falls.push((j, fall));
                least -= fall;
                size += fall;
                continue;
            }
            let reach = (lower - point[j]).abs().max((upper - point[j]).abs());
            let side = if gradient[j] > 0.0 { point[j] - lower } else { upper - point[j] };
            let mut fall = 0.0;
            if gradient[j] != 0.0 {
                fall += g * side.abs();
                if surplus == 0.0 {
                    sloped.push((j, fall));
                }
            }
            if surplus < 0.0 {
                fall += 0.5 * -surplus * reach * reach;
            }
            if fall.is_nan() || fall.is_infinite() {
                return;
            }
            least -= fall;
            size += fall;
        }
        let room = limit - least + WIDENED * size.max(f64::MIN_POSITIVE);
        if room < 0.0 || !room.is_finite() {
            return;
        }
        let around = CurvaturePoint { point: &point, gradient: &gradient, room };
        let mut found = self.steep_bounds(&around, &falls);
        found.extend(self.sloped_bounds(&around, &sloped));
        let has_term = |j: usize| gradient[j] != 0.0 || deficits[j] > 0.0;
        let needed: Vec<usize> = (0..point.len()).filter(|&j| has_term(j)).collect();
        self.write_bounds(needed.into_iter().flat_map(|j| [(j, false), (j, true)]));
        let points = point.iter().copied().enumerate().filter(|(_, p)| *p != 0.0);
        self.log.curvature_bounds(points, falls.iter().copied(), &found);
        for (j, is_upper, value) in found {
            self.bounds.decide(&self.facts, j, is_upper, value);
        }
    }

    /// Bounds of columns with curvature, by what each may lower the objective.
    fn steep_bounds(
        &self,
        around: &CurvaturePoint<'_>,
        falls: &[(usize, f64)],
    ) -> Vec<(usize, bool, f64)> {
        let mut found = Vec::new();
        for &(j, fall) in falls {
            let surplus = -self.relaxer.deficits[j];
            // g r + s r^2 / 2 >= room - fall, for either sign of g.
            let g = around.gradient[j].abs();
            let radius = (g + (g * g + 2.0 * surplus * (around.room + fall)).sqrt()) / surplus;
            let radius = radius * (1.0 + WIDENED);
            let [lower, upper] = self.bounds.of(j);
            let [below, above] = self.range_around(j, around.point[j], radius);
            if lower.is_infinite() && below.is_finite() {
                found.push((j, false, below));
            }
            if upper.is_infinite() && above.is_finite() {
                found.push((j, true, above));
            }
        }
        found
    }

    /// Bounds of columns with a slope only.
    fn sloped_bounds(
        &self,
        around: &CurvaturePoint<'_>,
        falls: &[(usize, f64)],
    ) -> Vec<(usize, bool, f64)> {
        let mut found = Vec::new();
        for &(j, fall) in falls {
            let slope = around.gradient[j];
            let radius = (around.room + fall) / slope.abs() * (1.0 + WIDENED);
            let [lower, upper] = self.bounds.of(j);
            let [below, above] = self.range_around(j, around.point[j], radius);
            if slope < 0.0 && lower.is_infinite() && below.is_finite() {
                found.push((j, false, below));
            }
            if slope > 0.0 && upper.is_infinite() && above.is_finite() {
                found.push((j, true, above));
            }
        }
        found
    }

    /// Bounds of a column around a value; of an integral one, the next whole numbers. No fact is
    /// behind them, by which they could be rounded to whole numbers within.
    fn range_around(&self, column: usize, value: f64, radius: f64) -> [f64; 2] {
        let [below, above] = [value - radius, value + radius];
        match self.relaxer.program.integral[column] {
            true => [below.floor(), above.ceil()],
            false => [below, above],
        }
    }

    /// About the least point of the objective over some columns, the others at 0 or their nearest
    /// bound.
    fn least_point(&self, steep: &[usize]) -> Vec<f64> {
        let program = &self.relaxer.program;
        let start = |j: usize| {
            let [lower, upper] = self.bounds.of(j);
            0.0_f64.max(lower).min(upper)
        };
        let mut point: Vec<f64> = (0..program.column_count()).map(start).collect();
        let gradient = program.gradient(&point);
        let right: Vec<f64> = steep.iter().map(|&j| -gradient[j]).collect();
        let moved = curved_solution(program, steep, &right, STEPS_A_COLUMN * steep.len());
        steep.iter().zip(moved).for_each(|(&j, step)| point[j] += step);
        point
    }
}
