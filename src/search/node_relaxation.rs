//! The relaxation of a node: reduce, solve, verify, and try harder where the answer is not good
//! enough.

use super::clock::Activity;
use super::context::Context;
use super::recession::{is_descent_ray, recession_program};
use crate::presolve::{Projection, Reduced, Reduction, project, tighten_coefficients};
use crate::relaxation::{
    Answer, Claim, Effort, Relaxation, lower_bound, polish, proves_infeasible,
};
use crate::tolerance;

/// The attempt at a child on trial: iterations, tolerance, refinements. Its bound is a proved one
/// like any other, if not the best.
const TRIAL: [Attempt; 1] = [(Method::InteriorPoint, 30, 1e-5, 1)];

/// The ladder of attempts at a node: method, iterations, tolerance, refinements. Iterations are
/// capped: a program infeasible by a hair keeps an interior-point method busy without a verdict.
const LADDER: [Attempt; 3] = [
    (Method::InteriorPoint, 60, 1e-8, 1),
    (Method::Clarabel, 60, 1e-8, 1),
    (Method::Clarabel, 200, 1e-9, 10),
];

/// The ladder at a leaf, whose point may become the answer: digits cost an iteration or two.
const LEAF: [Attempt; 4] = [
    (Method::InteriorPoint, 60, 1e-11, 1),
    (Method::Clarabel, 60, 1e-8, 1),
    (Method::Clarabel, 200, 1e-9, 10),
    (Method::Clarabel, 200, 1e-11, 10),
];

type Attempt = (Method, u32, f64, u32);

/// Who is asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Method {
    /// The crate's own method: quick, gives up early.
    InteriorPoint,
    Clarabel,
}

/// What a relaxation is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Purpose {
    /// The root, where it may turn out that the objective falls without limit.
    Root,
    /// A node below, or a leaf of a heuristic.
    Node,
    /// A child on trial, or a step of a dive: a rough answer will do.
    Trial,
}

/// What a relaxation, verified, says about a node.
pub(super) enum Verdict {
    /// No feasible point: proved.
    Refuted,
    /// A limit or an interrupt came first.
    Stopped,
    /// The objective falls without limit along a verified direction.
    Descent,
    /// A proved bound and a point, not necessarily optimal; `converged` if the two are close
    /// together. `y` are the multipliers behind the bound, empty if there are none.
    Relaxed { bound: f64, x: Vec<f64>, y: Vec<f64>, converged: bool },
}

/// What is to be relaxed at the node of the domain; `None` if it is refuted.
pub(super) fn project_node(ctx: &mut Context<'_>) -> Option<Projection> {
    let activity = ctx.clock.switch(Activity::Reduction);
    let program = ctx.base();
    let program = ctx.shared.task.exact.filter(|_| ctx.is_leaf()).unwrap_or(program);
    let projection = match ctx.reducer.reduce(program, &ctx.node.domain) {
        Reduction::Reduced(mut reduced) => {
            let integral = &ctx.program().integral;
            if let Some(windows) = ctx.shared.windows {
                windows.add_rows(&ctx.node.domain, &mut reduced);
            }
            tighten_coefficients(&mut reduced, integral);
            Some(project(*reduced, integral))
        }
        Reduction::Infeasible => None,
    };
    ctx.clock.switch(activity);
    projection
}

/// Solves a reduced program and verifies the answer, trying harder if it is not good enough. A
/// leaf's point may become the answer, so there the gap asked for counts.
pub(super) fn relax(ctx: &mut Context<'_>, reduced: &Reduced, purpose: Purpose) -> Verdict {
    if reduced.columns.is_empty() {
        let (bound, x, y) = (reduced.offset, Vec::new(), Vec::new());
        return Verdict::Relaxed { bound, x, y, converged: true };
    }
    let activity = ctx.clock.switch(Activity::Proof);
    let verdict = climb(ctx, reduced, purpose);
    ctx.clock.switch(activity);
    verdict
}

/// Tries one method after the other.
fn climb(ctx: &mut Context<'_>, reduced: &Reduced, purpose: Purpose) -> Verdict {
    let leaf = ctx.is_leaf();
    // The backend's gap is relative to an objective without the constant, which may be large.
    let attempts = match (purpose, leaf) {
        (Purpose::Trial, _) => &TRIAL[..],
        (_, false) => &LADDER[..],
        (_, true) => &LEAF[..],
    };
    let options = ctx.options();
    let leaf_gap = leaf.then_some([options.absolute_gap, options.relative_gap]);
    let mut best = Best::new(reduced, purpose, leaf_gap);
    let mut cutoff = ctx.tree.cutoff();
    let mut attempts = attempts.iter().peekable();
    while let Some(&&(method, iterations, tolerance, refinements)) = attempts.peek() {
        let effort = Effort { iterations, tolerance, refinements, cutoff, token: &ctx.token };
        let activity = ctx.clock.switch(Activity::Relaxation);
        let answer = match method {
            Method::InteriorPoint => ctx.interior.solve(reduced, &effort),
            Method::Clarabel => ctx.clarabel.solve(reduced, &effort),
        };
        ctx.clock.switch(activity);
        ctx.count_relaxation(answer.iterations);
        if answer.claim == Claim::Unknown && ctx.token.is_over() {
            return Verdict::Stopped;
        }
        match best.take(answer, cutoff) {
            Next::Done(verdict) => return verdict,
            Next::Enough => break,
            // What the method promised does not hold: the same again, to the end.
            Next::WithoutCutoff => cutoff = f64::INFINITY,
            Next::Harder => _ = attempts.next(),
        }
    }
    if purpose == Purpose::Root && !best.converged && falls_forever(ctx, reduced) {
        return Verdict::Descent;
    }
    best.into_verdict()
}

