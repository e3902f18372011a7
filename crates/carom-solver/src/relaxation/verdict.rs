//! The verdict on a node from a verified relaxation.

use super::Prover;
use super::attempts::Purpose;
use super::borderline::{Doubt, is_rough};
use super::recession::is_descent_ray;
use super::{RelaxationClaim, RelaxationResult, WarmState};
use crate::presolve::Reduced;
use crate::solver::{Options, StopToken};
use crate::tolerance::{self, largest_magnitude};

/// A question about a node.
#[derive(Debug, Clone, Copy)]
pub struct RelaxationQuestion<'a> {
    /// One of the first four.
    pub purpose: Purpose,
    /// A proved bound of at least this settles the question; infinite if none does.
    pub cutoff: f64,
    /// The gaps that a leaf has to meet.
    pub options: &'a Options,
    /// The constant of the objective, which gaps leave out.
    pub constant: f64,
    /// Whether to look for a direction in which the objective falls without limit.
    pub look_for_descent: bool,
    /// Ends the attempts when it is over.
    pub token: &'a StopToken,
    /// The state that the parent's relaxation left.
    pub warm: Option<&'a WarmState>,
}

/// The verdict on a node from a verified relaxation.
#[derive(Debug)]
pub enum RelaxationVerdict {
    /// No feasible point: proved by multipliers, one a row.
    Refuted(Vec<f64>),
    /// A limit or an interrupt came first.
    Stopped,
    /// The objective falls without limit along a verified direction.
    Descent,
    /// A proved bound and a point, not necessarily optimal.
    Relaxed {
        bound: f64,
        /// The point, one entry a reduced column.
        x: Vec<f64>,
        /// The multipliers behind the bound; empty if there are none.
        y: Vec<f64>,
        /// Whether bound and point are close together.
        converged: bool,
        /// The state that the children's relaxations may start from; `None` if there is none.
        warm: Option<WarmState>,
    },
}

/// The findings of the attempts at a node so far.
pub(super) struct Findings<'a> {
    program: &'a Reduced,
    question: &'a RelaxationQuestion<'a>,
    /// The cutoff for the next attempt.
    pub(super) cutoff: f64,
    /// The best proved bound, and the multipliers behind it.
    pub(super) bound: f64,
    pub(super) y: Vec<f64>,
    pub(super) doubt: Doubt,
    /// The point nearest to the bound, and its distance.
    pub(super) x: Vec<f64>,
    nearest: f64,
    pub(super) converged: bool,
    pub(super) warm: Option<WarmState>,
}

/// The consequence of an attempt.
pub(super) enum AttemptOutcome {
    /// The verdict is final.
    Decided(RelaxationVerdict),
    /// Bound and point are close enough.
    Sufficient,
    /// The same attempt is repeated without a cutoff.
    Repeat,
    /// The next attempt follows.
    TryHarder,
}

impl<'a> Findings<'a> {
    pub(super) fn new(program: &'a Reduced, question: &'a RelaxationQuestion<'a>) -> Self {
        Findings {
            program,
            question,
            cutoff: question.cutoff,
            bound: f64::NEG_INFINITY,
            y: Vec::new(),
            doubt: Doubt::default(),
            x: Vec::new(),
            nearest: f64::INFINITY,
            converged: false,
            warm: None,
        }
    }

    /// Verifies the claim of an attempt.
    pub(super) fn verify(
        &mut self,
        result: RelaxationResult,
        prover: &mut Prover,
    ) -> AttemptOutcome {
        let RelaxationResult { claim, x, y, warm, .. } = result;
        self.warm = warm.or(self.warm.take());
        let may_be_empty = matches!(
            claim,
            RelaxationClaim::Infeasible | RelaxationClaim::Beyond | RelaxationClaim::Unknown
        );
        let has_point = matches!(
            claim,
            RelaxationClaim::Solved | RelaxationClaim::Beyond | RelaxationClaim::Unknown
        );
        if may_be_empty && prover.proves_infeasible(self.program, &y) {
            return AttemptOutcome::Decided(RelaxationVerdict::Refuted(y));
        }
        let falls = claim == RelaxationClaim::Unbounded && self.question.look_for_descent;
        if falls && is_descent_ray(self.program, &x) {
            return AttemptOutcome::Decided(RelaxationVerdict::Descent);
        }
        if has_point && x.iter().all(|v| v.is_finite()) {
            return self.verify_point(claim, x, y, prover);
        }
        AttemptOutcome::TryHarder
    }

