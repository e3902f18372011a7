//! Which method is asked, how hard, and who is asked next: the ladder of attempts.
//!
//! An attempt is a method with a number of iterations, a tolerance and a number of refinements. The
//! attempts of each [`Purpose`] stand in one table, [`attempts`]; the methods in another,
//! [`Entry::of`], where a new one needs one line. Nothing else in the crate names a method.

use web_time::{Duration, Instant};

use super::active_set::ActiveSet;
use super::clarabel::ClarabelRelaxation;
use super::interior::InteriorPoint;
use super::recession::{is_descent_ray, recession_program};
use super::simplex::DualSimplex;
use super::{Claim, Effort, Relaxation, RelaxationResult, WarmState};
use super::{Prover, polish};
use crate::presolve::{Reduced, Reducer};
use crate::solution::{RelaxationCounts, Statistics};
use crate::solver::{Options, RelaxationMethod, StopToken};
use crate::tolerance;

/// What a relaxation is solved for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// The root, where it may turn out that the objective falls without limit.
    Root,
    /// A node below.
    Node,
    /// A child on trial, or a step of a dive: a rough answer will do. Its bound is a proved one like
    /// any other, if not the best.
    Trial,
    /// A leaf, whose point may become the answer: digits cost an iteration or two.
    Leaf,
    /// A point to cut off.
    Separation,
    /// A bound on an expression.
    Bound,
    /// A direction in which the objective may fall without limit.
    Direction,
    /// Multipliers for the user.
    Multipliers,
}

/// Who is asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Who {
    /// The method that starts from the parent's state, where there is one for the program.
    Warm,
    /// The first method: quick, and gives up early.
    First,
    /// The last method: slower, and gives up late.
    Last,
}
use Who::{First, Last, Warm};

/// Who is asked, with how many iterations, at which tolerance, with how many refinements.
type Attempt = (Who, u32, f64, u32);

/// The attempts of a purpose, in their order. Iterations are capped: a program infeasible by a hair
/// keeps an interior-point method busy without a verdict.
fn attempts(purpose: Purpose) -> &'static [Attempt] {
    match purpose {
        Purpose::Trial => &[(Warm, 500, 1e-9, 1), (First, 30, 1e-5, 1)],
        Purpose::Root | Purpose::Node => &[
            (Warm, 2000, 1e-9, 1),
            (First, 60, 1e-8, 1),
            (Last, 60, 1e-8, 1),
            (Last, 200, 1e-9, 10),
        ],
        Purpose::Leaf => &[
            (Warm, 2000, 1e-9, 1),
            (First, 60, 1e-11, 1),
            (Last, 60, 1e-8, 1),
            (Last, 200, 1e-9, 10),
            (Last, 200, 1e-11, 10),
        ],
        Purpose::Separation => &[(First, 60, 1e-8, 1), (Last, 60, 1e-8, 1)],
        Purpose::Bound => &[(Last, 100, 1e-9, 2)],
        Purpose::Direction => &[(Last, 200, 1e-9, 10)],
        Purpose::Multipliers => &[(First, 200, 1e-11, 1), (Last, 200, 1e-11, 10)],
    }
}

/// A method, where it is counted, and for what it is given the parent's state.
struct Entry {
    method: Box<dyn Relaxation>,
    starts_warm: fn(Purpose) -> bool,
    count: fn(&mut RelaxationCounts) -> &mut u64,
}

impl Entry {
    fn of(method: RelaxationMethod) -> Self {
        match method {
            RelaxationMethod::ActiveSet | RelaxationMethod::InteriorPoint => Entry {
                method: Box::new(InteriorPoint::new()),
                // Its point is deeper inside the face of optima if it starts from nothing, which matters
                // where the search goes on from it.
                starts_warm: |purpose| matches!(purpose, Purpose::Trial | Purpose::Separation),
                count: |counts| &mut counts.interior_point,
            },
            RelaxationMethod::Clarabel => Entry {
                method: Box::new(ClarabelRelaxation::new()),
                starts_warm: |_| true,
                count: |counts| &mut counts.clarabel,
            },
        }
    }
}

