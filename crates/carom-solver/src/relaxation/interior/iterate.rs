//! The iterates of the interior-point method: what they prove, and the next one.

use super::cone_iterate::ConeIterate;
use super::kkt::Kkt;
use super::parameters::{
    CENTRING, CERTIFICATE_MARGIN, CLOSED_COMPLEMENTARITY, CONE_ACCURACY, MAX_PREDICTOR_REFINEMENTS,
    MAX_REFINEMENTS, POOR_STEP, RESIDUAL_FRACTION, RESIDUAL_TOLERANCE, STEP_FRACTION,
};
use super::scaled::{OneSidedLimit, ScaledProgram};
use crate::solver::StopToken;
use crate::tolerance::largest_magnitude;

/// A primal-dual point with its residuals.
#[derive(Debug, Default)]
pub(super) struct Iterate {
    pub(super) x: Vec<f64>,
    /// By row: of equalities the unknown itself, of inequalities the difference of their sides'.
    pub(super) multipliers: Vec<f64>,
    pub(super) slack: Vec<f64>,
    pub(super) dual: Vec<f64>,
    pub(super) cones: ConeIterate,
    // Results of `measure`.
    pub(super) activity: Vec<f64>,
    pub(super) curvature: Vec<f64>,
    /// `A'y`, without `G'z` of cones.
    pub(super) pressed: Vec<f64>,
    pub(super) dual_residual: Vec<f64>,
    pub(super) equality_residual: Vec<f64>,
    pub(super) side_residual: Vec<f64>,
    pub(super) barrier: f64,
    // Work space of `advance`.
    pub(super) slack_inverse: Vec<f64>,
    pub(super) dual_inverse: Vec<f64>,
    pub(super) right: Vec<f64>,
    pub(super) target: Vec<f64>,
    pub(super) scratch: Vec<f64>,
    pub(super) residual: Vec<f64>,
    pub(super) column_weight: Vec<f64>,
    pub(super) row_weight: Vec<f64>,
    pub(super) row_term: Vec<f64>,
    pub(super) row_move: Vec<f64>,
    pub(super) slack_move: Vec<f64>,
    pub(super) dual_move: Vec<f64>,
    pub(super) centre: Vec<f64>,
}

impl Iterate {
    /// Computes residuals and what the checks below need.
    pub(super) fn measure(&mut self, program: &ScaledProgram) {
        program.activities(&self.x, &mut self.activity);
        program.curvature(&self.x, &mut self.curvature);
        let (rows, columns) = program.split_sides();
        rows.iter().for_each(|side| self.multipliers[side.of] = 0.0);
        for (side, z) in rows.iter().zip(&self.dual) {
            self.multipliers[side.of] -= side.sign * z;
        }
        self.pressed.fill(0.0);
        program.add_transposed(&self.multipliers, &mut self.pressed);
        let of_cones = self.cones.measure(&program.cones, &self.x, &mut self.pressed);
        for j in 0..self.x.len() {
            self.dual_residual[j] = self.curvature[j] + program.linear[j] + self.pressed[j];
        }
        for (side, z) in columns.iter().zip(&self.dual[rows.len()..]) {
            self.dual_residual[side.of] -= side.sign * z;
        }
        let (of_rows, of_columns) = self.side_residual.split_at_mut(rows.len());
        let room = |(side, value, slack): (&OneSidedLimit, f64, &f64)| {
            side.sign * (value - side.limit) - slack
        };
        for ((residual, side), slack) in of_rows.iter_mut().zip(rows).zip(&self.slack) {
            *residual = room((side, self.activity[side.of], slack));
        }
        let slacks = &self.slack[rows.len()..];
        for ((residual, side), slack) in of_columns.iter_mut().zip(columns).zip(slacks) {
            *residual = room((side, self.x[side.of], slack));
        }
        let of_sides: f64 = self.slack.iter().zip(&self.dual).map(|(s, z)| s * z).sum();
        self.barrier = of_sides + of_cones;
        for (residual, &(i, limit)) in self.equality_residual.iter_mut().zip(&program.equalities) {
            *residual = self.activity[i] - limit;
        }
    }

