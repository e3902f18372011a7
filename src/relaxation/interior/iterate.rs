//! The iterates of the interior-point method: what they prove, and the next one.

use super::kkt::Kkt;
use super::scaled::{Scaled, Target};

/// Fraction of the way to the nearest side that a step may go.
const FRACTION: f64 = 0.995;

/// Smallest initial slack of a row's side, in scaled units.
const FIRST_SLACK: f64 = 1.0;

/// Complementarity, in scaled units, that nothing is gained by reducing.
const CLOSED: f64 = 1e-9;

/// Margin of a certificate of infeasibility, relative to its terms.
const MARGIN: f64 = 1e-8;

/// Most steps of iterative refinement of a direction. The predictor only says how far to centre.
const REFINEMENTS: usize = 2;
const PREDICTOR_REFINEMENTS: usize = 0;

/// The residual of a direction, in scaled units and as a part of the mean complementarity, at which
/// there is nothing to refine: what is left is taken out by the next step.
const ACCURATE: f64 = 1e-11;
const ACCURATE_PART: f64 = 1e-3;

/// A primal-dual point with its residuals.
pub(super) struct Iterate {
    pub(super) x: Vec<f64>,
    /// By row: of equalities the unknown itself, of inequalities the difference of their sides'.
    pub(super) multipliers: Vec<f64>,
    slack: Vec<f64>,
    dual: Vec<f64>,
    // What `measure` computes.
    activity: Vec<f64>,
    curvature: Vec<f64>,
    /// `A'y`.
    pressed: Vec<f64>,
    dual_residual: Vec<f64>,
    equality_residual: Vec<f64>,
    side_residual: Vec<f64>,
    barrier: f64,
    // Work space of `advance`.
    right: Vec<f64>,
    target: Vec<f64>,
    scratch: Vec<f64>,
    residual: Vec<f64>,
    column_weight: Vec<f64>,
    row_weight: Vec<f64>,
    row_term: Vec<f64>,
    row_move: Vec<f64>,
    slack_move: Vec<f64>,
    dual_move: Vec<f64>,
    centre: Vec<f64>,
}

impl Iterate {
    /// A start inside the box.
    pub(super) fn start(program: &Scaled) -> Self {
        let (n, m, k) = (program.column.len(), program.rows.len(), program.sides.len());
        let inside = |(&lower, &upper): (&f64, &f64)| {
            let room = (0.5 * (upper - lower)).min(1.0);
            0.0_f64.max(lower + room).min(upper - room)
        };
        let x: Vec<f64> = program.lower.iter().zip(&program.upper).map(inside).collect();
        let mut activity = vec![0.0; m];
        program.activities(&x, &mut activity);
        let mut slack = Vec::with_capacity(k);
        for side in &program.sides {
            slack.push(match side.target {
                Target::Column(j) => (side.sign * (x[j] - side.limit)).max(1e-10),
                Target::Row(i) => (side.sign * (activity[i] - side.limit)).max(FIRST_SLACK),
            });
        }
        let dual: Vec<f64> = slack.iter().map(|s| 1.0 / s).collect();
        Iterate {
            x,
            multipliers: vec![0.0; m],
            slack,
            dual,
            activity,
            curvature: vec![0.0; n],
            pressed: vec![0.0; n],
            dual_residual: vec![0.0; n],
            equality_residual: vec![0.0; program.equalities.len()],
            side_residual: vec![0.0; k],
            barrier: 0.0,
            right: Vec::new(),
            target: Vec::new(),
            scratch: vec![0.0; n],
            residual: Vec::new(),
            column_weight: vec![0.0; n],
            row_weight: vec![0.0; m],
            row_term: vec![0.0; m],
            row_move: vec![0.0; m],
            slack_move: vec![0.0; k],
            dual_move: vec![0.0; k],
            centre: vec![0.0; k],
        }
    }

