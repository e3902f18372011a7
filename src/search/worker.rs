//! Processing nodes: propagate, reduce, relax, bound, branch.

use super::Task;
use super::branching::{Pseudocosts, Split};
use super::node::{Decision, Node};
use super::node_relaxation::Verdict;
use super::probing::Probing;
use super::purify::purify;
use super::reporter::Reporter;
use super::root::{Root, late_first};
use super::tree::Tree;
use crate::presolve::{Conflict, Domain, Propagator};
use crate::program::Program;
use crate::relaxation::{ClarabelRelaxation, InteriorPoint};
use crate::solution::Termination;
use crate::solver::Control;

/// One thread of the search, with its own domain and propagation.
pub(super) struct Worker<'a> {
    pub(super) task: Task<'a>,
    pub(super) tree: &'a Tree<'a>,
    pub(super) id: usize,
    pub(super) domain: Domain,
    pub(super) propagator: Propagator,
    pub(super) covers: &'a [Vec<usize>],
    groups: &'a [Vec<usize>],
    pub(super) late_first: Vec<usize>,
    pub(super) relaxation: ClarabelRelaxation,
    pub(super) interior: InteriorPoint,
    pub(super) pseudocosts: Pseudocosts,
    /// The decisions that the domain currently reflects.
    pub(super) path: Vec<Decision>,
    /// Trail position after root propagation.
    pub(super) root: usize,
    pub(super) root_conflict: Option<Conflict>,
    /// The cutoff that propagation uses at the current node.
    pub(super) cutoff: f64,
    /// Nodes since the rounding heuristic last ran.
    pub(super) since_rounding: u64,
    /// Whether a child is on trial, so that a rough answer will do.
    pub(super) on_trial: bool,
    pub(super) probing: Probing,
    /// Whether the root, probed before the search, has been processed.
    pub(super) root_done: bool,
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
            interior: InteriorPoint::new(),
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
}
