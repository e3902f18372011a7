//! Processing nodes: propagate, reduce, relax, bound, branch.

use super::Task;
use super::branching::{Child, Split};
use super::clock::Clock;
use super::descend::Stop;
use super::desk::Desk;
use super::heuristics::Accounts;
use super::node::{Decision, Node, Path};
use super::node_relaxation::Verdict;
use super::probing::Probing;
use super::pseudocosts::Pseudocosts;
use super::purify::{Group, purify, settle};
use super::root::{Root, late_first};
use super::seed::{Seeded, divide};
use super::trace::span;
use super::windows::Windows;
use crate::presolve::{Conflict, Domain, Propagator, Reducer};
use crate::program::Program;
use crate::relaxation::{ClarabelRelaxation, InteriorPoint};
use crate::solution::{Heuristic, Termination};
use crate::solver::StopToken;

/// One thread of the search, with its own domain and propagation.
pub(super) struct Worker<'a> {
    pub(super) task: Task<'a>,
    pub(super) tree: Desk<'a>,
    pub(super) clock: Clock,
    pub(super) domain: Domain,
    pub(super) propagator: Propagator,
    pub(super) covers: &'a [Vec<usize>],
    pub(super) groups: &'a [Group],
    /// Binaries without a cost that are in no group.
    pub(super) lone: &'a [usize],
    pub(super) late_first: Vec<usize>,
    pub(super) reducer: Reducer,
    pub(super) relaxation: ClarabelRelaxation,
    pub(super) interior: InteriorPoint,
    pub(super) pseudocosts: Pseudocosts,
    /// The decisions that the domain currently reflects.
    pub(super) path: Vec<Decision>,
    /// The nodes on that path which the search went down from.
    pub(super) stops: Vec<Stop>,
    /// A buffer for the decisions of the node that is entered.
    route: Vec<Decision>,
    /// Trail position after root propagation.
    pub(super) root: usize,
    pub(super) root_conflict: Option<Conflict>,
    /// The cutoff that propagation uses at the current node.
    pub(super) cutoff: f64,
    pub(super) accounts: Accounts,
    /// Whether a child is on trial, so that a rough answer will do.
    pub(super) on_trial: bool,
    pub(super) probing: Probing,
    /// Whether the root, probed before the search, has been processed.
    pub(super) root_done: bool,
    pub(super) token: StopToken,
}

impl<'a> Worker<'a> {
    pub(super) fn new(task: Task<'a>, tree: Desk<'a>, root: &'a Root) -> Self {
        let domain = root.domain.clone();
        let mut propagator = root.propagator.clone();
        if task.options.conflicts {
            propagator.learn_conflicts(&domain);
        }
        Worker {
            task,
            tree,
            clock: Clock::new(),
            root: domain.mark(),
            domain,
            propagator,
            covers: &root.covers,
            groups: &root.groups,
            lone: &root.lone,
            // Windows are not probed: their binaries are.
            late_first: late_first(task.windows.map_or(task.program, Windows::base)),
            reducer: Reducer::default(),
            relaxation: ClarabelRelaxation::new(),
            interior: InteriorPoint::new(),
            pseudocosts: Pseudocosts::new(task.program.column_count()),
            path: Vec::new(),
            stops: Vec::new(),
            route: Vec::new(),
            root_conflict: root.conflict,
            cutoff: f64::INFINITY,
            accounts: Accounts::new(),
            on_trial: false,
            probing: Probing::new(task.program.column_count()),
            root_done: false,
            token: task.token.clone(),
        }
    }

    /// Nothing that happened since this worker last did anything is its own time.
    pub(super) fn restart_clock(&mut self) {
        self.clock.restart();
    }

    /// Processes a node; returns the child to plunge into.
    pub(super) fn process(&mut self, node: Node) -> Option<Node> {
        span!(DEBUG, "node", depth = node.path.len(), bound = node.bound);
        let depth = node.path.len() as u64;
        self.accounts.nodes += 1;
        let next = self.conclude(node);
        let times = self.clock.take();
        let conflicts = self.propagator.take_conflict_counts();
        self.tree.count(|s| {
            s.conflicts += conflicts.learned;
            s.fixed_by_no_goods += conflicts.fixed;
            s.refuted_by_no_goods += conflicts.refuted;
            s.nodes += 1;
            s.depth = s.depth.max(depth);
            s.times.add(&times);
        });
        next
    }