/// What a ladder has taken since it was last asked.
#[derive(Debug, Clone, Copy, Default)]
pub struct Spent {
    /// Attempts by method.
    pub counts: RelaxationCounts,
    /// Iterations of all attempts.
    pub iterations: u64,
    /// Time inside the methods.
    pub time: Duration,
}

impl Spent {
    /// Adds it to the counts of a solve.
    pub fn count(&self, statistics: &mut Statistics) {
        statistics.relaxations += self.counts.total();
        statistics.relaxation_counts.add(&self.counts);
        statistics.iterations += self.iterations;
    }
}

/// What is asked about a node.
#[derive(Debug, Clone, Copy)]
pub struct Question<'a> {
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

/// What a relaxation, verified, says about a node.
#[derive(Debug)]
pub enum Verdict {
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
        /// What the children's relaxations may start from.
        warm: Option<WarmState>,
    },
}

/// The methods of a search, the memory that they work in, and what they have taken.
pub struct Ladder {
    /// Those that start from the parent's state, none or all: for dense programs with curvature, and
    /// for linear ones.
    warm: Vec<Entry>,
    first: Entry,
    /// `None` if the first method is alone.
    last: Option<Entry>,
    spent: Spent,
    prover: Prover,
    reducer: Reducer,
}

impl Ladder {
    /// The ladder of a choice.
    pub fn new(choice: RelaxationMethod) -> Self {
        let last = RelaxationMethod::Clarabel;
        let last = (choice != last).then(|| Entry::of(last));
        let methods: Vec<Box<dyn Relaxation>> = match choice {
            RelaxationMethod::ActiveSet => {
                vec![Box::new(ActiveSet::new()), Box::new(DualSimplex::new())]
            }
            _ => Vec::new(),
        };
        let entry = |method| Entry {
            method,
            starts_warm: |_| true,
            count: |counts| &mut counts.active_set,
        };
        let warm = methods.into_iter().map(entry).collect();
        let first = Entry::of(choice);
        Ladder::of(warm, first, last)
    }

    /// A ladder with a method of one's own, alone and counted as the crate's own.
    pub fn with_method(method: Box<dyn Relaxation>) -> Self {
        let count: fn(&mut RelaxationCounts) -> &mut u64 = |counts| &mut counts.interior_point;
        let first = Entry { method, starts_warm: |_| true, count };
        Ladder::of(Vec::new(), first, None)
    }

    fn of(warm: Vec<Entry>, first: Entry, last: Option<Entry>) -> Self {
        let (spent, prover, reducer) = Default::default();
        Ladder { warm, first, last, spent, prover, reducer }
    }

    /// Proves bounds, in the memory that the ladder has for that.
    pub fn prover(&mut self) -> &mut Prover {
        &mut self.prover
    }

    /// Reduces the programs that it is asked about, in the memory that the ladder has for that.
    pub(crate) fn reducer(&mut self) -> &mut Reducer {
        &mut self.reducer
    }

    /// What was taken since this was last called.
    pub fn take_spent(&mut self) -> Spent {
        std::mem::take(&mut self.spent)
    }

