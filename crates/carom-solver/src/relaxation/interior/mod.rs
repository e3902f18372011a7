//! A primal-dual interior-point method for the small sparse programs of a tree.
//!
//! Mehrotra's predictor and corrector from an infeasible start, on a system condensed onto columns
//! and equalities (`kkt`). A tree has thousands of such programs, and most need no accurate
//! optimum. After every iteration the method checks whether the multipliers already prove a bound
//! beyond the cutoff, or infeasibility, with the same formulas as [`Prover`](super::Prover) in
//! plain floats. The caller proves it again.
//!
//! The method gives up early, because the cascade has another one for the rest.

mod condensed;
mod cone_iterate;
mod elimination_order;
mod iterate;
mod kkt;
mod parameters;
mod results;
mod scaled;
mod scaled_cones;
mod start;
mod warm_start;

use parameters::{
    COARSE_TOLERANCE, EARLY_ITERATIONS, FREE_MARGIN, MAX_CONE_ENTRIES, MAX_SHORT_STEPS,
    MAX_WARM_RESIDUAL, SHORT_STEP, WARM_ITERATIONS,
};
use std::fmt;

use super::conic_form::{ConeRows, ConicForm};
use super::{Effort, Relaxation, RelaxationClaim, RelaxationResult, WarmState};
use crate::presolve::{Reduced, ReducedCone};
use crate::program::ConeRole;
use iterate::Iterate;
use kkt::Kkt;
use results::ResultMemory;
use scaled::ScaledProgram;
use warm_start::{KeptIterate, ParentIterate, Resumed};

/// The crate's own interior-point method.
///
/// Its working memory is kept between solves. A solve takes new memory only for a system unlike the
/// last ones, and for its result if none was given back.
#[derive(Default)]
pub struct InteriorPoint {
    scaled: ScaledProgram,
    kkt: Kkt,
    at: Iterate,
    kept: KeptIterate,
    resumed: Resumed,
    results: ResultMemory,
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

impl Relaxation for InteriorPoint {
    fn solve(&mut self, program: &Reduced, effort: &Effort<'_>) -> RelaxationResult {
        self.solve_with(program, effort, &ConeRows::default())
    }

    fn reuse(&mut self, result: RelaxationResult) {
        self.results.take_back(result);
    }
}

impl InteriorPoint {
    /// Whether a program with cones is one for this method: their blocks are dense.
    pub fn suits_cones(program: &Reduced) -> bool {
        let is_short = |cone: &ReducedCone| {
            cone.role == ConeRole::Part || cone.entries.len() <= MAX_CONE_ENTRIES
        };
        program.cones.iter().all(is_short)
    }

    /// Solves a program with its cones. Also returns the multipliers of the rows of the cones.
    pub(super) fn solve_cones(
        &mut self,
        form: &ConicForm<'_>,
        effort: &Effort<'_>,
    ) -> (RelaxationResult, Vec<f64>) {
        self.results.cone_dual.clear();
        let result = self.solve_with(&form.program, effort, &form.cones);
        let (scaled, dual) = (&self.scaled, &mut self.results.cone_dual);
        dual.resize(scaled.cones.entry_count(), 0.0);
        (result, scaled.cones.multipliers(dual, scaled.objective))
    }

    fn solve_with(
        &mut self,
        program: &Reduced,
        effort: &Effort<'_>,
        cones: &ConeRows,
    ) -> RelaxationResult {
        let InteriorPoint { scaled, kkt, at, kept, resumed, results } = self;
        scaled.load(program, cones);
        let scaled = &*scaled;
        let run = InteriorRun { program, effort, scaled };
        if !kkt.load(program, scaled, effort.token) {
            return RelaxationResult::nothing(program);
        }
        at.start(scaled);
        let keeps_state = run.keeps_state();
        let mut spent = 0;
        let parent = effort.warm.filter(|_| keeps_state).and_then(WarmState::get::<ParentIterate>);
        if let Some(parent) = parent {
            at.resume(program, scaled, parent, resumed);
            let result = run.iterate(at, kkt, (kept, results), true);
            if result.claim != RelaxationClaim::Unknown || effort.token.is_over() {
                return result;
            }
            spent = result.iterations;
            results.take_back(result);
            at.start(scaled);
        }
        // Without curvature a start in the middle of the box wastes iterations; with it, it is
        // better, unless it is so far out that the first steps are negligible.
        if !keeps_state && !at.improve_start(scaled, kkt, effort.token) {
            return RelaxationResult::nothing(program);
        }
        let mut result = run.iterate(at, kkt, (kept, results), false);
        let lost =
            result.claim == RelaxationClaim::Unknown && result.iterations <= EARLY_ITERATIONS;
        if lost && keeps_state && !effort.token.is_over() {
            at.start(scaled);
            if at.improve_start(scaled, kkt, effort.token) {
                spent += result.iterations;
                results.take_back(result);
                result = run.iterate(at, kkt, (kept, results), false);
            }
        }
        RelaxationResult { iterations: spent + result.iterations, ..result }
    }
}

/// One solve.
struct InteriorRun<'a> {
    program: &'a Reduced,
    effort: &'a Effort<'a>,
    scaled: &'a ScaledProgram,
}