    fn conclude(&mut self, mut node: Node) -> Option<Node> {
        let at_root = node.path.is_empty();
        let mut route = std::mem::take(&mut self.route);
        node.path.write_to(&mut route);
        let entered = self.root_conflict.is_none() && self.enter(&route).is_ok();
        self.route = route;
        if entered && at_root {
            self.try_guess();
        }
        if !entered {
            self.tree.count(|s| s.refuted_by_propagation += 1);
            self.close_refuted(&node.path);
            return None;
        }
        let known = node.known.take().filter(|k| !self.is_leaf() && self.may_reuse(k, node.bound));
        let (bound, mut point) = match known {
            Some(known) => (node.bound, known.point),
            None => self.relax_node(&node)?,
        };
        if bound >= self.tree.cutoff() {
            return self.cut_off(&node.path, bound);
        }
        let integrality = self.task.options.integrality;
        purify(self.task.program, &self.domain, self.groups, integrality, &mut point);
        self.look_for_points(&point, bound, at_root);
        if bound >= self.tree.cutoff() {
            return self.cut_off(&node.path, bound);
        }
        let raw = point.clone();
        settle(self.task.program, &self.domain, self.lone, integrality, &mut point);
        self.look_for_settled_point(&raw, &point);
        if bound >= self.tree.cutoff() {
            return self.cut_off(&node.path, bound);
        }
        self.branch(node, bound, &point, &raw)
    }

    /// Solves the relaxation of a node: its bound and its point, or nothing when the node is done.
    fn relax_node(&mut self, node: &Node) -> Option<(f64, Vec<f64>)> {
        let Some(projection) = self.project_node() else {
            self.tree.count(|s| s.refuted_by_propagation += 1);
            self.close_refuted(&node.path);
            return None;
        };
        let reduced = &projection.reduced;
        let (bound, x, y) = match self.relax(reduced, node.path.is_empty()) {
            Verdict::Refuted => {
                self.tree.count(|s| s.refuted_by_relaxation += 1);
                self.close_refuted(&node.path);
                return None;
            }
            Verdict::Stopped => {
                self.tree.count(|s| s.unfinished += 1);
                let reason = self.token.ended().unwrap_or(Termination::Interrupted);
                self.tree.give_back(node.clone(), reason);
                return None;
            }
            Verdict::Descent => {
                self.tree.count(|s| s.unfinished += 1);
                self.settle_descent(node.clone());
                return None;
            }
            Verdict::Relaxed { bound, x, y, .. } => {
                if let Some(last) = node.path.last() {
                    let gain = bound - node.bound;
                    self.pseudocosts.learn(last.column, !last.is_upper, gain, node.fraction);
                }
                (self.tree.strengthen(bound.min(self.cutoff)).max(node.bound), x, y)
            }
        };
        if bound >= self.tree.cutoff() {
            self.cut_off(&node.path, bound);
            return None;
        }
        if self.is_leaf() {
            // The relaxation of a leaf is the leaf.
            self.tree.count(|s| s.leaves += 1);
            let before = self.tree.begin(Heuristic::Leaf);
            if self.offer_leaf(reduced, &x) {
                self.tree.close(bound);
            } else {
                self.tree.stall(bound);
            }
            self.tree.end(before);
            self.tree.keep_leaf(&node.path, bound);
            return None;
        }
        let cutoff = self.tree.strengthen(self.tree.cutoff());
        if !self.fix_by_reduced_costs(reduced, &x, &y) {
            self.cut_off(&node.path, cutoff);
            return None;
        }
        Some((bound, self.complete_point(projection.lift(&x))))
    }

    /// A node whose bound is at the cutoff.
    fn cut_off(&mut self, path: &Path, bound: f64) -> Option<Node> {
        self.tree.count(|s| s.cut_off += 1);
        self.tree.close(bound);
        self.tree.keep_leaf(path, bound);
        None
    }

    /// A node without a feasible point below the cutoff in force.
    fn close_refuted(&self, path: &Path) {
        let mut bound = f64::INFINITY;
        if self.cutoff < f64::INFINITY {
            bound = self.tree.strengthen(self.cutoff);
            self.tree.close(bound);
        }
        self.tree.keep_leaf(path, bound);
    }

    /// The bound of what was closed at the current node by its trials or multipliers.
    fn closed_bound(&self) -> f64 {
        self.tree.strengthen(self.tree.cutoff().min(self.cutoff))
    }

