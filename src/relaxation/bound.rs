//! Rigorous bounds from approximate multipliers.
//!
//! For any `x̂` and any row multipliers `y` (clipped where a limit is missing), convexity gives
//!
//! `f(x) >= offset - ½ x̂'Px̂ - Σ y_i limit_i + Σ_j g_j x_j`,  `g = q + Px̂ + A'y`,
//!
//! over all points that satisfy the rows, and the last sum is smallest at corners of the box. So
//! every pair `(x̂, y)` proves *some* bound; a good pair proves a tight one. Accumulated rounding is
//! subtracted. Columns without a finite bound on the side that `g` pulls to need `g_j = 0`: the
//! multipliers (or `x̂`, where the objective curves) are first corrected to make it so, and what
//! rounding leaves is charged over [`tolerance::FREE_RADIUS`].
//!
//! Where `x̂` was moved on columns `F` with `P_FF` positive definite, the gradient `r` that is left
//! there costs no radius: minimising over `d_F = x_F - x̂_F` for fixed `d_B` gives at least
//! `-‖r‖ ‖P_FF⁻¹‖ ‖P_FB‖ ‖d_B‖ - ½ ‖r‖² ‖P_FF⁻¹‖`, because the Schur complement of `P_FF` is
//! positive semidefinite.

use faer::Mat;
use faer::linalg::solvers::Solve;

use crate::presolve::Reduced;
use crate::tolerance;

/// A proved lower bound on the objective of a reduced program, from a claimed solution.
/// `-inf` when the pair proves nothing.
pub fn lower_bound(program: &Reduced, x: &[f64], y: &[f64]) -> f64 {
    if x.iter().chain(y).any(|v| !v.is_finite()) {
        return f64::NEG_INFINITY;
    }
    let y = clipped(program, y);
    let pair = Pair { program, x: x.to_vec(), y, objective: true, curved: None };
    pair.best_bound()
}

/// Whether row multipliers prove that a reduced program has no feasible point.
///
/// The certificate must survive a disturbance of every limit it uses, so that a program that is
/// infeasible by rounding only is not refuted.
pub fn proves_infeasible(program: &Reduced, y: &[f64]) -> bool {
    let size = y.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    if !(size > 0.0 && size.is_finite()) {
        return false;
    }
    let y: Vec<f64> = clipped(program, y).iter().map(|v| v / size).collect();
    let disturbance: f64 = (0..y.len())
        .map(|i| {
            let limit = if y[i] > 0.0 { program.row_upper[i] } else { program.row_lower[i] };
            if y[i] == 0.0 { 0.0 } else { y[i].abs() * limit.abs().max(1.0) }
        })
        .sum();
    let x = vec![0.0; program.columns.len()];
    let pair = Pair { program, x, y, objective: false, curved: None };
    pair.best_bound() > 1e-9 * disturbance
}

/// Multipliers without those that press on missing limits.
fn clipped(program: &Reduced, y: &[f64]) -> Vec<f64> {
    let limit = |i: usize, y: f64| {
        if y > 0.0 { program.row_upper[i] } else { program.row_lower[i] }
    };
    y.iter().enumerate().map(|(i, &y)| if limit(i, y).is_finite() { y } else { 0.0 }).collect()
}

struct Pair<'a> {
    program: &'a Reduced,
    x: Vec<f64>,
    y: Vec<f64>,
    /// Whether the objective takes part; certificates of infeasibility leave it out.
    objective: bool,
    /// The columns on which `x̂` was moved.
    curved: Option<Curved>,
}

/// Columns whose remaining gradient is absorbed by curvature.
struct Curved {
    member: Vec<bool>,
    /// `‖P_FF⁻¹‖` in the Frobenius norm.
    inverse: f64,
    /// `‖P_FB‖` in the Frobenius norm.
    coupling: f64,
}

/// `g` and, per entry, the accumulated magnitude that bounds its rounding error.
struct Gradient {
    value: Vec<f64>,
    size: Vec<f64>,
}

