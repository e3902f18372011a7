//! Which method is asked, how hard, and who is asked next: the ladder of attempts.
//!
//! An attempt is a method with a number of iterations, a tolerance and a number of refinements. The
//! attempts of each [`Purpose`] stand in one table, `attempts.rs`; the methods in another,
//! [`Entry::of`], where a new one needs one line. Nothing else in the crate names a method.

use web_time::{Duration, Instant};

use super::active_set::ActiveSet;
use super::attempts::{Attempt, First, Last, Purpose, Warm, attempts};
use super::borderline::{Doubt, WIDER, is_torn, widened};
use super::clarabel::ClarabelRelaxation;
use super::interior::InteriorPoint;
use super::recession::{is_descent_ray, recession_program};
use super::record::Record;
use super::simplex::DualSimplex;
use super::verdict::{Known, Question, Step, Verdict};
use super::{Claim, Effort, Relaxation, RelaxationResult, WarmState};
use super::{Prover, polish};
use crate::presolve::{Domain, Reduced, Reducer};
use crate::program::Program;
use crate::solution::{RelaxationCounts, Statistics};
use crate::solver::{RelaxationMethod, StopToken};

/// Where the methods that start from a state stand.
const ACTIVE_SET: usize = 0;
const SIMPLEX: usize = 1;

/// Where the first method's record stands, after theirs.
const FIRST: usize = 2;

/// The attempt at a corner of a program whose bound is blurred.
const CORNER: Attempt = (Warm, 2000, 1e-14, 1);

/// A method, where it is counted, and for what it is given the parent's state.
struct Entry {
    method: Box<dyn Relaxation>,
    starts_warm: fn(Purpose) -> bool,
    count: fn(&mut RelaxationCounts) -> &mut u64,
}

