//! Processing nodes: propagate, reduce, relax, bound, branch.

use super::branching::{Pseudocosts, Split};
use super::node::{Decision, Node};
use super::probing::Probing;
use super::purify::purify;
use super::reporter::Reporter;
use super::root::{Root, late_first};
use super::tree::Tree;
use super::unbounded::{is_descent_ray, recession_program};
use super::{Found, Task, search};
use std::cell::Cell;

use crate::presolve::{
    Conflict, Domain, Projection, Propagator, Reduced, Reduction, probe, project, reduce,
    tighten_coefficients,
};
use crate::program::Program;
use crate::relaxation::{
    Claim, ClarabelRelaxation, Effort, Relaxation, lower_bound, polish, proves_infeasible,
};
use crate::solution::Termination;
use crate::solver::Control;
use crate::tolerance;

/// One thread of the search, with its own domain and propagation.
pub(super) struct Worker<'a> {
    pub(super) task: Task<'a>,
    pub(super) tree: &'a Tree<'a>,
    id: usize,
    pub(super) domain: Domain,
    pub(super) propagator: Propagator,
    pub(super) covers: &'a [Vec<usize>],
    groups: &'a [Vec<usize>],
    late_first: Vec<usize>,
    relaxation: ClarabelRelaxation,
    pub(super) pseudocosts: Pseudocosts,
    /// The decisions that the domain currently reflects.
    path: Vec<Decision>,
    /// Trail position after root propagation.
    root: usize,
    root_conflict: Option<Conflict>,
    /// The cutoff that propagation uses at the current node.
    pub(super) cutoff: f64,
    /// Nodes since the rounding heuristic last ran.
    since_rounding: u64,
    /// Whether a child is on trial, so that a rough answer will do.
    pub(super) on_trial: bool,
    probing: Probing,
    /// Whether the root, probed before the search, has been processed.
    root_done: bool,
}

/// The attempt at a child on trial: iterations, tolerance, refinements. Its bound is a proved one
/// like any other, if not the best.
const TRIAL: [(u32, f64, u32); 1] = [(30, 1e-5, 1)];

/// What a relaxation, verified, says about a node.
pub(super) enum Verdict {
    /// No feasible point: proved.
    Refuted,
    /// A limit or an interrupt came first.
    Stopped,
    /// The objective falls without limit along a verified direction.
    Descent,
    /// A proved bound and a point, not necessarily optimal.
    Relaxed { bound: f64, x: Vec<f64> },
}

impl<'a> Worker<'a> {
    pub(super) fn new(task: Task<'a>, tree: &'a Tree<'a>, root: &'a Root, id: usize) -> Self {
        let domain = root.domain.clone();
        Worker {
            task,
            tree,
            id,
            root: domain.mark(),
            domain,
            propagator: Propagator::new(task.program),
            covers: &root.covers,
            groups: &root.groups,
            late_first: late_first(task.program),
            relaxation: ClarabelRelaxation::new(),
            pseudocosts: Pseudocosts::new(task.program.column_count()),
            path: Vec::new(),
            root_conflict: root.conflict,
            cutoff: f64::INFINITY,
            since_rounding: u64::MAX,
            on_trial: false,
            probing: Probing::new(),
            root_done: false,
        }
    }