    /// Computes residuals and what the checks below need.
    pub(super) fn measure(&mut self, program: &Scaled) {
        program.activities(&self.x, &mut self.activity);
        program.curvature(&self.x, &mut self.curvature);
        for side in &program.sides {
            if let Target::Row(i) = side.target {
                self.multipliers[i] = 0.0;
            }
        }
        for (side, z) in program.sides.iter().zip(&self.dual) {
            if let Target::Row(i) = side.target {
                self.multipliers[i] -= side.sign * z;
            }
        }
        self.pressed.fill(0.0);
        program.add_transposed(&self.multipliers, &mut self.pressed);
        for j in 0..self.x.len() {
            self.dual_residual[j] = self.curvature[j] + program.linear[j] + self.pressed[j];
        }
        self.barrier = 0.0;
        for (k, side) in program.sides.iter().enumerate() {
            let target = match side.target {
                Target::Column(j) => {
                    self.dual_residual[j] -= side.sign * self.dual[k];
                    self.x[j]
                }
                Target::Row(i) => self.activity[i],
            };
            self.side_residual[k] = side.sign * (target - side.limit) - self.slack[k];
            self.barrier += self.slack[k] * self.dual[k];
        }
        for (residual, &(i, limit)) in self.equality_residual.iter_mut().zip(&program.equalities) {
            *residual = self.activity[i] - limit;
        }
    }

    pub(super) fn is_finite(&self) -> bool {
        self.barrier.is_finite() && self.dual_residual.iter().all(|r| r.is_finite())
    }

    /// The largest violation of a row or a side, relative to its limit.
    pub(super) fn violation(&self, program: &Scaled) -> f64 {
        let sides = program.sides.iter().zip(&self.side_residual).zip(&self.slack);
        let sides = sides.map(|((side, r), s)| -(r + s) / side.limit.abs().max(1.0));
        let equalities = program.equalities.iter().zip(&self.equality_residual);
        let equalities = equalities.map(|((_, limit), r)| r.abs() / limit.abs().max(1.0));
        sides.chain(equalities).fold(0.0, f64::max)
    }

    /// Objective, scaled, without the constant.
    pub(super) fn value(&self, program: &Scaled) -> f64 {
        let terms = self.x.iter().zip(&program.linear).zip(&self.curvature);
        terms.map(|((x, q), p)| x * (q + 0.5 * p)).sum()
    }

    /// What the multipliers prove over the box, scaled: see [`lower_bound`](super::super::lower_bound).
    pub(super) fn dual_value(&self, program: &Scaled) -> f64 {
        let bent: f64 = self.x.iter().zip(&self.curvature).map(|(x, p)| -0.5 * x * p).sum();
        let gradient = |j: usize| self.curvature[j] + program.linear[j] + self.pressed[j];
        bent - self.limits(program).0 + self.corner(program, &gradient).0
    }

    /// What complementarity and residuals of the duals may add up to, scaled: the gap where columns
    /// without bounds leave `dual_value` infinite.
    pub(super) fn estimated_gap(&self) -> f64 {
        let residuals = self.dual_residual.iter().zip(&self.x);
        let residuals: f64 = residuals.map(|(r, x)| r.abs() * x.abs().max(1.0)).sum();
        self.barrier + residuals
    }

    /// Whether the gap is closed but for residuals of the duals that rounding brings back.
    pub(super) fn diverges(&self) -> bool {
        let residual = self.dual_residual.iter().fold(0.0_f64, |m, r| m.max(r.abs()));
        self.barrier < CLOSED && residual > 1e3 * CLOSED
    }

    /// Whether the multipliers prove that no point of the box satisfies the rows.
    pub(super) fn refutes(&self, program: &Scaled) -> bool {
        let (limits, size) = self.limits(program);
        if size == 0.0 {
            return false;
        }
        let (corner, reach) = self.corner(program, &|j| self.pressed[j]);
        corner - limits > MARGIN * (size + reach)
    }

    /// The sum of multipliers times the limits that they press on, and of its terms' magnitudes.
    fn limits(&self, program: &Scaled) -> (f64, f64) {
        let (mut sum, mut size) = (0.0, 0.0);
        for &(i, limit) in &program.equalities {
            sum += self.multipliers[i] * limit;
            size += self.multipliers[i].abs() * limit.abs().max(1.0);
        }
        for (side, z) in program.sides.iter().zip(&self.dual) {
            if let Target::Row(_) = side.target {
                sum -= side.sign * z * side.limit;
                size += z * side.limit.abs().max(1.0);
            }
        }
        (sum, size)
    }

