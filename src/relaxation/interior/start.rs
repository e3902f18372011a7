//! Starting points of the interior-point method.

use super::iterate::{ACCURATE, Iterate, REFINEMENTS};
use super::kkt::Kkt;
use super::scaled::{Scaled, Side};
use crate::solver::StopToken;

/// Smallest initial slack of a row's side, in scaled units.
const FIRST_SLACK: f64 = 1.0;

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
        let (rows, columns) = program.split_sides();
        let mut slack = Vec::with_capacity(k);
        let room = |side: &Side, value: f64| side.sign * (value - side.limit);
        slack.extend(rows.iter().map(|side| room(side, activity[side.of]).max(FIRST_SLACK)));
        slack.extend(columns.iter().map(|side| room(side, x[side.of]).max(1e-10)));
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
            slack_inverse: vec![0.0; k],
            dual_inverse: vec![0.0; k],
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

    /// A better start: the least-squares violation of the sides, traded against the objective, with
    /// the violations as multipliers; both are moved inside.
    pub(super) fn improve_start(
        &mut self,
        program: &Scaled,
        kkt: &mut Kkt,
        token: &StopToken,
    ) -> bool {
        let n = self.x.len();
        self.x.fill(0.0);
        self.multipliers.fill(0.0);
        self.slack.fill(0.0);
        self.dual.fill(0.0);
        self.measure(program);
        // With unit slacks and zero duals, a side pulls with its residual.
        self.slack.fill(1.0);
        self.dual.fill(1.0);
        self.invert();
        self.weigh(program);
        if !kkt.factorise(&self.column_weight, &self.row_weight) || token.is_over() {
            return false;
        }
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
}
