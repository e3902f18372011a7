//! The cascade of attempts: which method solves a program, how accurately, and which one follows if
//! the result is not good enough.
//!
//! `attempts.rs` lists the attempts of each [`Purpose`], and [`CascadeMethod::of`] the methods. No
//! other part of the crate names a method.

use web_time::{Duration, Instant};

use super::Prover;
use super::active_set::ActiveSet;
use super::attempts::{MethodAttempt, Purpose, Stage, VERTEX, attempts};
use super::borderline::{Doubt, WIDENINGS, is_torn, widened};
use super::clarabel::ClarabelRelaxation;
use super::cone_cut::ConeCut;
use super::conic::ConicMethod;
use super::interior::InteriorPoint;
use super::record::Record;
use super::simplex::DualSimplex;
use super::spent::Spent;
use super::verdict::{AttemptOutcome, Findings, RelaxationQuestion, RelaxationVerdict};
use super::{Effort, Relaxation, RelaxationClaim, RelaxationResult, WarmState};
use crate::presolve::{Domain, Reduced, Reducer};
use crate::program::Program;
use crate::solution::RelaxationCounts;
use crate::solver::{RelaxationMethod, StopToken};

/// The methods that start from a state: for dense programs with curvature, and for linear ones.
#[derive(Debug, Clone, Copy)]
pub(super) enum WarmMethod {
    ActiveSet,
    Simplex,
}

/// The records of the cold method, and of the same for programs with cones, behind the warm ones'.
const COLD_RECORD: usize = 2;
pub(super) const CONIC_RECORD: usize = 3;
pub(super) const QUADRATICS_RECORD: usize = 4;

/// The part of a solve that is the same for all attempts.
pub(super) struct Request<'a> {
    purpose: Purpose,
    /// The method for attempts of the warm stage.
    pub(super) warm_method: Option<WarmMethod>,
    /// The state that the parent's relaxation left.
    pub(super) warm: Option<&'a WarmState>,
    /// A proved bound of at least this ends the solve; infinite for a complete solve.
    cutoff: f64,
    token: &'a StopToken,
}

impl<'a> Request<'a> {
    /// A complete solve that starts from nothing.
    pub(super) fn complete(purpose: Purpose, token: &'a StopToken) -> Self {
        Request { purpose, warm_method: None, warm: None, cutoff: f64::INFINITY, token }
    }
}

/// A method, its counter, and the purposes for which it gets the parent's state.
struct CascadeMethod {
    method: Box<dyn Relaxation>,
    starts_warm: fn(Purpose) -> bool,
    count: fn(&mut RelaxationCounts) -> &mut u64,
}

impl CascadeMethod {
    fn of(method: RelaxationMethod) -> Self {
        match method {
            RelaxationMethod::Automatic | RelaxationMethod::InteriorPoint => CascadeMethod {
                method: Box::new(InteriorPoint::new()),
                // Without a start it ends deeper inside the face of optima, which is better if the
                // search continues from that point.
                starts_warm: |purpose| matches!(purpose, Purpose::Trial | Purpose::Separation),
                count: |counts| &mut counts.interior_point,
            },
            RelaxationMethod::Clarabel => CascadeMethod {
                method: Box::new(ClarabelRelaxation::new()),
                starts_warm: |_| true,
                count: |counts| &mut counts.clarabel,
            },
        }
    }
}

/// The methods of a search, the memory that they work in, and what they have taken.
pub struct MethodCascade {
    /// By [`WarmMethod`]; `None` if no method starts from a state.
    warm: Option<[CascadeMethod; 2]>,
    cold: CascadeMethod,
    /// `None` if the cold method is alone.
    fallback: Option<CascadeMethod>,
    /// The records of the warm methods, of the cold one, and of that for cones.
    pub(super) records: [Record; 5],
    spent: Spent,
    pub(super) prover: Prover,
    reducer: Reducer,
    /// Solve programs with cones.
    pub(super) conic: ClarabelRelaxation,
    pub(super) conic_interior: InteriorPoint,
    /// The state that the last sequence of quadratic programs left.
    pub(super) last_quadratics: Option<WarmState>,
    /// The cuts that the multipliers of the last program with cones are, with their multipliers.
    pub(super) cone_cuts: Vec<(ConeCut, f64)>,
}

impl MethodCascade {
    /// The cascade of a choice.
    pub fn new(choice: RelaxationMethod) -> Self {
        let fallback = RelaxationMethod::Clarabel;
        let fallback = (choice != fallback).then(|| CascadeMethod::of(fallback));
        let warm = (choice == RelaxationMethod::Automatic).then(|| {
            [
                CascadeMethod {
                    method: Box::new(ActiveSet::new()),
                    starts_warm: |_| true,
                    count: |counts| &mut counts.active_set,
                },
                CascadeMethod {
                    method: Box::new(DualSimplex::new()),
                    starts_warm: |_| true,
                    count: |counts| &mut counts.dual_simplex,
                },
            ]
        });
        MethodCascade::of(warm, CascadeMethod::of(choice), fallback)
    }