impl InteriorRun<'_> {
    /// Whether the children begin with an iterate: the program has curvature, and no cones.
    fn keeps_state(&self) -> bool {
        !self.scaled.quadratic.index.is_empty() && self.scaled.cones.len() == 0
    }

    /// An iterate as an answer.
    fn answer(
        &self,
        claim: RelaxationClaim,
        at: &Iterate,
        iterations: u32,
        results: &mut ResultMemory,
    ) -> RelaxationResult {
        let scaled = self.scaled;
        let x = results.vector(at.x.iter().zip(&scaled.column).map(|(x, d)| x * d));
        let unit = |(y, e): (&f64, &f64)| y * e / scaled.objective;
        let y = results.vector(at.multipliers.iter().zip(&scaled.row).map(unit));
        results.cone_dual.clone_from(&at.cones.dual);
        RelaxationResult { claim, x, y, iterations: u64::from(iterations), warm: None }
    }

    /// Iterates from a start, one from the parent's iterate if `is_warm`, to a claim.
    fn iterate(
        &self,
        at: &mut Iterate,
        kkt: &mut Kkt,
        (kept, results): (&mut KeptIterate, &mut ResultMemory),
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
                let iterations = u64::from(iterations);
                return RelaxationResult { iterations, ..RelaxationResult::nothing(self.program) };
            }
            if self.keeps_state() {
                kept.update(at);
            }
            match self.judge(at, iterations) {
                Some((RelaxationClaim::Solved, exactly)) => {
                    solved.take().into_iter().for_each(|before| results.take_back(before));
                    solved = Some(self.answer(RelaxationClaim::Solved, at, iterations, results));
                    if exactly {
                        break;
                    }
                }
                Some((claim, _)) => return self.answer(claim, at, iterations, results),
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
            let is_slow = is_warm && iterations == WARM_ITERATIONS && left > MAX_WARM_RESIDUAL;
            if stuck >= MAX_SHORT_STEPS || is_slow {
                break;
            }
        }
        let Some(mut solved) = solved else {
            return self.answer(RelaxationClaim::Unknown, at, iterations, results);
        };
        if self.program.is_feasibility_problem() {
            solved.y.fill(0.0);
        }
        if self.keeps_state() {
            let write = |state: &mut ParentIterate| kept.write(self.program, scaled, state);
            solved.warm = Some(results.state(write));
        }
        solved
    }

    /// The claim that a measured iterate supports, and whether it meets the requested tolerance;
    /// `None` if it supports none.
    fn judge(&self, at: &Iterate, iterations: u32) -> Option<(RelaxationClaim, bool)> {
        let (scaled, effort) = (self.scaled, self.effort);
        let objective = |value: f64| value / scaled.objective + self.program.offset;
        let violation = at.violation(scaled);
        let feasible = violation <= effort.tolerance;
        let feasibility_problem = self.program.is_feasibility_problem();
        if feasibility_problem && feasible {
            return Some((RelaxationClaim::Solved, true));
        }
        if iterations == 0 {
            return None;
        }
        let bound = objective(at.dual_value(scaled));
        let enough = effort.sufficient_bound();
        if !feasibility_problem && bound > enough {
            return Some((RelaxationClaim::Beyond, true));
        }
        if bound == f64::NEG_INFINITY && self.scaled.cones.len() > 0 {
            // The proof takes the gradients of free columns away.
            let (promised, slope) = at.promised_value(scaled);
            let margin = FREE_MARGIN * effort.cutoff.abs().max(1.0);
            if slope < FREE_MARGIN && objective(promised) > effort.cutoff + margin {
                return Some((RelaxationClaim::Beyond, true));
            }
        }
        let value = objective(at.value(scaled));
        let gap = 10.0 * effort.tolerance * value.abs().max(1.0);
        // Columns without bounds leave the bound infinite until their gradient is exactly zero.
        let estimated = || at.estimated_gap() / scaled.objective;
        let distance = match scaled.cones.len() {
            0 if bound > f64::NEG_INFINITY => value - bound,
            0 => estimated(),
            _ => estimated().min((value - bound).abs()),
        };
        if feasible && distance <= gap {
            return Some((RelaxationClaim::Solved, true));
        }
        if at.refutes(scaled) {
            return Some((RelaxationClaim::Infeasible, true));
        }
        let rough = effort.tolerance.max(COARSE_TOLERANCE);
        let nearly = violation <= rough && distance <= 10.0 * rough * value.abs().max(1.0);
        nearly.then_some((RelaxationClaim::Solved, false))
    }
}