    pub(super) fn is_finite(&self) -> bool {
        self.barrier.is_finite() && self.dual_residual.iter().all(|r| r.is_finite())
    }

    /// The largest violation of a row or a side, relative to its limit.
    pub(super) fn violation(&self, program: &ScaledProgram) -> f64 {
        let sides = program.sides.iter().zip(&self.side_residual).zip(&self.slack);
        let sides = sides.map(|((side, r), s)| -(r + s) / side.limit.abs().max(1.0));
        let equalities = program.equalities.iter().zip(&self.equality_residual);
        let equalities = equalities.map(|((_, limit), r)| r.abs() / limit.abs().max(1.0));
        sides.chain(equalities).fold(self.cones.violation(&program.cones), f64::max)
    }

    /// Objective, scaled, without the constant.
    pub(super) fn value(&self, program: &ScaledProgram) -> f64 {
        let terms = self.x.iter().zip(&program.linear).zip(&self.curvature);
        terms.map(|((x, q), p)| x * (q + 0.5 * p)).sum()
    }

    /// The bound that the multipliers prove over the box, scaled: see
    /// [`Prover::lower_bound`](crate::relaxation::Prover::lower_bound).
    pub(super) fn dual_value(&self, program: &ScaledProgram) -> f64 {
        let bent: f64 = self.x.iter().zip(&self.curvature).map(|(x, p)| -0.5 * x * p).sum();
        let gradient = |j: usize| self.curvature[j] + program.linear[j] + self.pressed[j];
        bent - self.limits(program).0 + self.corner(program, &gradient).0
    }

    /// The bound that the multipliers would prove if the gradients of columns without bounds were
    /// 0, scaled, and the largest of these gradients.
    pub(super) fn promised_value(&self, program: &ScaledProgram) -> (f64, f64) {
        let bent: f64 = self.x.iter().zip(&self.curvature).map(|(x, p)| -0.5 * x * p).sum();
        let largest = std::cell::Cell::new(0.0_f64);
        let gradient = |j: usize| {
            let g = self.curvature[j] + program.linear[j] + self.pressed[j];
            let bound = if g > 0.0 { program.lower[j] } else { program.upper[j] };
            if bound.is_finite() {
                return g;
            }
            largest.set(largest.get().max(g.abs()));
            0.0
        };
        let corner = self.corner(program, &gradient).0;
        (bent - self.limits(program).0 + corner, largest.get())
    }

    /// The largest sum of complementarity and dual residuals, scaled: the gap if columns without
    /// bounds make `dual_value` infinite.
    pub(super) fn estimated_gap(&self) -> f64 {
        let residuals = self.dual_residual.iter().zip(&self.x);
        let residuals: f64 = residuals.map(|(r, x)| r.abs() * x.abs().max(1.0)).sum();
        self.barrier + residuals
    }

    /// Whether the gap is closed except for dual residuals at the level of rounding.
    pub(super) fn diverges(&self) -> bool {
        let residual = largest_magnitude(&self.dual_residual);
        self.barrier < CLOSED_COMPLEMENTARITY && residual > 1e3 * CLOSED_COMPLEMENTARITY
    }

    /// Whether the multipliers prove that no point of the box satisfies the rows.
    pub(super) fn refutes(&self, program: &ScaledProgram) -> bool {
        let (limits, size) = self.limits(program);
        if size == 0.0 {
            return false;
        }
        let (corner, reach) = self.corner(program, &|j| self.pressed[j]);
        corner - limits > CERTIFICATE_MARGIN * (size + reach)
    }

    /// The sum of multipliers times their active limits, and the sum of the magnitudes of its
    /// terms.
    fn limits(&self, program: &ScaledProgram) -> (f64, f64) {
        let (mut sum, mut size) = self.cones.limits(&program.cones);
        for &(i, limit) in &program.equalities {
            sum += self.multipliers[i] * limit;
            size += self.multipliers[i].abs() * limit.abs().max(1.0);
        }
        for (side, z) in program.split_sides().0.iter().zip(&self.dual) {
            sum -= side.sign * z * side.limit;
            size += z * side.limit.abs().max(1.0);
        }
        (sum, size)
    }