    /// A cascade with a method of one's own, alone.
    pub fn with_method(method: Box<dyn Relaxation>) -> Self {
        let count: fn(&mut RelaxationCounts) -> &mut u64 = |counts| &mut counts.interior_point;
        MethodCascade::of(None, CascadeMethod { method, starts_warm: |_| true, count }, None)
    }

    fn of(
        warm: Option<[CascadeMethod; 2]>,
        cold: CascadeMethod,
        fallback: Option<CascadeMethod>,
    ) -> Self {
        let (records, spent, prover, reducer) = Default::default();
        let (conic, conic_interior, cone_cuts) = Default::default();
        MethodCascade {
            warm,
            cold,
            fallback,
            records,
            spent,
            prover,
            reducer,
            conic,
            conic_interior,
            last_quadratics: None,
            cone_cuts,
        }
    }

    /// Proves bounds, in the memory that the cascade has for that.
    pub fn prover(&mut self) -> &mut Prover {
        &mut self.prover
    }

    /// Reduces programs, in the memory that the cascade has for that.
    pub(crate) fn reducer(&mut self) -> &mut Reducer {
        &mut self.reducer
    }

    /// Reduces the program of a leaf, whose point may become the answer. Where the dual simplex
    /// method suits, only rounding is dropped, because other rows may multiply the freedom that a
    /// dropped row leaves. A vertex needs no interior.
    pub(crate) fn reduce_leaf(&mut self, program: &Program, domain: &Domain) -> Option<Reduced> {
        let is_linear = program.quadratic.compute_nnz() == 0;
        let has_vertex = self.warm.is_some() && DualSimplex::suits_costs(&program.linear);
        match is_linear && has_vertex {
            true => self.reducer.reduce_strictly(program, domain),
            false => self.reducer.reduce(program, domain),
        }
    }

    /// Iterations since what was taken was last asked for.
    pub(crate) fn iterations(&self) -> u64 {
        self.spent.iterations
    }

    /// The attempts, iterations and time taken since this was last called.
    pub fn take_spent(&mut self) -> Spent {
        std::mem::take(&mut self.spent)
    }

    /// Takes the cuts that the multipliers of the last program with cones are.
    pub(crate) fn take_cone_cuts(&mut self) -> Vec<ConeCut> {
        self.cone_cuts.drain(..).map(|(cut, _)| cut).collect()
    }

    /// Whether there are methods that start from a state.
    #[cfg(feature = "nonlinear")]
    pub(super) fn has_warm_methods(&self) -> bool {
        self.warm.is_some()
    }

    /// Whether other methods take over where one gives up.
    pub(super) fn mixes_methods(&self) -> bool {
        self.fallback.is_some()
    }

    pub(super) fn note_conic(&mut self, method: ConicMethod, iterations: u64, time: Duration) {
        self.spent.time += time;
        match method {
            ConicMethod::Clarabel => self.spent.counts.clarabel += 1,
            ConicMethod::InteriorPoint => self.spent.counts.interior_point += 1,
            ConicMethod::SequentialQuadratic => self.spent.counts.active_set += 1,
        }
        self.spent.iterations += iterations;
    }