    /// Processes nodes until the tree is done; the worker on the caller's thread reports.
    pub(super) fn run(mut self, mut watch: Option<(&mut Reporter, &mut Control<'_>)>) {
        let mut plunge: Option<Node> = None;
        loop {
            let node = match plunge.take() {
                Some(child) => self.tree.continue_with(self.id, child),
                None => self.tree.next(self.id),
            };
            let Some(node) = node else { break };
            if let Some(reason) = self.tree.limit_reached() {
                self.tree.give_back(self.id, node, reason);
                break;
            }
            plunge = self.process(node);
            if let Some((reporter, control)) = &mut watch {
                reporter.report(self.tree, control);
            }
        }
    }

    /// Processes a node; returns the child to plunge into.
    fn process(&mut self, node: Node) -> Option<Node> {
        self.tree.count(|s| s.nodes += 1);
        let entered = self.root_conflict.is_none() && self.enter(&node.path).is_ok();
        let projection = if entered { self.project_node() } else { None };
        let Some(projection) = projection else {
            self.tree.count(|s| s.refuted_by_propagation += 1);
            self.close_refuted();
            return None;
        };
        let reduced = &projection.reduced;
        let (bound, x) = match self.relax(reduced, node.path.is_empty()) {
            Verdict::Refuted => {
                self.close_refuted();
                return None;
            }
            Verdict::Stopped => {
                let reason = self.tree.limit_reached().unwrap_or(Termination::Interrupted);
                self.tree.give_back(self.id, node, reason);
                return None;
            }
            Verdict::Descent => {
                self.settle_descent(node);
                return None;
            }
            Verdict::Relaxed { bound, x } => {
                if let Some(last) = node.path.last() {
                    let gain = bound - node.bound;
                    self.pseudocosts.learn(last.column, !last.is_upper, gain, node.fraction);
                }
                (self.tree.strengthen(bound.min(self.cutoff)).max(node.bound), x)
            }
        };
        if bound >= self.tree.cutoff() {
            self.tree.close(bound);
            return None;
        }
        if self.is_leaf() {
            // The relaxation of a leaf is the leaf.
            if self.offer_leaf(reduced, &x) {
                self.tree.close(bound);
            } else {
                self.tree.stall(bound);
            }
            return None;
        }
        let mut point = projection.lift(&x);
        let integrality = self.task.options.integrality;
        purify(self.task.program, &self.domain, self.groups, integrality, &mut point);
        self.look_for_points(&point, node.path.is_empty());
        if bound >= self.tree.cutoff() {
            self.tree.close(bound);
            return None;
        }
        self.branch(node, bound, &point)
    }

    /// What is to be relaxed at the node of the domain; nothing when it is refuted.
    pub(super) fn project_node(&self) -> Option<Projection> {
        let Reduction::Reduced(mut reduced) = reduce(self.task.program, &self.domain) else {
            return None;
        };
        let integral = &self.task.program.integral;
        tighten_coefficients(&mut reduced, integral);
        Some(project(*reduced, integral))
    }

    /// A node without a feasible point below the cutoff in force.
    fn close_refuted(&self) {
        if self.cutoff < f64::INFINITY {
            self.tree.close(self.tree.strengthen(self.cutoff));
        }
    }

    fn branch(&mut self, node: Node, bound: f64, point: &[f64]) -> Option<Node> {
        let split = self.choose_split(point, bound);
        let child_of = |decisions: &[Decision]| {
            let mut path = Vec::with_capacity(node.path.len() + decisions.len());
            path.extend_from_slice(&node.path);
            path.extend_from_slice(decisions);
            let moved = |last: &Decision| (point[last.column] - last.value).abs();
            Node { path, bound, fraction: decisions.last().map_or(0.0, moved), serial: 0 }
        };
        let child = |decision: Decision| child_of(&[decision]);
        let bounded = |d: &Decision| {
            self.domain.lower(d.column).is_finite() && self.domain.upper(d.column).is_finite()
        };
        match split {
            Split::Nothing => {
                self.close_refuted();
                None
            }
            Split::One(only) => {
                self.close_refuted();
                Some(child(only))
            }
            Split::Sides(sides) => {
                // Sides that a trial closed are not among them.
                self.close_refuted();
                sides.iter().skip(1).for_each(|side| self.tree.push(child_of(side)));
                sides.first().map(|side| child_of(side))
            }
            // Without any bound, splitting an unbounded column would never end.
            Split::Both([first, second]) if bound > f64::NEG_INFINITY || bounded(&first) => {
                self.tree.push(child(second));
                Some(child(first))
            }
            Split::Both(_) | Split::Impossible => {
                self.tree.stall(bound);
                None
            }
        }
    }

    /// Brings the domain to a node: on from the current path where it is a prefix, else from the
    /// root.
    fn enter(&mut self, path: &[Decision]) -> Result<(), Conflict> {
        let shared = path.len() >= self.path.len() && path[..self.path.len()] == self.path[..];
        if !shared {
            self.domain.undo_to(self.root);
            self.path.clear();
        }
        self.cutoff = self.propagator.set_cutoff(self.task.program, self.tree.cutoff());
        let mark = self.domain.mark();
        let fresh = &path[self.path.len()..];
        for decision in fresh {
            self.domain.apply(decision.column, decision.is_upper, decision.value);
        }
        let program = self.task.program;
        let mut result = self.propagator.propagate_since(program, &mut self.domain, mark);
        if result.is_ok() && self.root_done {
            result = self.probe_node();
        }
        self.root_done = true;
        if result.is_ok() {
            self.path.extend_from_slice(fresh);
        } else {
            self.domain.undo_to(mark);
        }
        result
    }

    /// Probes as much as probing has paid so far.
    fn probe_node(&mut self) -> Result<(), Conflict> {
        let trials = self.probing.trials();
        let (before, done) = (self.domain.mark(), Cell::new(0));
        let go_on = || {
            done.set(done.get() + 1);
            self.tree.limit_reached().is_none()
        };
        let (domain, propagator) = (&mut self.domain, &mut self.propagator);
        let result = probe(self.task.program, domain, propagator, &self.late_first, trials, &go_on);
        let decided = |&(j, _): &(usize, bool)| self.task.program.integral[j];
        let gains = self.domain.changed_since(before).filter(decided).count();
        self.probing.book(done.get(), gains, result.is_err());
        result
    }

    /// Solves a reduced program and verifies the answer, trying harder where it is not good
    /// enough. A leaf's point may become the answer, so there the gap asked for counts.
    pub(super) fn relax(&mut self, reduced: &Reduced, look_for_descent: bool) -> Verdict {
        if reduced.columns.is_empty() {
            return Verdict::Relaxed { bound: reduced.offset, x: Vec::new() };
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
        // Iterations are capped: a program infeasible by a hair keeps an interior-point method
        // busy without a verdict.
        let attempts = [(60, 1e-8, 1), (200, 1e-9, 10), (200, 1e-11, 10)];
        // The backend's gap is relative to an objective without the constant, which may be large.
        let attempts = match (self.on_trial, leaf) {
            (true, _) => &TRIAL[..],
            (false, false) => &attempts[..2],
            (false, true) => &attempts[..],
        };
        let mut cutoff = self.tree.cutoff();
        let mut attempts = attempts.iter().peekable();
        while let Some(&&(iterations, tolerance, refinements)) = attempts.peek() {
            let effort = Effort {
                iterations,
                tolerance,
                refinements,
                cutoff,
                time: self.tree.time_left(),
                interrupt: self.tree.interrupt().clone(),
            };
            let answer = self.relaxation.solve(reduced, &effort);
            self.tree.count(|s| {
                s.relaxations += 1;
                s.iterations += answer.iterations;
            });
            if answer.claim == Claim::Unknown && self.tree.limit_reached().is_some() {
                return Verdict::Stopped;
            }
            let early = cutoff.is_finite() && answer.iterations < u64::from(iterations);
            match answer.claim {
                Claim::Infeasible | Claim::Unknown if proves_infeasible(reduced, &answer.y) => {
                    return Verdict::Refuted;
                }
                Claim::Unbounded if look_for_descent && is_descent_ray(reduced, &answer.x) => {
                    return Verdict::Descent;
                }
                Claim::Solved | Claim::Unknown if answer.x.iter().all(|v| v.is_finite()) => {
                    let bound = if feasibility_problem {
                        reduced.offset
                    } else {
                        lower_bound(reduced, &answer.x, &answer.y)
                    };
                    let value = reduced.objective(&answer.x);
                    let solved = answer.claim == Claim::Solved;
                    let answer_size = answer.x.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
                    best.0 = bound.max(best.0);
                    if bound >= cutoff {
                        return Verdict::Relaxed { bound, x: answer.x };
                    }
                    if early && !solved {
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
                    settled = near && value - bound <= 1e-6 * value.abs().max(1.0);
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
        Verdict::Relaxed { bound: best.0, x: best.1 }
    }

    /// Looks for a direction of descent without end where the backend named none.
    fn falls_forever(&mut self, reduced: &Reduced) -> bool {
        let Some(directions) = recession_program(reduced) else { return false };
        let effort = Effort {
            iterations: 200,
            tolerance: 1e-9,
            refinements: 10,
            cutoff: f64::INFINITY,
            time: self.tree.time_left(),
            interrupt: self.tree.interrupt().clone(),
        };
        let mut answer = self.relaxation.solve(&directions, &effort);
        self.tree.count(|s| {
            s.relaxations += 1;
            s.iterations += answer.iterations;
        });
        polish(&directions, &mut answer.x);
        is_descent_ray(reduced, &answer.x)
    }

    /// A root without a bound below: unbounded if there is any feasible point.
    fn settle_descent(&mut self, node: Node) {
        let mut flat = self.task.program.clone();
        flat.make_feasibility_problem();
        let options = self.task.options.clone().with_threads(1);
        let task = Task { program: &flat, options: &options, ..self.task };
        let mut control = Control::default().with_interrupt(self.tree.interrupt());
        let Found { termination, incumbent, statistics, .. } = search(task, &mut control);
        self.tree.count(|s| {
            s.nodes += statistics.nodes;
            s.relaxations += statistics.relaxations;
            s.iterations += statistics.iterations;
        });
        match (termination, incumbent) {
            (Termination::Infeasible, _) => {}
            (_, Some(point)) => {
                let value = self.program().objective(&point);
                self.tree.offer(value, point);
                self.tree.stop(Termination::Unbounded);
            }
            (reason, None) if reason.is_limit() => self.tree.give_back(self.id, node, reason),
            _ => self.tree.stall(f64::NEG_INFINITY),
        }
    }

    fn look_for_points(&mut self, point: &[f64], at_root: bool) {
        let integrality = self.task.options.integrality;
        let whole = |j: &usize| (point[*j] - point[*j].round()).abs() <= integrality;
        if self.program().integers.iter().all(whole) {
            self.try_assignment(point);
        }
        let pause = if self.tree.cutoff() == f64::INFINITY { 5 } else { 50 };
        if at_root || self.since_rounding >= pause {
            self.since_rounding = 0;
            self.round_and_propagate(point);
        }
        self.since_rounding += 1;
    }

    pub(super) fn is_leaf(&self) -> bool {
        self.program().integers.iter().all(|&j| self.domain.is_fixed(j))
    }

    pub(super) fn program(&self) -> &'a Program {
        self.task.program
    }

    /// Propagates what changed since a mark.
    pub(super) fn propagate_since(&mut self, mark: usize) -> Result<(), Conflict> {
        self.propagator.propagate_since(self.task.program, &mut self.domain, mark)
    }
}