    /// The smallest value of a linear function over the box, and the sum of its terms' magnitudes.
    fn corner(&self, program: &Scaled, gradient: &dyn Fn(usize) -> f64) -> (f64, f64) {
        let (mut sum, mut size) = (0.0, 0.0);
        for j in 0..self.x.len() {
            let g = gradient(j);
            if g == 0.0 {
                continue;
            }
            let term = g * if g > 0.0 { program.lower[j] } else { program.upper[j] };
            sum += term;
            size += term.abs();
        }
        (sum, size)
    }

    /// Goes one predictor-corrector step; its length, or nothing where the system broke down.
    pub(super) fn advance(
        &mut self,
        program: &Scaled,
        kkt: &mut Kkt,
        late: &dyn Fn() -> bool,
    ) -> Option<f64> {
        let sides = program.sides.len();
        self.column_weight.fill(0.0);
        self.row_weight.fill(0.0);
        for (k, side) in program.sides.iter().enumerate() {
            let weight = self.dual[k] / self.slack[k];
            match side.target {
                Target::Column(j) => self.column_weight[j] += weight,
                Target::Row(i) => self.row_weight[i] += weight,
            }
        }
        if !kkt.factorise(&self.column_weight, &self.row_weight) || late() {
            return None;
        }
        let mean = self.barrier / sides.max(1) as f64;
        for k in 0..sides {
            self.centre[k] = self.slack[k] * self.dual[k];
        }
        let accurate = ACCURATE.max(ACCURATE_PART * mean);
        self.solve(program, kkt, (PREDICTOR_REFINEMENTS, accurate));
        let mut length = self.longest();
        if sides > 0 {
            let ahead: f64 = (0..sides)
                .map(|k| {
                    let s = self.slack[k] + length * self.slack_move[k];
                    s * (self.dual[k] + length * self.dual_move[k])
                })
                .sum();
            let target = (ahead / self.barrier).clamp(0.0, 1.0).powi(3) * mean;
            for k in 0..sides {
                self.centre[k] += self.slack_move[k] * self.dual_move[k] - target;
            }
            if late() {
                return None;
            }
            self.solve(program, kkt, (REFINEMENTS, accurate));
            length = (FRACTION * self.longest()).min(1.0);
        }
        let n = self.x.len();
        for (x, step) in self.x.iter_mut().zip(&self.right) {
            *x += length * step;
        }
        for (e, &(i, _)) in program.equalities.iter().enumerate() {
            self.multipliers[i] += length * self.right[n + e];
        }
        for k in 0..sides {
            self.slack[k] += length * self.slack_move[k];
            self.dual[k] += length * self.dual_move[k];
        }
        Some(length)
    }

    /// The direction for the right sides in `centre`, refined so often or to such a residual.
    fn solve(&mut self, program: &Scaled, kkt: &mut Kkt, (refinements, accurate): (usize, f64)) {
        let n = self.x.len();
        self.right.clear();
        self.right.extend(self.dual_residual.iter().map(|r| -r));
        self.right.extend(self.equality_residual.iter().map(|r| -r));
        self.right.resize(self.right.len() + kkt.long.len(), 0.0);
        // What a side contributes along the gradient of its target.
        self.row_term.fill(0.0);
        for (k, side) in program.sides.iter().enumerate() {
            let pull = self.centre[k] + self.dual[k] * self.side_residual[k];
            let term = -side.sign * pull / self.slack[k];
            match side.target {
                Target::Column(j) => self.right[j] += term,
                Target::Row(i) => self.row_term[i] += term,
            }
        }
        program.add_transposed(&self.row_term, &mut self.right[..n]);
        self.target.clear();
        self.target.extend_from_slice(&self.right);
        kkt.solve(&mut self.right);
        program.activities(&self.right[..n], &mut self.row_move);
        for _ in 0..refinements {
            self.miss(program, kkt);
            let miss = self.residual.iter().fold(0.0_f64, |m, r| m.max(r.abs()));
            if miss <= accurate || !miss.is_finite() {
                break;
            }
            kkt.solve(&mut self.residual);
            self.right.iter_mut().zip(&self.residual).for_each(|(v, r)| *v += r);
            program.activities(&self.right[..n], &mut self.row_move);
        }
        for (k, side) in program.sides.iter().enumerate() {
            let along = match side.target {
                Target::Column(j) => self.right[j],
                Target::Row(i) => self.row_move[i],
            };
            let step = side.sign * along + self.side_residual[k];
            self.slack_move[k] = step;
            self.dual_move[k] = -(self.centre[k] + self.dual[k] * step) / self.slack[k];
        }
    }