impl Pair<'_> {
    fn best_bound(mut self) -> f64 {
        let mut gradient = self.gradient();
        let stuck = self.unbounded_columns(&gradient);
        if !stuck.is_empty() {
            // All columns with an infinite side are corrected together, or fixing one unsettles
            // the next.
            let free: Vec<usize> = (0..self.x.len())
                .filter(|&j| {
                    self.program.lower[j].is_infinite() || self.program.upper[j].is_infinite()
                })
                .filter(|&j| {
                    let one_sided =
                        self.program.lower[j].is_finite() || self.program.upper[j].is_finite();
                    !one_sided || stuck.contains(&j)
                })
                .collect();
            for _ in 0..3 {
                if !self.correct(&free, &gradient) {
                    break;
                }
                gradient = self.gradient();
            }
        }
        self.bound(&gradient)
    }

    fn gradient(&self) -> Gradient {
        let program = self.program;
        let mut value =
            if self.objective { program.linear.clone() } else { vec![0.0; self.x.len()] };
        let mut size: Vec<f64> = value.iter().map(|v: &f64| v.abs()).collect();
        let mut add = |j: usize, term: f64| {
            value[j] += term;
            size[j] += term.abs();
        };
        if self.objective {
            for j in 0..self.x.len() {
                let (rows, entries) = program.quadratic.vector(j);
                for (&i, &p) in rows.iter().zip(entries) {
                    add(i, p * self.x[j]);
                    if i != j {
                        add(j, p * self.x[i]);
                    }
                }
            }
        }
        for (i, &y) in self.y.iter().enumerate().filter(|(_, y)| **y != 0.0) {
            let (columns, entries) = program.rows.vector(i);
            columns.iter().zip(entries).for_each(|(&j, &a)| add(j, a * y));
        }
        Gradient { value, size }
    }

    /// Columns whose gradient pulls towards a missing bound.
    fn unbounded_columns(&self, gradient: &Gradient) -> Vec<usize> {
        let pulls = |j: &usize| {
            let g = gradient.value[*j];
            (g > 0.0 && self.program.lower[*j].is_infinite())
                || (g < 0.0 && self.program.upper[*j].is_infinite())
        };
        (0..self.x.len()).filter(pulls).collect()
    }

    fn bound(&self, gradient: &Gradient) -> f64 {
        let program = self.program;
        let (mut sum, mut size) = (0.0, 0.0_f64);
        let mut add = |term: f64| {
            sum += term;
            size += term.abs();
        };
        if self.objective {
            add(program.offset);
            for j in 0..self.x.len() {
                let (rows, entries) = program.quadratic.vector(j);
                for (&i, &p) in rows.iter().zip(entries) {
                    let half = if i == j { 0.5 } else { 1.0 };
                    add(-half * p * self.x[i] * self.x[j]);
                }
            }
        }
        for (i, &y) in self.y.iter().enumerate() {
            if y != 0.0 {
                let limit = if y > 0.0 { program.row_upper[i] } else { program.row_lower[i] };
                add(-y * limit);
            }
        }
        let curved = |j: usize| self.curved.as_ref().is_some_and(|c| c.member[j]);
        let (mut residual, mut spread) = (0.0_f64, 0.0_f64);
        for j in 0..self.x.len() {
            // The gradient is known up to its rounding; take the worse end.
            let g = gradient.value[j];
            let error = 4.0 * f64::EPSILON * gradient.size[j];
            let reach = |bound: f64| {
                if bound.is_finite() { bound } else { bound.signum() * tolerance::FREE_RADIUS }
            };
            let (lower, upper) = (reach(program.lower[j]), reach(program.upper[j]));
            if curved(j) {
                // The term g_j x̂_j remains; the rest is charged below.
                add(g * self.x[j]);
                residual = residual.hypot(g.abs() + error);
                continue;
            }
            spread = spread.hypot((upper - self.x[j]).abs().max((self.x[j] - lower).abs()));
            let corner = (g * lower).min(g * upper);
            add(corner);
            add(-error * lower.abs().max(upper.abs()));
        }
        if let Some(Curved { inverse, coupling, .. }) = &self.curved {
            add(-residual * inverse * (coupling * spread + 0.5 * residual));
        }
        let bound = sum - 1e-15 * size * ((self.x.len() + self.y.len()) as f64).sqrt();
        if bound.is_nan() { f64::NEG_INFINITY } else { bound }
    }

    /// Makes the gradient vanish on the given columns: by moving `x̂` where the objective is
    /// strictly convex there, else by moving the multipliers of rows that press.
    fn correct(&mut self, free: &[usize], gradient: &Gradient) -> bool {
        const LARGEST_DENSE: usize = 400;
        if free.is_empty() || free.len() > LARGEST_DENSE {
            return false;
        }
        let k = free.len();
        let target = Mat::from_fn(k, 1, |r, _| -gradient.value[free[r]]);
        let mut position = vec![usize::MAX; self.x.len()];
        for (r, &j) in free.iter().enumerate() {
            position[j] = r;
        }
        let program = self.program;
        if self.objective {
            let (mut curvature, mut coupling) = (Mat::<f64>::zeros(k, k), 0.0_f64);
            for j in 0..self.x.len() {
                let (rows, entries) = program.quadratic.vector(j);
                for (&i, &p) in rows.iter().zip(entries) {
                    let (r, c) = (position[i], position[j]);
                    if r < k && c < k {
                        curvature[(r, c)] = p;
                        curvature[(c, r)] = p;
                    } else if r < k || c < k {
                        coupling = coupling.hypot(p);
                    }
                }
            }
            let well_posed = (0..k).all(|r| curvature[(r, r)] > 0.0);
            if well_posed && let Ok(factor) = curvature.llt(faer::Side::Lower) {
                let step = factor.solve(&target);
                let inverse = factor.solve(Mat::<f64>::identity(k, k)).norm_l2();
                let moved: Vec<f64> = (0..k).map(|r| step[(r, 0)]).collect();
                if inverse.is_finite() && moved.iter().all(|s| s.is_finite()) {
                    let member = position.iter().map(|&r| r < k).collect();
                    self.curved = Some(Curved { member, inverse, coupling });
                    free.iter().zip(moved).for_each(|(&j, s)| self.x[j] += s);
                    return true;
                }
            }
        }
        // Least change of the multipliers, weighted so that signs survive.
        let weight = |i: usize| {
            if program.row_lower[i] == program.row_upper[i] {
                1.0
            } else {
                self.y[i].abs().min(1.0)
            }
        };
        let mut normal = Mat::<f64>::zeros(k, k);
        let mut touched = Vec::new();
        for i in 0..self.y.len() {
            let (columns, values) = program.rows.vector(i);
            let part: Vec<(usize, f64)> = columns
                .iter()
                .zip(values)
                .filter(|(j, _)| position[**j] < k)
                .map(|(&j, &a)| (position[j], a))
                .collect();
            let w = weight(i).powi(2);
            if part.is_empty() || w == 0.0 {
                continue;
            }
            for &(r, a) in &part {
                for &(c, b) in &part {
                    normal[(r, c)] += w * a * b;
                }
            }
            touched.push((i, w, part));
        }
        let trace = (0..k).map(|r| normal[(r, r)]).fold(0.0, f64::max);
        for r in 0..k {
            normal[(r, r)] += 1e-13 * trace;
        }
        let Ok(factor) = normal.llt(faer::Side::Lower) else { return false };
        let solution = factor.solve(&target);
        for (i, w, part) in touched {
            let step: f64 = w * part.iter().map(|&(r, a)| a * solution[(r, 0)]).sum::<f64>();
            let moved = self.y[i] + step;
            let equality = program.row_lower[i] == program.row_upper[i];
            if moved.is_finite() && (equality || moved * self.y[i] >= 0.0) {
                self.y[i] = moved;
            }
        }
        true
    }
}
