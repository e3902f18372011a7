//! A primal-dual interior-point method for the small sparse programs of a tree.
//!
//! Mehrotra's predictor and corrector from an infeasible start, on a system condensed onto columns
//! and equalities (`kkt`). A tree has thousands of such programs, and most need no accurate
//! optimum. After every iteration the method checks whether the multipliers already prove a bound
//! beyond the cutoff, or infeasibility, with the same formulas as
//! [`lower_bound`](super::lower_bound) and [`proves_infeasible`](super::proves_infeasible) in plain
//! floats. The caller proves it again with twice the digits.
//!
//! The method gives up early, because the ladder asks another one for the rest.

mod condensed;
mod iterate;
mod kkt;
mod scaled;
mod start;

use super::{Claim, Effort, Relaxation, RelaxationResult};
use crate::presolve::Reduced;
use iterate::Iterate;
use kkt::Kkt;
use scaled::Scaled;

/// The crate's own interior-point method.
#[derive(Debug, Clone, Default)]
pub struct InteriorPoint {}

impl InteriorPoint {
    /// A fresh instance.
    pub fn new() -> Self {
        Self::default()
    }
}

/// Number of consecutive iterations with negligible steps after which the method gives up.
const STUCK: u32 = 3;

/// Steps below this length are negligible (no unit).
const SHORT_STEP: f64 = 1e-3;

/// The tolerance at which a program counts as solved if the method cannot improve it.
const ROUGH: f64 = 1e-8;

/// The relative margin by which a bound must exceed the cutoff before the method stops.
const PROMISE: f64 = 1e-7;

impl Relaxation for InteriorPoint {
    fn solve(&mut self, program: &Reduced, effort: &Effort<'_>) -> RelaxationResult {
        let scaled = Scaled::of(program);
        let (n, m) = (program.columns.len(), program.rows.len());
        let nothing = |iterations| RelaxationResult {
            claim: Claim::Unknown,
            x: vec![f64::NAN; n],
            y: vec![0.0; m],
            iterations,
            warm: None,
        };
        let Some(mut kkt) = Kkt::new(&scaled, effort.token) else { return nothing(0) };
        let mut at = Iterate::start(&scaled);
        // Without curvature a start in the middle of the box wastes iterations; with it, it is better.
        let linear = scaled.quadratic.index.is_empty();
        if linear && !at.improve_start(&scaled, &mut kkt, effort.token) {
            return nothing(0);
        }
        let feasibility_problem = program.is_feasibility_problem();
        let objective = |value: f64| value / scaled.objective + program.offset;
        let answer = |claim, at: &Iterate, iterations| {
            let x: Vec<f64> = at.x.iter().zip(&scaled.column).map(|(x, d)| x * d).collect();
            let unit = |(y, e): (&f64, &f64)| y * e / scaled.objective;
            let y = at.multipliers.iter().zip(&scaled.row).map(unit).collect();
            RelaxationResult { claim, x, y, iterations, warm: None }
        };
        let (mut stuck, mut iterations) = (0, 0);
        let mut nearly = None;
        while iterations < effort.iterations {
            at.measure(&scaled);
            if !at.is_finite() {
                return nothing(u64::from(iterations));
            }
            let done = |claim| answer(claim, &at, u64::from(iterations));
            let violation = at.violation(&scaled);
            let feasible = violation <= effort.tolerance;
            if feasibility_problem && feasible {
                return RelaxationResult { y: vec![0.0; m], ..done(Claim::Solved) };
            }
            if iterations > 0 {
                let bound = objective(at.dual_value(&scaled));
                let enough = effort.cutoff + PROMISE * effort.cutoff.abs().max(1.0);
                if !feasibility_problem && bound > enough {
                    return done(Claim::Beyond);
                }
                let value = objective(at.value(&scaled));
                let gap = 10.0 * effort.tolerance * value.abs().max(1.0);
                // Columns without bounds leave the bound infinite until their gradient is exactly zero.
                let distance = if bound > f64::NEG_INFINITY {
                    value - bound
                } else {
                    at.estimated_gap() / scaled.objective
                };
                if feasible && distance <= gap {
                    return done(Claim::Solved);
                }
                let rough = effort.tolerance.max(ROUGH);
                if violation <= rough && distance <= 10.0 * rough * value.abs().max(1.0) {
                    nearly = Some(done(Claim::Solved));
                }
                if at.refutes(&scaled) {
                    return done(Claim::Infeasible);
                }
            }
            // Centred, but the dual residual grows: the dual set has no interior.
            if at.diverges() {
                break;
            }
            if effort.token.is_over() {
                break;
            }
            let Some(step) = at.advance(&scaled, &mut kkt, effort.token) else { break };
            iterations += 1;
            stuck = if step < SHORT_STEP { stuck + 1 } else { 0 };
            if stuck >= STUCK {
                break;
            }
        }
        nearly.unwrap_or_else(|| answer(Claim::Unknown, &at, u64::from(iterations)))
    }
}