    /// A better start: the point that misses the sides least in the squares, traded against the
    /// objective, with what it misses as multipliers; both moved inside.
    pub(super) fn improve_start(
        &mut self,
        program: &Scaled,
        kkt: &mut Kkt,
        late: &dyn Fn() -> bool,
    ) -> bool {
        let n = self.x.len();
        self.x.fill(0.0);
        self.multipliers.fill(0.0);
        self.slack.fill(0.0);
        self.dual.fill(0.0);
        self.measure(program);
        self.column_weight.fill(0.0);
        self.row_weight.fill(0.0);
        for side in &program.sides {
            match side.target {
                Target::Column(j) => self.column_weight[j] += 1.0,
                Target::Row(i) => self.row_weight[i] += 1.0,
            }
        }
        if !kkt.factorise(&self.column_weight, &self.row_weight) || late() {
            return false;
        }
        // With unit slacks and duals of zero, a side pulls by its residual.
        self.slack.fill(1.0);
        self.dual.fill(1.0);
        self.centre.fill(0.0);
        self.solve(program, kkt, (REFINEMENTS, ACCURATE));
        self.x.copy_from_slice(&self.right[..n]);
        for (e, &(i, _)) in program.equalities.iter().enumerate() {
            self.multipliers[i] = self.right[n + e];
        }
        // The move of a slack is its value; the multiplier is its negative.
        let least = self.slack_move.iter().fold(f64::INFINITY, |m, s| m.min(*s));
        let most = self.slack_move.iter().fold(f64::NEG_INFINITY, |m, s| m.max(*s));
        let shift = if least < 1e-3 { 1.0 - least } else { 0.0 };
        let lift = if most > -1e-3 { 1.0 + most } else { 0.0 };
        for k in 0..program.sides.len() {
            self.slack[k] = self.slack_move[k] + shift;
            self.dual[k] = lift - self.slack_move[k];
        }
        true
    }

    /// By how much `right` misses the system with the right side `target`, into `residual`.
    fn miss(&mut self, program: &Scaled, kkt: &Kkt) {
        let (n, e) = (self.x.len(), program.equalities.len());
        self.residual.clear();
        self.residual.extend_from_slice(&self.target);
        let (columns, rest) = self.residual.split_at_mut(n);
        let (equalities, long) = rest.split_at_mut(e);
        program.curvature(&self.right[..n], &mut self.scratch);
        let weighted = self.column_weight.iter().zip(&self.right);
        for ((column, bent), (w, step)) in columns.iter_mut().zip(&self.scratch).zip(weighted) {
            *column -= bent + w * step;
        }
        for (i, term) in self.row_term.iter_mut().enumerate() {
            *term = -self.row_weight[i] * self.row_move[i];
        }
        for (k, &(i, _)) in program.equalities.iter().enumerate() {
            equalities[k] -= self.row_move[i];
            self.row_term[i] = -self.right[n + k];
        }
        for (k, &i) in kkt.long.iter().enumerate() {
            long[k] -= self.row_move[i] - self.right[n + e + k] / self.row_weight[i];
            self.row_term[i] = -self.right[n + e + k];
        }
        program.add_transposed(&self.row_term, columns);
    }

    /// How far slacks and duals stay positive, at most 1.
    fn longest(&self) -> f64 {
        let reach = |(v, step): (&f64, &f64)| if *step < 0.0 { -v / step } else { f64::INFINITY };
        let slack = self.slack.iter().zip(&self.slack_move).map(reach).fold(1.0, f64::min);
        self.dual.iter().zip(&self.dual_move).map(reach).fold(slack, f64::min)
    }
}
