//! Relaxations of programs with cones as they are: the conic multipliers become cuts, so that the
//! bound is proved like any other.
//!
//! Multipliers `z` of a cone lie in the cone, and `z.s >= 0` for all `s` of the cone: a row that
//! holds in it (see [`ConeCut`]). The rows of all cones, each with its multiplier, and the
//! multipliers of the other rows prove the bound of the conic program.
//!
//! Where the objective falls towards a value that no point has, points leave for infinity, and some
//! multipliers vanish. Whatever is left of them is a slope along columns without bounds, which
//! proves nothing. So such a program is tried without small multipliers as well.

use super::cone_cut::ConeCut;
use super::conic_form::ConicForm;
use super::interior::InteriorPoint;
use super::method_cascade::{CONIC_RECORD, MethodCascade, QUADRATICS_RECORD};
use super::sequential_quadratic::SequentialQuadratic;
use super::verdict::{AttemptOutcome, Findings, RelaxationQuestion, RelaxationVerdict};
use super::{Effort, Purpose, RelaxationClaim, RelaxationResult, WarmState};
use crate::presolve::{FIXED, Reduced};
use crate::solver::StopToken;
use crate::tolerance;
use web_time::Instant;

/// A method for programs with cones.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ConicMethod {
    /// The crate's own, which is quicker, and gives up where a program has no interior.
    InteriorPoint,
    Clarabel,
    /// Where cones are few and long, from the state of the parent.
    SequentialQuadratic,
}

/// A method, iterations, tolerance and steps of refinement of an attempt. A sequence of quadratic
/// programs counts its iterations by program.
type ConicAttempt = (ConicMethod, u32, f64, u32);

/// The attempts of a purpose, in their order.
const fn conic_attempts(purpose: Purpose) -> &'static [ConicAttempt] {
    use ConicMethod::{Clarabel, InteriorPoint, SequentialQuadratic};
    match purpose {
        Purpose::Trial => &[
            (SequentialQuadratic, 500, 1e-6, 1),
            (InteriorPoint, 60, 1e-7, 1),
            (Clarabel, 60, 1e-6, 1),
        ],
        Purpose::Leaf => &[
            (SequentialQuadratic, 500, 1e-8, 1),
            (InteriorPoint, 60, 1e-9, 1),
            (Clarabel, 100, 1e-9, 4),
            (Clarabel, 300, 1e-11, 10),
            (Clarabel, 300, 1e-7, 10),
        ],
        _ => &[
            (SequentialQuadratic, 500, 1e-8, 1),
            (InteriorPoint, 60, 1e-8, 1),
            (Clarabel, 100, 1e-8, 2),
            (Clarabel, 300, 1e-9, 10),
        ],
    }
}

/// The attempts at multipliers for the user.
const MULTIPLIER_ATTEMPTS: [ConicAttempt; 2] =
    [(ConicMethod::Clarabel, 100, 1e-8, 2), (ConicMethod::Clarabel, 300, 1e-6, 10)];

/// The shares of the largest multiplier of a cone below which others are taken for 0, one after the
/// other: they vanish where a point leaves for infinity (no unit).
const VANISHING: [f64; 3] = [0.0, 1e-3, 0.1];

/// The best result so far.
struct Best {
    bound: f64,
    x: Vec<f64>,
    y: Vec<f64>,
    converged: bool,
    warm: Option<WarmState>,
    cuts: Vec<(ConeCut, f64)>,
}

