//! Starting points of the interior-point method.

use super::iterate::Iterate;
use super::kkt::Kkt;
use super::parameters::{MAX_REFINEMENTS, MIN_INITIAL_SLACK, RESIDUAL_TOLERANCE};
use super::scaled::{OneSidedLimit, ScaledProgram};
use crate::presolve::refill;
use crate::solver::StopToken;

impl Iterate {
    /// Goes to a start inside the box of a program, in the memory that it has.
    pub(super) fn start(&mut self, program: &ScaledProgram) {
        let (n, m, k) = (program.column.len(), program.rows.len(), program.sides.len());
        let inside = |(&lower, &upper): (&f64, &f64)| {
            let room = (0.5 * (upper - lower)).min(1.0);
            0.0_f64.max(lower + room).min(upper - room)
        };
        self.x.clear();
        self.x.extend(program.lower.iter().zip(&program.upper).map(inside));
        for vector in [
            &mut self.activity,
            &mut self.multipliers,
            &mut self.row_weight,
            &mut self.row_term,
            &mut self.row_move,
        ] {
            refill(vector, m, 0.0);
        }
        program.activities(&self.x, &mut self.activity);
        let (rows, columns) = program.split_sides();
        let room = |side: &OneSidedLimit, value: f64| side.sign * (value - side.limit);
        let (x, activity) = (&self.x, &self.activity);
        self.slack.clear();
        self.slack
            .extend(rows.iter().map(|side| room(side, activity[side.of]).max(MIN_INITIAL_SLACK)));
        self.slack.extend(columns.iter().map(|side| room(side, x[side.of]).max(1e-10)));
        self.dual.clear();
        self.dual.extend(self.slack.iter().map(|s| 1.0 / s));
        for vector in [
            &mut self.curvature,
            &mut self.pressed,
            &mut self.dual_residual,
            &mut self.scratch,
            &mut self.column_weight,
        ] {
            refill(vector, n, 0.0);
        }
        for vector in [
            &mut self.side_residual,
            &mut self.slack_inverse,
            &mut self.dual_inverse,
            &mut self.slack_move,
            &mut self.dual_move,
            &mut self.centre,
        ] {
            refill(vector, k, 0.0);
        }
        self.cones.start(&program.cones, &self.x);
        refill(&mut self.equality_residual, program.equalities.len(), 0.0);
        self.barrier = 0.0;
    }

    /// A better start: the least-squares violation of the sides, traded against the objective, with
    /// the violations as multipliers; both are moved inside.
    pub(super) fn improve_start(
        &mut self,
        program: &ScaledProgram,
        kkt: &mut Kkt,
        token: &StopToken,
    ) -> bool {
        let n = self.x.len();
        self.x.fill(0.0);
        self.multipliers.fill(0.0);
        self.slack.fill(0.0);
        self.dual.fill(0.0);
        self.cones.centre(&program.cones, 0.0);
        self.measure(program);
        // With unit slacks and zero duals, the right-hand side of a side is its residual.
        self.slack.fill(1.0);
        self.dual.fill(1.0);
        self.cones.centre(&program.cones, 1.0);
        self.cones.aim_at_nothing();
        self.invert();
        self.weigh(program);
        let is_inside = self.cones.scale(&program.cones);
        let cones = (&program.cones, &self.cones);
        let done = is_inside && kkt.factorise(&self.column_weight, &self.row_weight, cones);
        if !done || token.is_over() {
            return false;
        }
        self.centre.fill(0.0);
        self.solve(program, kkt, (MAX_REFINEMENTS, RESIDUAL_TOLERANCE));
        self.x.copy_from_slice(&self.right[..n]);
        for (e, &(i, _)) in program.equalities.iter().enumerate() {
            self.multipliers[i] = self.right[n + e];
        }
        // The move of a slack is its value; the multiplier is its negative.
        let least = self.slack_move.iter().fold(f64::INFINITY, |m, s| m.min(*s));
        let most = self.slack_move.iter().fold(f64::NEG_INFINITY, |m, s| m.max(*s));
        let (of_cones_least, of_cones_most) = self.cones.eigenvalues(&program.cones);
        let (least, most) = (least.min(of_cones_least), most.max(of_cones_most));
        let shift = if least < 1e-3 { 1.0 - least } else { 0.0 };
        let lift = if most > -1e-3 { 1.0 + most } else { 0.0 };
        for k in 0..program.sides.len() {
            self.slack[k] = self.slack_move[k] + shift;
            self.dual[k] = lift - self.slack_move[k];
        }
        self.cones.start_from_moves(&program.cones, shift, lift);
        true
    }
}