/// The best that the attempts have come to.
struct Best<'a> {
    reduced: &'a Reduced,
    purpose: Purpose,
    /// Absolute and relative gap of the search, at a leaf.
    leaf_gap: Option<[f64; 2]>,
    bound: f64,
    /// The multipliers behind the bound.
    y: Vec<f64>,
    /// The point nearest to the bound, and how near.
    x: Vec<f64>,
    distance: f64,
    converged: bool,
}

/// How to go on after an attempt.
enum Next {
    Done(Verdict),
    Enough,
    Harder,
    WithoutCutoff,
}

impl<'a> Best<'a> {
    fn new(reduced: &'a Reduced, purpose: Purpose, leaf_gap: Option<[f64; 2]>) -> Self {
        Best {
            reduced,
            purpose,
            leaf_gap,
            bound: f64::NEG_INFINITY,
            y: Vec::new(),
            x: vec![0.0; reduced.columns.len()],
            distance: f64::INFINITY,
            converged: false,
        }
    }

    /// Verifies an answer and takes it in.
    fn take(&mut self, answer: Answer, cutoff: f64) -> Next {
        match answer.claim {
            Claim::Infeasible | Claim::Beyond | Claim::Unknown
                if proves_infeasible(self.reduced, &answer.y) =>
            {
                Next::Done(Verdict::Refuted)
            }
            Claim::Unbounded
                if self.purpose == Purpose::Root && is_descent_ray(self.reduced, &answer.x) =>
            {
                Next::Done(Verdict::Descent)
            }
            Claim::Solved | Claim::Beyond | Claim::Unknown
                if answer.x.iter().all(|v| v.is_finite()) =>
            {
                self.take_point(answer, cutoff)
            }
            _ => Next::Harder,
        }
    }

    fn take_point(&mut self, answer: Answer, cutoff: f64) -> Next {
        let Answer { claim, x, y, .. } = answer;
        let bound = if self.reduced.is_feasibility_problem() {
            self.reduced.offset
        } else {
            lower_bound(self.reduced, &x, &y)
        };
        let value = self.reduced.objective(&x);
        let size = x.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        if bound >= self.bound {
            (self.bound, self.y) = (bound, y);
        }
        if bound >= cutoff {
            let y = std::mem::take(&mut self.y);
            return Next::Done(Verdict::Relaxed { bound, x, y, converged: false });
        }
        if claim == Claim::Beyond && cutoff.is_finite() {
            return Next::WithoutCutoff;
        }
        // A later attempt wins a tie.
        let distance = (value - self.bound).abs();
        if distance <= self.distance {
            (self.distance, self.x) = (distance, x);
        }
        let slack = if self.purpose == Purpose::Trial { 1e-3 } else { 1e-6 };
        let gap = value - bound;
        self.converged = size <= tolerance::FREE_RADIUS && gap <= slack * value.abs().max(1.0);
        if claim == Claim::Solved && gap <= self.enough(value) {
            Next::Enough
        } else {
            Next::Harder
        }
    }

    /// The gap that needs no further attempt.
    fn enough(&self, value: f64) -> f64 {
        let enough = 1e-6 * value.abs().max(1.0);
        let wanted = |[absolute, relative]: [f64; 2]| 0.1 * absolute.max(relative * value.abs());
        self.leaf_gap.map_or(enough, |gap| enough.min(wanted(gap)))
    }

    fn into_verdict(self) -> Verdict {
        let Best { bound, x, y, converged, .. } = self;
        Verdict::Relaxed { bound, x, y, converged }
    }
}

/// Looks for a direction of descent without end if the method named none.
fn falls_forever(ctx: &mut Context<'_>, reduced: &Reduced) -> bool {
    let Some(directions) = recession_program(reduced) else { return false };
    let effort = Effort {
        iterations: 200,
        tolerance: 1e-9,
        refinements: 10,
        cutoff: f64::INFINITY,
        token: &ctx.token,
    };
    let activity = ctx.clock.switch(Activity::Relaxation);
    let mut answer = ctx.clarabel.solve(&directions, &effort);
    ctx.clock.switch(activity);
    ctx.count_relaxation(answer.iterations);
    polish(&directions, &mut answer.x, &ctx.token);
    is_descent_ray(reduced, &answer.x)
}