    /// The attempts of a purpose at a program. A method that is alone is not asked twice for the
    /// same.
    fn attempts(&self, purpose: Purpose, warm: Option<usize>) -> &'static [Attempt] {
        let all = attempts(purpose);
        let others = match all {
            [(Warm, ..), ..] if warm.is_some() => return all,
            [(Warm, ..), others @ ..] => others,
            all => all,
        };
        match others {
            [_, rest @ ..] if self.last.is_none() && !rest.is_empty() => rest,
            all => all,
        }
    }

    /// Which of the methods that start from a state is for a program. Without a state the dual
    /// simplex method is for the root only.
    fn warm_method(&self, program: &Reduced, question: &Question<'_>) -> Option<usize> {
        let starts = question.warm.is_some() || question.purpose == Purpose::Root;
        let suits = [ActiveSet::suits(program), starts && DualSimplex::suits(program)];
        (0..self.warm.len()).find(|&k| suits[k])
    }

    /// Whether a method for a program starts from its parent's state.
    pub fn starts_warm(&self, program: &Reduced) -> bool {
        !self.warm.is_empty() && (ActiveSet::suits(program) || DualSimplex::suits(program))
    }

    /// Takes back what a verdict said, for its memory.
    pub(crate) fn reuse(&mut self, verdict: Verdict) {
        let (x, y, warm) = match verdict {
            Verdict::Relaxed { x, y, warm, .. } => (x, y, warm),
            Verdict::Refuted(y) => (Vec::new(), y, None),
            Verdict::Stopped | Verdict::Descent => return,
        };
        let claim = Claim::Unknown;
        self.first.method.reuse(RelaxationResult { claim, x, y, iterations: 0, warm });
    }

    fn ask(
        &mut self,
        (who, iterations, tolerance, refinements): Attempt,
        program: &Reduced,
        (cutoff, token): (f64, &StopToken),
        (warm_method, (purpose, warm)): (Option<usize>, (Purpose, Option<&WarmState>)),
    ) -> RelaxationResult {
        let entry = match who {
            Warm => warm_method.map(|k| &mut self.warm[k]),
            First => None,
            Last => self.last.as_mut(),
        };
        let entry = entry.unwrap_or(&mut self.first);
        let warm = warm.filter(|_| (entry.starts_warm)(purpose));
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
        let first = self.attempts(purpose, None)[0];
        self.ask(first, program, (f64::INFINITY, token), (None, (purpose, None)))
    }

    /// Solves a program with one attempt of a purpose after the other until a result is accepted.
    pub fn solve_until<T>(
        &mut self,
        program: &Reduced,
        purpose: Purpose,
        token: &StopToken,
        mut accept: impl FnMut(RelaxationResult) -> Option<T>,
    ) -> Option<T> {
        let mut attempts = self.attempts(purpose, None).iter().copied();
        let none = (None, (purpose, None));
        let mut ask = |attempt| self.ask(attempt, program, (f64::INFINITY, token), none);
        attempts.find_map(|attempt| accept(ask(attempt)))
    }

    /// Solves the program of a node and verifies what the methods claim, trying harder while the
    /// result is not good enough.
    pub fn solve(&mut self, program: &Reduced, question: &Question<'_>) -> Verdict {
        let token = question.token;
        let mut known = Known::new(program, question);
        if program.columns.is_empty() {
            known.warm = question.warm.cloned();
            return known.relaxed(program.offset, Vec::new(), true);
        }
        let warm = self.warm_method(program, question);
        let all = self.attempts(question.purpose, warm);
        let mut at = 0;
        while let Some(&attempt) = all.get(at) {
            let state = (question.purpose, question.warm);
            let result = self.ask(attempt, program, (known.cutoff, token), (warm, state));
            if result.claim == Claim::Unknown && token.is_over() {
                return Verdict::Stopped;
            }
            match known.take(result, &mut self.prover) {
                Step::Ended(verdict) => return verdict,
                Step::GoodEnough => break,
                Step::Again => {}
                Step::Next => {
                    at += 1;
                    if at == 1 && all.len() > 1 {
                        self.spent.counts.given_up += 1;
                    }
                }
            }
        }
        if question.look_for_descent && !known.converged && self.falls_forever(program, token) {
            return Verdict::Descent;
        }
        let (bound, mut x, converged) =
            (known.bound, std::mem::take(&mut known.x), known.converged);
        // Zeros if no attempt had a point.
        x.resize(program.columns.len(), 0.0);
        known.relaxed(bound, x, converged)
    }

    /// Looks for a direction of descent without end when no method named one.
    fn falls_forever(&mut self, program: &Reduced, token: &StopToken) -> bool {
        let Some(directions) = recession_program(program) else { return false };
        let mut result = self.solve_once(&directions, Purpose::Direction, token);
        polish(&directions, &mut result.x, token);
        is_descent_ray(program, &result.x)
    }
}

