//! The relaxation of a node: reduce, solve, verify, and try harder where the answer is not good
//! enough.

use super::unbounded::{is_descent_ray, recession_program};
use super::windows::Windows;
use super::worker::Worker;
use super::{Found, Task, search};

use super::clock::Activity;
use super::node::Node;
use crate::presolve::{Projection, Reduced, Reduction, project, tighten_coefficients};
use crate::relaxation::{Claim, Effort, Relaxation, lower_bound, polish, proves_infeasible};
use crate::solution::Termination;
use crate::solver::{BranchingRule, Control};
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

/// What a relaxation, verified, says about a node.
pub(super) enum Verdict {
    /// No feasible point: proved.
    Refuted,
    /// A limit or an interrupt came first.
    Stopped,
    /// The objective falls without limit along a verified direction.
    Descent,
    /// A proved bound and a point, not necessarily optimal; `settled` when the two are close
    /// together. `y` are the multipliers behind the bound, empty where there are none.
    Relaxed { bound: f64, x: Vec<f64>, y: Vec<f64>, settled: bool },
}

impl Worker<'_> {
    /// What is to be relaxed at the node of the domain; nothing when it is refuted.
    pub(super) fn project_node(&mut self) -> Option<Projection> {
        let activity = self.clock.switch(Activity::Reduction);
        let program = self.task.windows.map_or(self.task.program, Windows::base);
        let program = self.task.exact.filter(|_| self.is_leaf()).unwrap_or(program);
        let projection = match self.reducer.reduce(program, &self.domain) {
            Reduction::Reduced(mut reduced) => {
                let integral = &self.task.program.integral;
                if let Some(windows) = self.task.windows {
                    windows.add_rows(&self.domain, &mut reduced);
                }
                tighten_coefficients(&mut reduced, integral);
                Some(project(*reduced, integral))
            }
            Reduction::Infeasible => None,
        };
        self.clock.switch(activity);
        projection
    }

    /// Solves a reduced program and verifies the answer, trying harder where it is not good
    /// enough. A leaf's point may become the answer, so there the gap asked for counts.
    pub(super) fn relax(&mut self, reduced: &Reduced, look_for_descent: bool) -> Verdict {
        let activity = self.clock.switch(Activity::Proof);
        let verdict = self.solve_and_verify(reduced, look_for_descent);
        self.clock.switch(activity);
        verdict
    }

    fn solve_and_verify(&mut self, reduced: &Reduced, look_for_descent: bool) -> Verdict {
        if reduced.columns.is_empty() {
            let (bound, x, y) = (reduced.offset, Vec::new(), Vec::new());
            return Verdict::Relaxed { bound, x, y, settled: true };
        }
        let feasibility_problem = reduced.is_feasibility_problem();
        let options = self.task.options;
        let leaf = self.is_leaf();
        let close = |value: f64| {
            let wanted = 0.1 * options.absolute_gap.max(options.relative_gap * value.abs());
            let enough = 1e-6 * value.abs().max(1.0);
            if leaf { enough.min(wanted) } else { enough }
        };
        let (mut settled, mut nearest) = (false, f64::INFINITY);
        let mut best = (f64::NEG_INFINITY, vec![0.0; reduced.columns.len()]);
        let mut multipliers = Vec::new();
        // The backend's gap is relative to an objective without the constant, which may be large.
        let attempts = match (self.on_trial, leaf) {
            (true, _) => &TRIAL[..],
            (false, false) => &LADDER[..],
            (false, true) => &LEAF[..],
        };
        let mut cutoff = self.tree.cutoff();
        let mut attempts = attempts.iter().peekable();
        while let Some(&&(method, iterations, tolerance, refinements)) = attempts.peek() {
            let effort = Effort { iterations, tolerance, refinements, cutoff, token: &self.token };
            let activity = self.clock.switch(Activity::Relaxation);
            let answer = match method {
                Method::InteriorPoint => self.interior.solve(reduced, &effort),
                Method::Clarabel => self.relaxation.solve(reduced, &effort),
            };
            self.clock.switch(activity);
            self.count_relaxation(answer.iterations);
            if answer.claim == Claim::Unknown && self.token.is_over() {
                return Verdict::Stopped;
            }
            match answer.claim {
                Claim::Infeasible | Claim::Beyond | Claim::Unknown
                    if proves_infeasible(reduced, &answer.y) =>
                {
                    return Verdict::Refuted;
                }
                Claim::Unbounded if look_for_descent && is_descent_ray(reduced, &answer.x) => {
                    return Verdict::Descent;
                }
                Claim::Solved | Claim::Beyond | Claim::Unknown
                    if answer.x.iter().all(|v| v.is_finite()) =>
                {
                    let bound = if feasibility_problem {
                        reduced.offset
                    } else {
                        lower_bound(reduced, &answer.x, &answer.y)
                    };
                    let value = reduced.objective(&answer.x);
                    let solved = answer.claim == Claim::Solved;
                    let answer_size = answer.x.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
                    if bound >= best.0 {
                        (best.0, multipliers) = (bound, answer.y);
                    }
                    if bound >= cutoff {
                        let (x, y) = (answer.x, multipliers);
                        return Verdict::Relaxed { bound, x, y, settled: false };
                    }
                    if answer.claim == Claim::Beyond && cutoff.is_finite() {
                        // What the backend promised does not hold: the same again, to the end.
                        cutoff = f64::INFINITY;
                        continue;
                    }
                    // The point nearest to the bound; a later attempt wins a tie.
                    let distance = (value - best.0).abs();
                    if distance <= nearest {
                        (nearest, best.1) = (distance, answer.x);
                    }
                    let near = answer_size <= tolerance::FREE_RADIUS;
                    settled = near && value - bound <= self.slack() * value.abs().max(1.0);
                    if solved && value - bound <= close(value) {
                        break;
                    }
                }
                _ => {}
            }
            attempts.next();
        }
        if look_for_descent && !settled && self.falls_forever(reduced) {
            return Verdict::Descent;
        }
        Verdict::Relaxed { bound: best.0, x: best.1, y: multipliers, settled }
    }

    pub(super) fn count_relaxation(&mut self, iterations: u64) {
        self.accounts.iterations += iterations;
        self.tree.count(|s| {
            s.relaxations += 1;
            s.iterations += iterations;
        });
    }

    /// Distance of a value from its bound, relative, up to which a relaxation counts as settled.
    fn slack(&self) -> f64 {
        if self.on_trial { 1e-3 } else { 1e-6 }
    }

    /// Looks for a direction of descent without end where the backend named none.
    fn falls_forever(&mut self, reduced: &Reduced) -> bool {
        let Some(directions) = recession_program(reduced) else { return false };
        let effort = Effort {
            iterations: 200,
            tolerance: 1e-9,
            refinements: 10,
            cutoff: f64::INFINITY,
            token: &self.token,
        };
        let activity = self.clock.switch(Activity::Relaxation);
        let mut answer = self.relaxation.solve(&directions, &effort);
        self.clock.switch(activity);
        self.count_relaxation(answer.iterations);
        polish(&directions, &mut answer.x, &self.token);
        is_descent_ray(reduced, &answer.x)
    }

    /// A root without a bound below: unbounded if there is any feasible point.
    pub(super) fn settle_descent(&mut self, node: Node) {
        let mut flat = self.task.program.clone();
        flat.make_feasibility_problem();
        let mut options = self.task.options.nested();
        options.branching = BranchingRule::LatestFirst;
        let (program, cutoff) = (&flat, f64::INFINITY);
        let (exact, options) = (None, &options);
        let task = Task { program, exact, windows: None, options, cutoff, ..self.task };
        let Found { termination, points, statistics, .. } =
            search(task, &mut Control::default(), None);
        let incumbent = points.into_iter().next();
        self.clock.restart();
        self.tree.count(|s| s.add(&statistics));
        match (termination, incumbent) {
            (Termination::Infeasible, _) => {}
            (_, Some(point)) => {
                let value = self.program().objective(&point);
                self.tree.offer(value, point);
                self.tree.stop(Termination::Unbounded);
            }
            (reason, None) if reason.is_limit() => self.tree.give_back(node, reason),
            _ => self.tree.stall(f64::NEG_INFINITY),
        }
    }
}