    /// Proves the bound of an attempt's multipliers, and compares it with the point.
    fn verify_point(
        &mut self,
        claim: RelaxationClaim,
        x: Vec<f64>,
        y: Vec<f64>,
        prover: &mut Prover,
    ) -> AttemptOutcome {
        let program = self.program;
        let bound = match program.is_feasibility_problem() {
            true => program.offset,
            false => prover.lower_bound(program, &x, &y),
        };
        let value = program.objective(&x);
        if bound >= self.bound {
            (self.bound, self.y) = (bound, y);
            self.doubt.blurred = !program.is_feasibility_problem() && prover.is_blurred();
            self.doubt.rough =
                self.question.purpose == Purpose::Leaf && is_rough(program, &x, &self.y, value);
        }
        if bound >= self.cutoff {
            return AttemptOutcome::Decided(self.relaxed(bound, x, false));
        }
        if claim == RelaxationClaim::Beyond && self.cutoff.is_finite() {
            // The multipliers do not prove what the method claims, so it solves to the end.
            self.cutoff = f64::INFINITY;
            return AttemptOutcome::Repeat;
        }
        // A later attempt wins a tie.
        let distance = (value - self.bound).abs();
        if distance <= self.nearest {
            let size = largest_magnitude(&x);
            // Points of trials and of separation may be coarse.
            let coarse = matches!(self.question.purpose, Purpose::Trial | Purpose::Separation);
            let slack = if coarse { 1e-3 } else { 1e-6 };
            let near = size <= tolerance::FREE_RADIUS;
            self.converged = near && value - self.bound <= slack * value.abs().max(1.0);
            (self.nearest, self.x) = (distance, x);
        }
        if claim == RelaxationClaim::Solved && value - bound <= self.allowed_distance(value) {
            return AttemptOutcome::Sufficient;
        }
        AttemptOutcome::TryHarder
    }

    /// The verdict on a method that a limit has stopped: at a root with an objective, what its
    /// multipliers prove already.
    pub(super) fn stopped(
        &mut self,
        result: RelaxationResult,
        prover: &mut Prover,
    ) -> RelaxationVerdict {
        let is_root = matches!(self.question.purpose, Purpose::Root | Purpose::Separation);
        if !is_root || self.program.is_feasibility_problem() {
            return RelaxationVerdict::Stopped;
        }
        if let AttemptOutcome::Decided(verdict) = self.verify(result, prover) {
            return verdict;
        }
        if self.bound == f64::NEG_INFINITY {
            return RelaxationVerdict::Stopped;
        }
        let (bound, mut x) = (self.bound, std::mem::take(&mut self.x));
        x.resize(self.program.columns.len(), 0.0);
        self.relaxed(bound, x, false)
    }

    /// The distance that a point of this value may have from its bound. Methods take the gap
    /// relative to an objective without the constant, which may be large. A leaf also meets the
    /// requested gap.
    fn allowed_distance(&self, value: f64) -> f64 {
        let RelaxationQuestion { options, constant, .. } = *self.question;
        let wanted = 0.1 * options.allowed_gap(value, constant);
        let enough = 1e-6 * tolerance::gap_scale(value, constant).max(1.0);
        if self.question.purpose == Purpose::Leaf { enough.min(wanted) } else { enough }
    }

    pub(super) fn relaxed(
        &mut self,
        bound: f64,
        x: Vec<f64>,
        converged: bool,
    ) -> RelaxationVerdict {
        let (y, warm) = (std::mem::take(&mut self.y), self.warm.take());
        RelaxationVerdict::Relaxed { bound, x, y, converged, warm }
    }
}