impl Entry {
    fn of(method: RelaxationMethod) -> Self {
        match method {
            RelaxationMethod::Automatic | RelaxationMethod::InteriorPoint => Entry {
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

/// The attempts, iterations and time that a ladder has taken since it was last asked.
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

/// The contents of [`Verdict::Relaxed`].
struct Relaxed {
    bound: f64,
    x: Vec<f64>,
    y: Vec<f64>,
    converged: bool,
    warm: Option<WarmState>,
}

impl Relaxed {
    fn into_verdict(self) -> Verdict {
        let Relaxed { bound, x, y, converged, warm } = self;
        Verdict::Relaxed { bound, x, y, converged, warm }
    }
}

/// The methods of a search, the memory that they work in, and what they have taken.
pub struct Ladder {
    /// Those that start from the parent's state, none or all: for dense programs with curvature, and
    /// for linear ones.
    warm: Vec<Entry>,
    first: Entry,
    /// `None` if the first method is alone.
    last: Option<Entry>,
    /// The records of the methods that start from a state, and of the first one.
    records: [Record; 3],
    spent: Spent,
    prover: Prover,
    reducer: Reducer,
}

impl Ladder {
    /// The ladder of a choice.
    pub fn new(choice: RelaxationMethod) -> Self {
        let last = RelaxationMethod::Clarabel;
        let last = (choice != last).then(|| Entry::of(last));
        let warm = match choice {
            RelaxationMethod::Automatic => vec![
                Entry {
                    method: Box::new(ActiveSet::new()),
                    starts_warm: |_| true,
                    count: |counts| &mut counts.active_set,
                },
                Entry {
                    method: Box::new(DualSimplex::new()),
                    starts_warm: |_| true,
                    count: |counts| &mut counts.dual_simplex,
                },
            ],
            _ => Vec::new(),
        };
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
        let (records, spent, prover, reducer) = Default::default();
        Ladder { warm, first, last, records, spent, prover, reducer }
    }

    /// Proves bounds, in the memory that the ladder has for that.
    pub fn prover(&mut self) -> &mut Prover {
        &mut self.prover
    }

    /// Reduces the programs that it is asked about, in the memory that the ladder has for that.
    pub(crate) fn reducer(&mut self) -> &mut Reducer {
        &mut self.reducer
    }

    /// Reduces the program of a leaf, whose point may become the answer. Where the dual simplex method
    /// suits, only rounding is dropped, because other rows may multiply what a dropped row leaves open:
    /// corners need no interior.
    pub(crate) fn reduce_leaf(&mut self, program: &Program, domain: &Domain) -> Option<Reduced> {
        let is_linear = program.quadratic.compute_nnz() == 0;
        let has_corner = self.warm.len() > SIMPLEX && DualSimplex::suits_costs(&program.linear);
        match is_linear && has_corner {
            true => self.reducer.reduce_strictly(program, domain),
            false => self.reducer.reduce(program, domain),
        }
    }

    /// The attempts, iterations and time taken since this was last called.
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
    /// simplex method is for roots, and for leaves, which are reduced for it.
    fn warm_method(&self, program: &Reduced, question: &Question<'_>) -> Option<usize> {
        let cold = matches!(question.purpose, Purpose::Root | Purpose::Leaf);
        let starts = question.warm.is_some() || cold;
        let mut suits = [false; 2];
        suits[ACTIVE_SET] = ActiveSet::suits(program);
        suits[SIMPLEX] = starts && DualSimplex::suits(program);
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
        let (verdict, doubt) = self.solve_as_is(program, question);
        match verdict {
            Verdict::Relaxed { bound, x, y, converged, warm } if doubt.is_any() => {
                let first = Relaxed { bound, x, y, converged, warm };
                self.solve_doubtful(program, question, (first, doubt)).into_verdict()
            }
            verdict => verdict,
        }
    }

    /// Solves a program whose bound is blurred, or whose point is rough, in other ways: at a corner, whose point and multipliers
    /// are as exact as the basis, or with wider limits, which tell whether the program has a point up to
    /// rounding only. Returns what is known already if neither shows anything.
    fn solve_doubtful(
        &mut self,
        program: &Reduced,
        question: &Question<'_>,
        (first, doubt): (Relaxed, Doubt),
    ) -> Relaxed {
        if question.purpose == Purpose::Trial {
            return first;
        }
        let cutoff = f64::INFINITY;
        let question = Question { cutoff, look_for_descent: false, warm: None, ..*question };
        if let Some(corner) = self.solve_at_corner(program, &question) {
            return corner;
        }
        if doubt.rough && !doubt.blurred {
            return first;
        }
        for part in WIDER {
            let wide = widened(program, &first.x, part);
            let (verdict, doubt) = self.solve_as_is(&wide, &question);
            let Verdict::Relaxed { bound, x, y, converged, warm } = verdict else { break };
            if doubt.blurred {
                continue;
            }
            if converged && is_torn(program, [first.bound, bound], (&x, &y), part) {
                return Relaxed { bound, x, y, converged, warm };
            }
            break;
        }
        first
    }

    /// Solves a linear program by the dual simplex method, if that ends with a corner and a bound that
    /// agree.
    fn solve_at_corner(&mut self, program: &Reduced, question: &Question<'_>) -> Option<Relaxed> {
        if self.warm.len() <= SIMPLEX || !DualSimplex::suits(program) {
            return None;
        }
        let how = (Some(SIMPLEX), (question.purpose, None));
        let result = self.ask(CORNER, program, (f64::INFINITY, question.token), how);
        let mut known = Known::new(program, question);
        let step = known.take(result, &mut self.prover);
        let Known { bound, x, y, warm, .. } = known;
        matches!(step, Step::GoodEnough).then_some(Relaxed { bound, x, y, converged: true, warm })
    }

    /// Solves the program of a node and verifies what the methods claim; and what is doubtful
    /// about it.
    fn solve_as_is(&mut self, program: &Reduced, question: &Question<'_>) -> (Verdict, Doubt) {
        let token = question.token;
        let mut known = Known::new(program, question);
        if program.columns.is_empty() {
            known.warm = question.warm.cloned();
            return (known.relaxed(program.offset, Vec::new(), true), Doubt::default());
        }
        let warm = self.warm_method(program, question);
        let all = self.attempts(question.purpose, warm);
        // Threads of a deterministic search must not differ in what they have seen.
        let learns = matches!(question.purpose, Purpose::Node | Purpose::Trial)
            && all.len() > 1
            && !question.options.deterministic;
        let who = warm.unwrap_or(FIRST);
        let start = usize::from(learns && !self.records[who].asks());
        let mut at = start;
        while let Some(&attempt) = all.get(at) {
            let state = (question.purpose, question.warm);
            let result = self.ask(attempt, program, (known.cutoff, token), (warm, state));
            if result.claim == Claim::Unknown && token.is_over() {
                return (Verdict::Stopped, Doubt::default());
            }
            let step = known.take(result, &mut self.prover);
            if learns && at == 0 && !matches!(step, Step::Again) {
                self.records[who].note(matches!(step, Step::Next));
            }
            match step {
                Step::Ended(verdict) => return (verdict, known.doubt),
                Step::GoodEnough => break,
                Step::Again => {}
                Step::Next => {
                    at += 1;
                    if at == 1 && start == 0 && all.len() > 1 {
                        self.spent.counts.given_up += 1;
                    }
                }
            }
        }
        if question.look_for_descent && !known.converged && self.falls_forever(program, token) {
            return (Verdict::Descent, Doubt::default());
        }
        let doubt = known.doubt;
        let (bound, mut x, converged) =
            (known.bound, std::mem::take(&mut known.x), known.converged);
        // Zeros if no attempt had a point.
        x.resize(program.columns.len(), 0.0);
        (known.relaxed(bound, x, converged), doubt)
    }

    /// Looks for a direction of descent without end when no method named one.
    fn falls_forever(&mut self, program: &Reduced, token: &StopToken) -> bool {
        let Some(directions) = recession_program(program) else { return false };
        let mut result = self.solve_once(&directions, Purpose::Direction, token);
        polish(&directions, &mut result.x, token);
        is_descent_ray(program, &result.x)
    }
}

impl std::fmt::Debug for Ladder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Ladder").field("spent", &self.spent).finish_non_exhaustive()
    }
}