impl MethodCascade {
    /// Solves a program with its cones, and verifies the bound. The program gets the rows that the
    /// multipliers of its cones are; their names are no rows of the program behind it.
    pub(super) fn solve_conic(
        &mut self,
        program: &mut Reduced,
        question: &RelaxationQuestion<'_>,
    ) -> RelaxationVerdict {
        self.cone_cuts.clear();
        if let Some(verdict) = without_columns(program) {
            return verdict;
        }
        let rows = program.rows.len();
        let place = program.places();
        let mut best: Option<Best> = None;
        let mut ends = program.lower.iter().chain(&program.upper);
        let is_open = ends.any(|end| end.is_infinite());
        let shares = if is_open { &VANISHING[..] } else { &VANISHING[..1] };
        // Threads of a deterministic search must not differ in what they have seen.
        let learns = !question.options.deterministic;
        for &attempt in conic_attempts(question.purpose) {
            program.truncate_rows(rows);
            if !self.asks_conic(attempt.0, program, question) {
                continue;
            }
            let (result, multipliers) = self.attempt_conic(program, attempt, question);
            if result.claim == RelaxationClaim::Unknown && question.token.is_over() {
                return RelaxationVerdict::Stopped;
            }
            let mut is_enough = false;
            for &slight in shares {
                let cuts = cuts_of(program, &multipliers, slight);
                let mut result = result.clone();
                for (cut, multiplier) in &cuts {
                    program.append_row(&cut.terms, &place, FIXED);
                    result.y.push(*multiplier);
                }
                let cutoff = f64::INFINITY;
                let own = RelaxationQuestion { cutoff, ..*question };
                let mut findings = Findings::new(program, &own);
                let outcome = findings.verify(result, self.prover());
                is_enough =
                    matches!(outcome, AttemptOutcome::Sufficient | AttemptOutcome::Decided(_))
                        || findings.bound >= question.cutoff
                        || question.purpose == Purpose::Trial && findings.converged;
                if let AttemptOutcome::Decided(verdict) = outcome {
                    self.cone_cuts = cuts;
                    return verdict;
                }
                let Findings { bound, x, y, converged, warm, .. } = findings;
                if best.as_ref().is_none_or(|best| bound > best.bound || is_enough) && !x.is_empty()
                {
                    best = Some(Best { bound, x, y, converged, warm, cuts });
                }
                program.truncate_rows(rows);
                if is_enough {
                    break;
                }
            }
            if let Some(record) = record_of(attempt.0).filter(|_| learns) {
                self.records[record].note(!is_enough);
            }
            if is_enough {
                break;
            }
        }
        program.truncate_rows(rows);
        // Also where the multipliers prove a bound: it holds within a radius only.
        let is_near = best.as_ref().is_some_and(|best| best.converged);
        if question.look_for_descent && !is_near && self.falls_forever(program, question.token) {
            return RelaxationVerdict::Descent;
        }
        let Some(Best { bound, x, y, converged, warm, cuts }) = best else {
            let x = vec![0.0; program.columns.len()];
            let (bound, y, converged) = (f64::NEG_INFINITY, Vec::new(), false);
            return RelaxationVerdict::Relaxed { bound, x, y, converged, warm: None };
        };
        cuts.iter().for_each(|(cut, _)| program.append_row(&cut.terms, &place, FIXED));
        self.cone_cuts = cuts;
        RelaxationVerdict::Relaxed { bound, x, y, converged, warm }
    }

    /// Whether a method is to be used for a program.
    fn asks_conic(
        &mut self,
        method: ConicMethod,
        program: &Reduced,
        question: &RelaxationQuestion<'_>,
    ) -> bool {
        let Some(record) = record_of(method) else { return true };
        let suits = match method {
            // A log closes its splits with the multipliers of interior points.
            ConicMethod::SequentialQuadratic => {
                question.options.proof_path().is_none() && SequentialQuadratic::suits(program)
            }
            _ => InteriorPoint::suits_cones(program),
        };
        let learns = !question.options.deterministic;
        self.mixes_methods() && suits && (!learns || self.records[record].asks())
    }

    /// Attempts to solve a program. Also returns the rows that the multipliers of its cones are,
    /// with their own.
    fn attempt_conic(
        &mut self,
        program: &Reduced,
        attempt: ConicAttempt,
        question: &RelaxationQuestion<'_>,
    ) -> (RelaxationResult, Vec<Vec<f64>>) {
        let RelaxationQuestion { cutoff, token, warm, .. } = *question;
        if attempt.0 != ConicMethod::SequentialQuadratic {
            let (result, z) = self.solve_conic_once(program, attempt, cutoff, token, None);
            return (RelaxationResult { warm: None, ..result }, z);
        }
        let last = self.last_quadratics.take().filter(|_| !question.options.deterministic);
        let own = warm.filter(|warm| SequentialQuadratic::knows(warm));
        let warm = own.or(last.as_ref());
        let found = self.solve_conic_once(program, attempt, f64::INFINITY, token, warm);
        self.last_quadratics = found.0.warm.clone().or(last);
        found
    }
}