    /// The smallest value of a linear function over the box, and the sum of its terms' magnitudes.
    fn corner(&self, program: &ScaledProgram, gradient: &dyn Fn(usize) -> f64) -> (f64, f64) {
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

    /// Takes a predictor-corrector step. Returns its length, or `None` if the linear system broke
    /// down.
    pub(super) fn advance(
        &mut self,
        program: &ScaledProgram,
        kkt: &mut Kkt,
        token: &StopToken,
    ) -> Option<f64> {
        let sides = program.sides.len();
        let cones = &program.cones;
        if !self.cones.scale(cones) {
            return None;
        }
        self.invert();
        self.weigh(program);
        if !kkt.factorise(&self.column_weight, &self.row_weight, (cones, &self.cones))
            || token.is_over()
        {
            return None;
        }
        let count = sides + cones.len();
        let mean = self.barrier / count.max(1) as f64;
        for k in 0..sides {
            self.centre[k] = self.slack[k] * self.dual[k];
        }
        self.cones.aim_at_boundary();
        // Near the boundary of a cone, slight errors are large.
        let room = if cones.len() == 0 { mean } else { CONE_ACCURACY * mean.min(1.0) };
        let accurate = RESIDUAL_TOLERANCE.max(RESIDUAL_FRACTION * room);
        self.solve(program, kkt, (MAX_PREDICTOR_REFINEMENTS, accurate));
        let mut length = self.longest(program);
        if count > 0 {
            let ahead: f64 = (0..sides)
                .map(|k| {
                    let s = self.slack[k] + length * self.slack_move[k];
                    s * (self.dual[k] + length * self.dual_move[k])
                })
                .sum();
            let ahead = ahead + self.cones.ahead(length);
            let target = (ahead / self.barrier).clamp(0.0, 1.0).powi(3) * mean;
            for k in 0..sides {
                self.centre[k] += self.slack_move[k] * self.dual_move[k] - target;
            }
            self.cones.aim_at(cones, target);
            if token.is_over() {
                return None;
            }
            self.solve(program, kkt, (MAX_REFINEMENTS, accurate));
            length = (STEP_FRACTION * self.longest(program)).min(1.0);
            // Slacks and multipliers whose products are far apart block each other.
            if cones.len() > 0 && length < POOR_STEP {
                let target = CENTRING * mean;
                for k in 0..sides {
                    self.centre[k] = self.slack[k] * self.dual[k] - target;
                }
                self.cones.aim_at_centre(cones, target);
                self.solve(program, kkt, (MAX_REFINEMENTS, accurate));
                length = (STEP_FRACTION * self.longest(program)).min(1.0);
            }
        }
        // The point stays where it is if the system was too bad.
        if !self.right.iter().all(|step| step.is_finite()) {
            return None;
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
        self.cones.step(length);
        Some(length)
    }

    /// The direction for the right sides in `centre`, refined a given number of times or to a given
    /// residual.
    pub(super) fn solve(
        &mut self,
        program: &ScaledProgram,
        kkt: &mut Kkt,
        (refinements, accurate): (usize, f64),
    ) {
        let n = self.x.len();
        self.right.clear();
        self.right.extend(self.dual_residual.iter().map(|r| -r));
        self.right.extend(self.equality_residual.iter().map(|r| -r));
        self.right.resize(self.right.len() + kkt.long().len(), 0.0);
        // The contribution of a side along the gradient of its target.
        self.row_term.fill(0.0);
        for k in 0..program.sides.len() {
            let pull = self.centre[k] + self.dual[k] * self.side_residual[k];
            self.dual_move[k] = pull * self.slack_inverse[k];
        }
        let (rows, columns) = program.split_sides();
        for (side, pull) in rows.iter().zip(&self.dual_move) {
            self.row_term[side.of] -= side.sign * pull;
        }
        for (side, pull) in columns.iter().zip(&self.dual_move[rows.len()..]) {
            self.right[side.of] -= side.sign * pull;
        }
        program.add_transposed(&self.row_term, &mut self.right[..n]);
        self.cones.write_right(&mut self.right);
        self.target.clear();
        self.target.extend_from_slice(&self.right);
        kkt.solve(&mut self.right);
        program.activities(&self.right[..n], &mut self.row_move);
        for _ in 0..refinements {
            self.miss(program, kkt);
            let miss = largest_magnitude(&self.residual);
            if miss <= accurate || !miss.is_finite() {
                break;
            }
            kkt.solve(&mut self.residual);
            self.right.iter_mut().zip(&self.residual).for_each(|(v, r)| *v += r);
            program.activities(&self.right[..n], &mut self.row_move);
        }
        let (of_rows, of_columns) = self.slack_move.split_at_mut(rows.len());
        for (step, side) in of_rows.iter_mut().zip(rows) {
            *step = side.sign * self.row_move[side.of];
        }
        for (step, side) in of_columns.iter_mut().zip(columns) {
            *step = side.sign * self.right[side.of];
        }
        for k in 0..program.sides.len() {
            let step = self.slack_move[k] + self.side_residual[k];
            self.slack_move[k] = step;
            self.dual_move[k] = -(self.centre[k] + self.dual[k] * step) * self.slack_inverse[k];
        }
        let (step, others) = self.right.split_at(n);
        let along = &others[program.equalities.len() + kkt.long().len()..];
        self.cones.follow(&program.cones, step, along);
    }

    /// Writes the residual of `right` in the system with the right side `target` into `residual`.
    fn miss(&mut self, program: &ScaledProgram, kkt: &Kkt) {
        let (n, e) = (self.x.len(), program.equalities.len());
        self.residual.clear();
        self.residual.extend_from_slice(&self.target);
        let (columns, rest) = self.residual.split_at_mut(n);
        let (equalities, rest) = rest.split_at_mut(e);
        let (long, entries) = rest.split_at_mut(kkt.long().len());
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
        for (k, &i) in kkt.long().iter().enumerate() {
            long[k] -= self.row_move[i] - self.right[n + e + k] / self.row_weight[i];
            self.row_term[i] = -self.right[n + e + k];
        }
        program.add_transposed(&self.row_term, columns);
        let (step, others) = self.right.split_at(n);
        let along = &others[e + kkt.long().len()..];
        self.cones.subtract_product(&program.cones, (step, along), columns, entries);
    }

    /// Inverts slacks and duals, which a step divides by several times.
    pub(super) fn invert(&mut self) {
        for k in 0..self.slack.len() {
            self.slack_inverse[k] = 1.0 / self.slack[k];
            self.dual_inverse[k] = 1.0 / self.dual[k];
        }
    }

    /// The weights of columns and rows: the sums over their sides.
    pub(super) fn weigh(&mut self, program: &ScaledProgram) {
        self.column_weight.fill(0.0);
        self.row_weight.fill(0.0);
        let (rows, columns) = program.split_sides();
        for (k, side) in rows.iter().enumerate() {
            self.row_weight[side.of] += self.dual[k] * self.slack_inverse[k];
        }
        for (k, side) in columns.iter().enumerate() {
            let k = rows.len() + k;
            self.column_weight[side.of] += self.dual[k] * self.slack_inverse[k];
        }
    }

    /// The largest step, at most 1, that keeps slacks and duals positive, and inside their cones.
    fn longest(&self, program: &ScaledProgram) -> f64 {
        let fastest = |moves: &[f64], inverse: &[f64]| {
            let falls = moves.iter().zip(inverse).map(|(step, inverse)| -step * inverse);
            falls.fold(0.0_f64, |most, fall| if fall > most { fall } else { most })
        };
        let fastest = fastest(&self.slack_move, &self.slack_inverse)
            .max(fastest(&self.dual_move, &self.dual_inverse))
            .max(self.cones.fastest(&program.cones));
        1.0 / fastest.max(1.0)
    }
}
