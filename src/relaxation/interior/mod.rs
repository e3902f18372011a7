//! A primal-dual interior-point method for the small sparse programs of a tree.
//!
//! Mehrotra's predictor and corrector from an infeasible start, on a system condensed onto columns
//! and equalities (`kkt`). A tree has thousands of such programs, and most need no accurate
//! optimum. After every iteration the method checks whether the multipliers already prove a bound
//! beyond the cutoff, or infeasibility, with the same formulas as [`Prover`](super::Prover) in plain
//! floats. The caller proves it again.
//!
//! The method gives up early, because the ladder asks another one for the rest.

mod condensed;
mod elimination_order;
mod iterate;
mod kkt;
mod scaled;
mod start;
mod warm_start;

use std::fmt;

use super::{Claim, Effort, Relaxation, RelaxationResult, WarmState};
use crate::presolve::Reduced;
use iterate::Iterate;
use kkt::Kkt;
use scaled::Scaled;
use warm_start::{Kept, ParentIterate, Resumed};

/// The crate's own interior-point method.
///
/// What it computes with is kept between solves, so that one takes memory only for its result, and for
/// a system that is unlike the last ones.
#[derive(Default)]
pub struct InteriorPoint {
    scaled: Scaled,
    kkt: Kkt,
    at: Iterate,
    kept: Kept,
    resumed: Resumed,
}

impl fmt::Debug for InteriorPoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("InteriorPoint").finish_non_exhaustive()
    }
}

impl InteriorPoint {
    /// A fresh instance.
    pub fn new() -> Self {
        Self::default()
    }
}

/// A start from the parent's iterate is given up if so many iterations leave more than this part of its
/// residuals. Then the child is far from its parent, and a start from nothing is better.
const WARM_ITERATIONS: u32 = 3;
const WARM_PART: f64 = 0.7;

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
        let InteriorPoint { scaled, kkt, at, kept, resumed } = self;
        scaled.load(program);
        let scaled = &*scaled;
        let run = Run { program, effort, scaled };
        if !kkt.load(program, scaled, effort.token) {
            return run.nothing(0);
        }
        at.start(scaled);
        let linear = run.is_linear();
        let mut spent = 0;
        let parent = effort.warm.filter(|_| !linear).and_then(WarmState::get::<ParentIterate>);
        if let Some(parent) = parent {
            at.resume(program, scaled, parent, resumed);
            let result = run.iterate(at, kkt, kept, true);
            if result.claim != Claim::Unknown || effort.token.is_over() {
                return result;
            }
            spent = result.iterations;
            at.start(scaled);
        }
        // Without curvature a start in the middle of the box wastes iterations; with it, it is better.
        if linear && !at.improve_start(scaled, kkt, effort.token) {
            return run.nothing(0);
        }
        let result = run.iterate(at, kkt, kept, false);
        RelaxationResult { iterations: spent + result.iterations, ..result }
    }
}

/// One solve.
struct Run<'a> {
    program: &'a Reduced,
    effort: &'a Effort<'a>,
    scaled: &'a Scaled,
}

impl Run<'_> {
    fn is_linear(&self) -> bool {
        self.scaled.quadratic.index.is_empty()
    }

    fn nothing(&self, iterations: u32) -> RelaxationResult {
        RelaxationResult {
            claim: Claim::Unknown,
            x: vec![f64::NAN; self.program.columns.len()],
            y: vec![0.0; self.program.rows.len()],
            iterations: u64::from(iterations),
            warm: None,
        }
    }

    /// An iterate as an answer.
    fn answer(&self, claim: Claim, at: &Iterate, iterations: u32) -> RelaxationResult {
        let scaled = self.scaled;
        let x: Vec<f64> = at.x.iter().zip(&scaled.column).map(|(x, d)| x * d).collect();
        let unit = |(y, e): (&f64, &f64)| y * e / scaled.objective;
        let y = at.multipliers.iter().zip(&scaled.row).map(unit).collect();
        RelaxationResult { claim, x, y, iterations: u64::from(iterations), warm: None }
    }

    /// Iterates from a start, one from the parent's iterate if `is_warm`, to a claim.
    fn iterate(
        &self,
        at: &mut Iterate,
        kkt: &mut Kkt,
        kept: &mut Kept,
        is_warm: bool,
    ) -> RelaxationResult {
        let (scaled, effort) = (self.scaled, self.effort);
        let (mut stuck, mut iterations) = (0, 0);
        // A step removes its length's part of the residuals.
        let mut left = 1.0;
        let mut solved = None;
        kept.clear();
        while iterations < effort.iterations {
            at.measure(scaled);
            if !at.is_finite() {
                return self.nothing(iterations);
            }
            if !self.is_linear() {
                kept.update(at);
            }
            match self.judge(at, iterations) {
                Some((Claim::Solved, exactly)) => {
                    solved = Some(self.answer(Claim::Solved, at, iterations));
                    if exactly {
                        break;
                    }
                }
                Some((claim, _)) => return self.answer(claim, at, iterations),
                None => {}
            }
            // Centred, but the dual residual grows: the dual set has no interior.
            if at.diverges() || effort.token.is_over() {
                break;
            }
            let Some(step) = at.advance(scaled, kkt, effort.token) else { break };
            iterations += 1;
            stuck = if step < SHORT_STEP { stuck + 1 } else { 0 };
            left *= 1.0 - step;
            let is_slow = is_warm && iterations == WARM_ITERATIONS && left > WARM_PART;
            if stuck >= STUCK || is_slow {
                break;
            }
        }
        let Some(mut solved) = solved else {
            return self.answer(Claim::Unknown, at, iterations);
        };
        if self.program.is_feasibility_problem() {
            solved.y.fill(0.0);
        }
        if !self.is_linear() {
            solved.warm = Some(WarmState::new(kept.state(self.program, scaled)));
        }
        solved
    }

    /// What a measured iterate shows, and whether that is all that was asked for.
    fn judge(&self, at: &Iterate, iterations: u32) -> Option<(Claim, bool)> {
        let (scaled, effort) = (self.scaled, self.effort);
        let objective = |value: f64| value / scaled.objective + self.program.offset;
        let violation = at.violation(scaled);
        let feasible = violation <= effort.tolerance;
        let feasibility_problem = self.program.is_feasibility_problem();
        if feasibility_problem && feasible {
            return Some((Claim::Solved, true));
        }
        if iterations == 0 {
            return None;
        }
        let bound = objective(at.dual_value(scaled));
        let enough = effort.cutoff + PROMISE * effort.cutoff.abs().max(1.0);
        if !feasibility_problem && bound > enough {
            return Some((Claim::Beyond, true));
        }
        let value = objective(at.value(scaled));
        let gap = 10.0 * effort.tolerance * value.abs().max(1.0);
        // Columns without bounds leave the bound infinite until their gradient is exactly zero.
        let distance = if bound > f64::NEG_INFINITY {
            value - bound
        } else {
            at.estimated_gap() / scaled.objective
        };
        if feasible && distance <= gap {
            return Some((Claim::Solved, true));
        }
        if at.refutes(scaled) {
            return Some((Claim::Infeasible, true));
        }
        let rough = effort.tolerance.max(ROUGH);
        let nearly = violation <= rough && distance <= 10.0 * rough * value.abs().max(1.0);
        nearly.then_some((Claim::Solved, false))
    }
}