/// The cuts that the multipliers of the cones are, each with its own multiplier.
fn cuts_of(program: &Reduced, multipliers: &[Vec<f64>], slight: f64) -> Vec<(ConeCut, f64)> {
    let pairs = program.cones.iter().zip(multipliers);
    pairs.filter_map(|(cone, z)| ConeCut::of_multipliers(cone, z, slight)).collect()
}

/// The record of a method; Clarabel, which is always asked, has none.
fn record_of(method: ConicMethod) -> Option<usize> {
    match method {
        ConicMethod::InteriorPoint => Some(CONIC_RECORD),
        ConicMethod::SequentialQuadratic => Some(QUADRATICS_RECORD),
        ConicMethod::Clarabel => None,
    }
}

/// A point of a program with cones, the multipliers of its rows, and the cuts that the multipliers
/// of its cones give, each with its own multiplier.
pub(crate) type ConicMultipliers = (Vec<f64>, Vec<f64>, Vec<(ConeCut, f64)>);

impl MethodCascade {
    /// The multipliers of a program with cones, for the user; `None` if none are accepted.
    pub(crate) fn conic_multipliers<T>(
        &mut self,
        program: &Reduced,
        token: &StopToken,
        mut accept: impl FnMut(ConicMultipliers) -> Option<T>,
    ) -> Option<T> {
        MULTIPLIER_ATTEMPTS.iter().find_map(|&attempt| {
            let (result, multipliers) =
                self.solve_conic_once(program, attempt, f64::INFINITY, token, None);
            // The claim of an attempt does not matter, because the multipliers are checked.
            accept((result.x, result.y, cuts_of(program, &multipliers, 0.0)))
        })
    }

    /// Whether a program of directions with cones has a point that is accepted.
    pub(super) fn steepest_conic(
        &mut self,
        directions: &Reduced,
        token: &StopToken,
        mut accept: impl FnMut(&[f64]) -> bool,
    ) -> bool {
        MULTIPLIER_ATTEMPTS.iter().any(|&attempt| {
            accept(&self.solve_conic_once(directions, attempt, f64::INFINITY, token, None).0.x)
        })
    }

    /// Solves a program with its cones once. Also returns the rows that the multipliers of its
    /// cones are, with their own.
    fn solve_conic_once(
        &mut self,
        program: &Reduced,
        (method, iterations, tolerance, refinements): ConicAttempt,
        cutoff: f64,
        token: &StopToken,
        warm: Option<&WarmState>,
    ) -> (RelaxationResult, Vec<Vec<f64>>) {
        let effort = Effort { iterations, tolerance, refinements, cutoff, token, warm };
        let began = Instant::now();
        let form = match method {
            ConicMethod::SequentialQuadratic => ConicForm::with_limits(program),
            _ => ConicForm::new(program),
        };
        let (result, z) = match method {
            ConicMethod::Clarabel => self.conic.solve_cones(&form, &effort),
            ConicMethod::InteriorPoint => self.conic_interior.solve_cones(&form, &effort),
            ConicMethod::SequentialQuadratic => {
                SequentialQuadratic::default().solve_cones(&form, &effort)
            }
        };
        self.note_conic(method, result.iterations, began.elapsed());
        form.lift(result, z)
    }
}

/// The verdict on a program without free columns.
fn without_columns(program: &Reduced) -> Option<RelaxationVerdict> {
    if !program.columns.is_empty() {
        return None;
    }
    let is_missed = program.cones.iter().any(|cone| {
        let largest = cone.entries.iter().fold(1.0_f64, |most, entry| most.max(entry.value.abs()));
        cone.miss(&[]) > 2.0 * tolerance::FEASIBILITY * largest
    });
    Some(if is_missed {
        RelaxationVerdict::Refuted(Vec::new())
    } else {
        let (bound, x, y) = (program.offset, Vec::new(), Vec::new());
        RelaxationVerdict::Relaxed { bound, x, y, converged: true, warm: None }
    })
}