/// What the attempts at a node have shown so far.
struct Known<'a> {
    program: &'a Reduced,
    question: &'a Question<'a>,
    /// The cutoff for the next attempt.
    cutoff: f64,
    /// The best proved bound, and the multipliers behind it.
    bound: f64,
    y: Vec<f64>,
    /// The point nearest to the bound, and its distance.
    x: Vec<f64>,
    nearest: f64,
    converged: bool,
    warm: Option<WarmState>,
}

/// What follows from an attempt.
enum Step {
    Ended(Verdict),
    GoodEnough,
    /// The same attempt, without a cutoff.
    Again,
    Next,
}

impl<'a> Known<'a> {
    fn new(program: &'a Reduced, question: &'a Question<'a>) -> Self {
        Known {
            program,
            question,
            cutoff: question.cutoff,
            bound: f64::NEG_INFINITY,
            y: Vec::new(),
            x: Vec::new(),
            nearest: f64::INFINITY,
            converged: false,
            warm: None,
        }
    }

    /// Verifies the claim of an attempt.
    fn take(&mut self, result: RelaxationResult, prover: &mut Prover) -> Step {
        let RelaxationResult { claim, x, y, warm, .. } = result;
        self.warm = warm.or(self.warm.take());
        let may_be_empty = matches!(claim, Claim::Infeasible | Claim::Beyond | Claim::Unknown);
        let has_point = matches!(claim, Claim::Solved | Claim::Beyond | Claim::Unknown);
        if may_be_empty && prover.proves_infeasible(self.program, &y) {
            return Step::Ended(Verdict::Refuted(y));
        }
        let falls = claim == Claim::Unbounded && self.question.look_for_descent;
        if falls && is_descent_ray(self.program, &x) {
            return Step::Ended(Verdict::Descent);
        }
        if has_point && x.iter().all(|v| v.is_finite()) {
            return self.take_point(claim, x, y, prover);
        }
        Step::Next
    }

    /// Proves the bound of an attempt's multipliers, and compares it with the point.
    fn take_point(&mut self, claim: Claim, x: Vec<f64>, y: Vec<f64>, prover: &mut Prover) -> Step {
        let program = self.program;
        let bound = match program.is_feasibility_problem() {
            true => program.offset,
            false => prover.lower_bound(program, &x, &y),
        };
        let value = program.objective(&x);
        if bound >= self.bound {
            (self.bound, self.y) = (bound, y);
        }
        if bound >= self.cutoff {
            return Step::Ended(self.relaxed(bound, x, false));
        }
        if claim == Claim::Beyond && self.cutoff.is_finite() {
            // What the method promised does not hold: the same again, to the end.
            self.cutoff = f64::INFINITY;
            return Step::Again;
        }
        let size = x.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        // A later attempt wins a tie.
        let distance = (value - self.bound).abs();
        if distance <= self.nearest {
            (self.nearest, self.x) = (distance, x);
        }
        let slack = if self.question.purpose == Purpose::Trial { 1e-3 } else { 1e-6 };
        let near = size <= tolerance::FREE_RADIUS;
        self.converged = near && value - bound <= slack * value.abs().max(1.0);
        if claim == Claim::Solved && value - bound <= self.close(value) {
            return Step::GoodEnough;
        }
        Step::Next
    }

    /// How far a point of this value and its bound may be apart. Methods take the gap relative to an
    /// objective without the constant, which may be large. For a leaf the gap asked for counts.
    fn close(&self, value: f64) -> f64 {
        let Question { options, constant, .. } = *self.question;
        let wanted = 0.1 * options.allowed_gap(value, constant);
        let enough = 1e-6 * tolerance::gap_scale(value, constant).max(1.0);
        if self.question.purpose == Purpose::Leaf { enough.min(wanted) } else { enough }
    }

    fn relaxed(&mut self, bound: f64, x: Vec<f64>, converged: bool) -> Verdict {
        let (y, warm) = (std::mem::take(&mut self.y), self.warm.take());
        Verdict::Relaxed { bound, x, y, converged, warm }
    }
}

impl std::fmt::Debug for Ladder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Ladder").field("spent", &self.spent).finish_non_exhaustive()
    }
}