    /// The attempts of a purpose at a program. A method that is alone makes the more thorough
    /// attempts only.
    fn attempts(&self, purpose: Purpose, warm: Option<WarmMethod>) -> &'static [MethodAttempt] {
        let all = attempts(purpose);
        let others = match all {
            [MethodAttempt { stage: Stage::Warm, .. }, ..] if warm.is_some() => return all,
            [MethodAttempt { stage: Stage::Warm, .. }, others @ ..] => others,
            all => all,
        };
        match others {
            [_, rest @ ..] if self.fallback.is_none() && !rest.is_empty() => rest,
            all => all,
        }
    }

    /// The method that starts from a state and suits a program. Without a state the dual simplex
    /// method solves roots, and leaves, which are reduced for it.
    fn warm_method(&self, program: &Reduced, asked: &RelaxationQuestion<'_>) -> Option<WarmMethod> {
        self.warm.as_ref()?;
        let starts = match asked.purpose {
            Purpose::Separation if !self.separates_by_state(program) => return None,
            Purpose::Root | Purpose::Round | Purpose::Leaf | Purpose::Separation => true,
            // An interior-point method is many times slower in large programs.
            _ => asked.warm.is_some() || DualSimplex::suits_separation(program),
        };
        if ActiveSet::suits(program) {
            return Some(WarmMethod::ActiveSet);
        }
        (starts && DualSimplex::suits(program)).then_some(WarmMethod::Simplex)
    }

    /// Whether a method for a program starts from its parent's state.
    pub fn starts_warm(&self, program: &Reduced) -> bool {
        self.warm.is_some() && (ActiveSet::suits(program) || DualSimplex::suits(program))
    }

    /// Whether the point to cut off is a vertex, with the state of the simplex method.
    pub fn separates_vertex(&self, program: &Reduced) -> bool {
        self.warm.is_some() && DualSimplex::suits_separation(program)
    }

    /// Whether the method for a point to cut off leaves a state for nodes: at a vertex, or at the
    /// one optimum of a program with curvature in every direction.
    pub fn separates_by_state(&self, program: &Reduced) -> bool {
        self.warm.is_some() && (ActiveSet::suits(program) || DualSimplex::suits_separation(program))
    }

    /// Takes back the vectors of a verdict, for their memory.
    pub(crate) fn reuse(&mut self, verdict: RelaxationVerdict) {
        let (x, y, warm) = match verdict {
            RelaxationVerdict::Relaxed { x, y, warm, .. } => (x, y, warm),
            RelaxationVerdict::Refuted(y) => (Vec::new(), y, None),
            RelaxationVerdict::Stopped | RelaxationVerdict::Descent => return,
        };
        let claim = RelaxationClaim::Unknown;
        self.cold.method.reuse(RelaxationResult { claim, x, y, iterations: 0, warm });
    }

    pub(super) fn solve_by(
        &mut self,
        attempt: MethodAttempt,
        program: &Reduced,
        request: &Request<'_>,
    ) -> RelaxationResult {
        let MethodAttempt { stage, iterations, tolerance, refinements } = attempt;
        let entry = match (stage, request.warm_method, &mut self.warm) {
            (Stage::Warm, Some(method), Some(warm)) => Some(&mut warm[method as usize]),
            (Stage::Fallback, ..) => self.fallback.as_mut(),
            _ => None,
        };
        let entry = entry.unwrap_or(&mut self.cold);
        let warm = request.warm.filter(|_| (entry.starts_warm)(request.purpose));
        let (cutoff, token) = (request.cutoff, request.token);
        let effort = Effort { iterations, tolerance, refinements, cutoff, token, warm };
        let began = Instant::now();
        let result = entry.method.solve(program, &effort);
        self.spent.time += began.elapsed();
        *(entry.count)(&mut self.spent.counts) += 1;
        self.spent.iterations += result.iterations;
        result
    }

    /// Solves a program with the first attempt of a purpose. The result is what a method claims.
    pub fn solve_once(
        &mut self,
        program: &Reduced,
        purpose: Purpose,
        token: &StopToken,
    ) -> RelaxationResult {
        let attempt = self.attempts(purpose, None)[0];
        self.solve_by(attempt, program, &Request::complete(purpose, token))
    }

    /// Solves a program with one attempt of a purpose after the other until a result is accepted.
    pub fn solve_until<T>(
        &mut self,
        program: &Reduced,
        purpose: Purpose,
        token: &StopToken,
        mut accept: impl FnMut(RelaxationResult) -> Option<T>,
    ) -> Option<T> {
        let request = Request::complete(purpose, token);
        let mut attempts = self.attempts(purpose, None).iter();
        attempts.find_map(|attempt| accept(self.solve_by(*attempt, program, &request)))
    }

    /// Solves the program of a node and verifies what the methods claim, trying harder while the
    /// result is not good enough. A program with cones that are not cut off gets the rows that the
    /// multipliers of its cones are.
    pub fn solve(
        &mut self,
        program: &mut Reduced,
        question: &RelaxationQuestion<'_>,
    ) -> RelaxationVerdict {
        if program.is_conic() {
            return self.solve_conic(program, question);
        }
        let program = &*program;
        let (verdict, doubt) = self.solve_as_is(program, question);
        let better = match &verdict {
            RelaxationVerdict::Relaxed { bound, x, .. } if question.purpose != Purpose::Trial => {
                self.resolve_doubt(program, question, *bound, x, doubt)
            }
            _ => None,
        };
        better.unwrap_or(verdict)
    }

    /// Solves a program whose bound is blurred, or whose point is rough, in other ways: at a
    /// vertex, whose point and multipliers are as exact as the basis, or with wider limits, which
    /// tell whether the program has points up to rounding only. Returns `None` if that shows
    /// nothing new.
    fn resolve_doubt(
        &mut self,
        program: &Reduced,
        question: &RelaxationQuestion<'_>,
        bound: f64,
        x: &[f64],
        doubt: Doubt,
    ) -> Option<RelaxationVerdict> {
        if !doubt.is_any() {
            return None;
        }
        let cutoff = f64::INFINITY;
        let question =
            RelaxationQuestion { cutoff, look_for_descent: false, warm: None, ..*question };
        if let Some(vertex) = self.solve_at_vertex(program, &question) {
            return Some(vertex);
        }
        if doubt.rough && !doubt.blurred {
            return None;
        }
        for part in WIDENINGS {
            let (verdict, doubt) = self.solve_as_is(&widened(program, x, part), &question);
            let RelaxationVerdict::Relaxed { bound: wider, x, y, converged, .. } = &verdict else {
                break;
            };
            if doubt.blurred {
                continue;
            }
            let torn = *converged && is_torn(program, [bound, *wider], x, y, part);
            return torn.then_some(verdict);
        }
        None
    }

    /// Solves a linear program by the dual simplex method, if that ends with a vertex and a bound
    /// that agree.
    fn solve_at_vertex(
        &mut self,
        program: &Reduced,
        question: &RelaxationQuestion<'_>,
    ) -> Option<RelaxationVerdict> {
        if self.warm.is_none() || !DualSimplex::suits(program) {
            return None;
        }
        let mut request = Request::complete(question.purpose, question.token);
        request.warm_method = Some(WarmMethod::Simplex);
        let result = self.solve_by(VERTEX, program, &request);
        let mut findings = Findings::new(program, question);
        let outcome = findings.verify(result, &mut self.prover);
        matches!(outcome, AttemptOutcome::Sufficient).then(|| {
            let (bound, x) = (findings.bound, std::mem::take(&mut findings.x));
            findings.relaxed(bound, x, true)
        })
    }

    /// Solves the program of a node and verifies what the methods claim. Also returns what is
    /// doubtful about the verdict.
    fn solve_as_is(
        &mut self,
        program: &Reduced,
        question: &RelaxationQuestion<'_>,
    ) -> (RelaxationVerdict, Doubt) {
        let token = question.token;
        let mut findings = Findings::new(program, question);
        if program.columns.is_empty() {
            findings.warm = question.warm.cloned();
            return (findings.relaxed(program.offset, Vec::new(), true), Doubt::default());
        }
        let warm_method = self.warm_method(program, question);
        let all = self.attempts(question.purpose, warm_method);
        // Threads of a deterministic search must not differ in what they have seen.
        let purpose = question.purpose;
        // No trial is worth an interior-point method in a large program.
        let is_hasty = purpose == Purpose::Trial && self.separates_vertex(program);
        let learns = matches!(purpose, Purpose::Node | Purpose::Trial)
            && all.len() > 1
            && !(question.options.deterministic || is_hasty);
        let record = warm_method.map_or(COLD_RECORD, |method| method as usize);
        let start = usize::from(learns && !self.records[record].asks());
        let (warm, cutoff) = (question.warm, findings.cutoff);
        let mut request = Request { purpose, warm_method, warm, cutoff, token };
        let mut at = start;
        while let Some(&attempt) = all.get(at) {
            request.cutoff = findings.cutoff;
            let result = self.solve_by(attempt, program, &request);
            if result.claim == RelaxationClaim::Unknown && token.is_over() {
                let verdict = findings.stopped(result, &mut self.prover);
                return (verdict, Doubt::default());
            }
            let is_cut_short = purpose == Purpose::Trial
                && attempt.stage == Stage::Warm
                && result.iterations >= u64::from(attempt.iterations);
            let outcome = findings.verify(result, &mut self.prover);
            if learns && at == 0 && !matches!(outcome, AttemptOutcome::Repeat) {
                let gave_up = matches!(outcome, AttemptOutcome::TryHarder) && !is_cut_short;
                self.records[record].note(gave_up);
            }
            match outcome {
                AttemptOutcome::Decided(verdict) => return (verdict, findings.doubt),
                AttemptOutcome::Sufficient => break,
                AttemptOutcome::Repeat => {}
                // The bound of a trial that was cut short is a bound.
                AttemptOutcome::TryHarder
                    if is_hasty || is_cut_short && findings.bound.is_finite() =>
                {
                    break;
                }
                AttemptOutcome::TryHarder => {
                    at += 1;
                    if at == 1 && start == 0 && all.len() > 1 {
                        self.spent.counts.given_up += 1;
                    }
                }
            }
        }
        if question.look_for_descent && !findings.converged && self.falls_forever(program, token) {
            return (RelaxationVerdict::Descent, Doubt::default());
        }
        let Findings { doubt, bound, converged, .. } = findings;
        // Zeros if no attempt had a point.
        findings.x.resize(program.columns.len(), 0.0);
        let x = std::mem::take(&mut findings.x);
        (findings.relaxed(bound, x, converged), doubt)
    }
}

impl std::fmt::Debug for MethodCascade {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("MethodCascade").field("spent", &self.spent).finish_non_exhaustive()
    }
}