    fn branch(&mut self, node: Node, bound: f64, point: &[f64], raw: &[f64]) -> Option<Node> {
        if node.path.is_empty() && bound > f64::NEG_INFINITY {
            let parts = self.parts_of_seed();
            let node_of = |decisions: Vec<Decision>| {
                let path = self.path_with(&node.path, &decisions);
                Node { path, bound, fraction: 0.0, known: None, serial: 0 }
            };
            let mut nodes = parts.into_iter().map(node_of);
            if let Some(first) = nodes.next() {
                self.tree.count(|s| s.split += 1);
                nodes.for_each(|node| self.tree.push(node));
                return Some(first);
            }
        }
        let Split { children, closed } = self.choose_split(point, raw, bound);
        let facts = self.path.get(node.path.len()..).unwrap_or_default();
        let path = self.path_with(&node.path, facts);
        if closed && self.closed_bound() < f64::INFINITY {
            self.tree.close(self.closed_bound());
        }
        let bounded = |d: &Decision| {
            self.domain.lower(d.column).is_finite() && self.domain.upper(d.column).is_finite()
        };
        // Without any bound, splitting an unbounded column would never end.
        let ends = bound > f64::NEG_INFINITY || children.len() < 2;
        if !ends && !children.iter().flat_map(|c| &c.decisions).all(bounded) {
            self.tree.count(|s| s.unfinished += 1);
            self.tree.stall(bound);
            self.tree.keep_leaf(&node.path, bound);
            return None;
        }
        self.tree.count(|s| s.split += 1);
        self.keep_closed(&node.path, facts, &children);
        let node_of = |child: Child| {
            let moved = |last: &Decision| (point[last.column] - last.value).abs();
            let fraction = child.decisions.last().map_or(0.0, moved);
            let (path, bound) = (self.path_with(&path, &child.decisions), child.bound.max(bound));
            Node { path, bound, fraction, known: child.known, serial: 0 }
        };
        let mut nodes = children.into_iter().map(node_of);
        let first = nodes.next();
        for mut node in nodes {
            node.known = node.known.filter(|_| self.tree.has_room());
            self.tree.push(node);
        }
        first
    }

    fn path_with(&self, path: &Path, decisions: &[Decision]) -> Path {
        let step = |path: Path, decision| path.then(decision, self.tree.steps());
        decisions.iter().fold(path.clone(), step)
    }

    /// Keeps the ends of the tree that a split's facts and trials closed, where they are wanted.
    fn keep_closed(&self, path: &Path, facts: &[Decision], children: &[Child]) {
        if !self.task.options.keep_leaves {
            return;
        }
        let bound = self.closed_bound();
        let Some(last) = children.last() else {
            self.tree.keep_leaf(path, bound);
            return;
        };
        let mut path = path.clone();
        for fact in facts {
            self.tree.keep_leaf(&self.path_with(&path, &[opposite(*fact)]), bound);
            path = self.path_with(&path, &[*fact]);
        }
        // What a split into both sides of a column leaves is nothing.
        let covers = children.len() == 2 && last.decisions.len() == 1;
        if let Some((last, before)) = last.decisions.split_last().filter(|_| !covers) {
            let neither: Vec<Decision> = before.iter().copied().chain([opposite(*last)]).collect();
            self.tree.keep_leaf(&self.path_with(&path, &neither), bound);
        }
    }

    /// The parts that a seed divides the root into, the most promising one first; nothing where
    /// that is the root itself.
    fn parts_of_seed(&self) -> Vec<Vec<Decision>> {
        let Some(seed) = self.tree.seed().filter(|seed| !seed.leaves.is_empty()) else {
            return Vec::new();
        };
        let mut parts = divide(self.task.program, &self.domain, &seed.leaves);
        let mut seeded = Seeded { used: vec![false; seed.leaves.len()], ..Seeded::default() };
        for part in &parts {
            match part.inside {
                Some(leaf) => (seeded.inside, seeded.used[leaf]) = (seeded.inside + 1, true),
                None => seeded.outside += 1,
            }
        }
        self.tree.report_seeded(seeded);
        if parts.len() < 2 {
            return Vec::new();
        }
        parts.sort_by(|a, b| a.order.total_cmp(&b.order));
        parts.into_iter().map(|part| part.path).collect()
    }

    pub(super) fn is_leaf(&self) -> bool {
        self.program().integers.iter().all(|&j| self.domain.is_fixed(j))
    }

    /// Whether a limit is reached, for loops: the clock is read once in a while.
    pub(super) fn is_late(&mut self) -> bool {
        self.token.spend(100)
    }

    pub(super) fn program(&self) -> &'a Program {
        self.task.program
    }
}

/// What a decision excludes.
fn opposite(decision: Decision) -> Decision {
    let value = decision.value + if decision.is_upper { 1.0 } else { -1.0 };
    Decision { is_upper: !decision.is_upper, value, ..decision }
}
