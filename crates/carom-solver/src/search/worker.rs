//! Processing nodes: propagate, reduce, relax, look for points, branch.

use super::branching::{Branching, RelaxedPoint};
use super::children::branch;
use super::close_node::{close_refuted, cut_off, keep_duals};
use super::context::Context;
use super::heuristics::{HeuristicAccounts, look_for_points, look_for_settled_point};
use super::indifferent_binaries::{round_groups, shift_to_integers};
use super::leaf::offer_leaf;
use super::loosened_leaf::settle_loosened;
use super::node::{Decision, KnownRelaxation, Node};
use super::node_probing::NodeProbing;
use super::node_relaxation::{
    ExactRelaxation, bound_below_cutoff, project_reduced, reduce_node, relax_and_keep,
    relax_exactly,
};
use super::pseudocosts::Pseudocosts;
use super::reduced_cost::fix_by_reduced_costs;
use super::switch_node::switch_to;
use super::trace::span;
use super::tree_view::TreeView;
use super::tree_warm_start::warm_start_tree;
use super::unbounded::settle_descent;
use crate::presolve::{Projection, Reduced};
use crate::relaxation::{Purpose, RelaxationVerdict};
use crate::solution::{Heuristic, Termination};

/// A trial's bound that is this close to the cutoff, relative to the bound, may be too rough to
/// prune with (no unit).
const NEAR_CUTOFF: f64 = 1e-4;

/// By how much a trial's point may leave the domain that its child has come to (no unit).
const OUTSIDE_DOMAIN: f64 = 1e-6;

/// One thread of the search, with its own domain and propagation.
pub(super) struct Worker<'a> {
    context: Context<'a>,
    branching: Branching,
    heuristics: HeuristicAccounts,
    probing: NodeProbing,
    /// A buffer for the decisions of the node that is entered.
    route: Vec<Decision>,
}

impl<'a> Worker<'a> {
    pub(super) fn new(tree: TreeView<'a>) -> Self {
        let columns = tree.tree.task.program.column_count();
        Worker {
            context: Context::new(tree),
            branching: Branching::new(columns),
            heuristics: HeuristicAccounts::new(),
            probing: NodeProbing::new(columns),
            route: Vec::new(),
        }
    }

    /// Ends the work.
    pub(super) fn retire(self) {
        self.context.retire();
    }

    /// This worker's view of the tree.
    pub(super) fn tree(&self) -> &TreeView<'a> {
        &self.context.tree
    }

    /// This worker's pseudocosts.
    pub(super) fn pseudocosts(&mut self) -> &mut Pseudocosts {
        &mut self.branching.pseudocosts
    }

    /// Restarts the clock: the time since this worker was last active does not count as its own.
    pub(super) fn restart_clock(&mut self) {
        self.context.clock.restart();
    }

    /// Processes a node. Returns the child to plunge into.
    pub(super) fn process(&mut self, node: Node) -> Option<Node> {
        span!(DEBUG, "node", depth = node.path.len(), bound = node.bound);
        let depth = node.path.len() as u64;
        self.heuristics.count_node();
        let next = self.conclude(node);
        let times = self.context.clock.take();
        self.context.tree.count(|s| {
            s.nodes += 1;
            s.depth = s.depth.max(depth);
            s.times.add(&times);
        });
        next
    }

    fn conclude(&mut self, mut node: Node) -> Option<Node> {
        let at_root = node.path.is_empty();
        self.focus(&mut node);
        if !self.enter(&node) {
            let ctx = &mut self.context;
            ctx.tree.count(|s| s.refuted_by_propagation += 1);
            close_refuted(ctx, &node.path);
            return None;
        }
        let ctx = &mut self.context;
        let known = node.known.take().filter(|k| !ctx.is_leaf() && may_reuse(ctx, k, node.bound));
        let (mut bound, mut x) = match known {
            Some(known) => (node.bound, known.point),
            None => relax_node(ctx, &mut self.branching.pseudocosts, &node)?,
        };
        let is_cut_off = |ctx: &Context<'_>, bound: f64| {
            let beyond = bound >= ctx.tree.cutoff();
            if beyond {
                cut_off(ctx, &node.path, bound);
            }
            beyond
        };
        if is_cut_off(ctx, bound) {
            return None;
        }
        let (program, root, options) = (ctx.program(), ctx.root(), ctx.options());
        round_groups(program, &ctx.node.domain, &root.groups, options.integrality, &mut x);
        let pseudocosts = &self.branching.pseudocosts;
        look_for_points(ctx, &mut self.heuristics, pseudocosts, &x, bound, at_root);
        if is_cut_off(ctx, bound) {
            return None;
        }
        let mut raw = x.clone();
        shift_to_integers(program, &ctx.node.domain, &root.ungrouped, options.integrality, &mut x);
        look_for_settled_point(ctx, &raw, &x);
        if is_cut_off(ctx, bound) {
            return None;
        }
        if ctx.is_integral(&raw)
            && let Some(exact) = relax_exactly(ctx)
        {
            let ExactRelaxation { bound: proved, point } = exact;
            bound = bound.max(proved);
            if is_cut_off(ctx, bound) {
                return None;
            }
            if let Some(point) = point {
                (raw, x) = (point.clone(), point);
                look_for_settled_point(ctx, &[], &x);
                if is_cut_off(ctx, bound) {
                    return None;
                }
            }
        }
        if ctx.is_in_pool(&x, bound) {
            cut_off(ctx, &node.path, bound);
            return None;
        }
        if let Some(reason) = ctx.token.ended() {
            // Splitting a node takes as long as relaxing it.
            give_back(ctx, Node { bound, ..node }, reason);
            return None;
        }
        if at_root
            && bound > f64::NEG_INFINITY
            && let Some(parts) = warm_start_tree(ctx, &node, bound, &x)
        {
            self.heuristics.note_tree_warm_start(ctx, bound);
            let mut parts = parts.into_iter();
            let first = parts.next();
            parts.for_each(|part| ctx.tree.push(part));
            return first;
        }
        if ctx.is_integral(&raw) {
            ctx.tree.count(|s| s.whole_splits += 1);
        }
        let relaxed = RelaxedPoint { x: &x, raw: &raw, bound };
        branch(ctx, &mut self.branching, &node, relaxed)
    }

    /// Makes a node the focus node. Its relaxation starts from the state of its trial, or else from
    /// that of its parent.
    fn focus(&mut self, node: &mut Node) {
        let own = node.known.as_mut().and_then(|known| known.warm.take());
        let parent = || node.warm.clone().or_else(|| self.context.tree.root_state());
        self.context.node.warm = own.or_else(parent);
        self.context.node.id = node.id;
        self.context.node.closed.clear();
        self.context.node.multipliers = node.multipliers.clone();
    }

    /// Brings the domain to a node. Returns `false` if propagation refutes the node.
    fn enter(&mut self, node: &Node) -> bool {
        node.path.write_to(&mut self.route);
        self.context.root().conflict.is_none()
            && switch_to(&mut self.context, &mut self.probing, &self.route).is_ok()
    }
}

/// Leaves a node unfinished.
fn give_back(ctx: &Context<'_>, node: Node, reason: Termination) {
    ctx.tree.count(|s| s.unfinished += 1);
    ctx.tree.give_back(node, reason);
}

/// Whether a trial's point is good enough to be the relaxed point of the node of the domain.
pub(super) fn may_reuse(ctx: &Context<'_>, known: &KnownRelaxation, bound: f64) -> bool {
    let near = ctx.tree.cutoff() - bound <= NEAR_CUTOFF * bound.abs().max(1.0);
    let inside = || {
        known.point.iter().enumerate().all(|(j, &v)| {
            let [lower, upper] = ctx.node.domain.bounds(j);
            let slack = OUTSIDE_DOMAIN * v.abs().max(1.0);
            v >= lower - slack && v <= upper + slack
        })
    };
    !near && inside()
}

/// Solves the relaxation of a node. Returns its bound and its point, or `None` if the node is done.
fn relax_node(
    ctx: &mut Context<'_>,
    pseudocosts: &mut Pseudocosts,
    node: &Node,
) -> Option<(f64, Vec<f64>)> {
    let Some(reduced) = reduce_node(ctx) else {
        ctx.tree.count(|s| s.refuted_by_propagation += 1);
        close_refuted(ctx, &node.path);
        return None;
    };
    let mut projection = project_reduced(ctx, reduced);
    let purpose = if node.path.is_empty() { Purpose::Root } else { Purpose::Node };
    let (mut verdict, multipliers) = relax_and_keep(ctx, &mut projection, purpose);
    ctx.node.multipliers = multipliers.or(ctx.node.multipliers.take());
    if node.id == 0 {
        keep_duals(ctx);
    }
    let relaxed = conclude_from(ctx, pseudocosts, node, &projection, &mut verdict);
    ctx.cascade.reuse(verdict);
    ctx.cascade.reducer().reuse_projection(projection);
    relaxed
}

/// Acts on the verdict on a node. Returns its bound and its point, or `None` if the node is done.
fn conclude_from(
    ctx: &mut Context<'_>,
    pseudocosts: &mut Pseudocosts,
    node: &Node,
    projection: &Projection,
    verdict: &mut RelaxationVerdict,
) -> Option<(f64, Vec<f64>)> {
    let reduced = &projection.reduced;
    let (bound, x, y) = match verdict {
        RelaxationVerdict::Refuted(_) => {
            ctx.tree.count(|s| s.refuted_by_relaxation += 1);
            close_refuted(ctx, &node.path);
            return None;
        }
        RelaxationVerdict::Stopped => {
            let reason = ctx.token.ended().unwrap_or(Termination::Interrupted);
            give_back(ctx, node.clone(), reason);
            return None;
        }
        RelaxationVerdict::Relaxed { bound, converged: false, .. }
            if node.path.is_empty() && ctx.token.is_over() =>
        {
            // Nothing is to be expected of the point of a root that a limit has stopped.
            let bound = ctx.tree.strengthen(bound.min(ctx.node.cutoff)).max(node.bound);
            let reason = ctx.token.ended().unwrap_or(Termination::Interrupted);
            give_back(ctx, Node { bound, ..node.clone() }, reason);
            return None;
        }
        RelaxationVerdict::Descent => {
            ctx.tree.count(|s| s.unfinished += 1);
            settle_descent(ctx, node.clone());
            return None;
        }
        RelaxationVerdict::Relaxed { bound, x, y, warm, .. } => {
            if let Some(warm) = warm.as_ref().filter(|_| node.path.is_empty()) {
                ctx.tree.keep_root_state(warm);
            }
            ctx.node.warm = warm.take();
            if let Some(last) = node.path.last() {
                let gain = *bound - node.bound;
                pseudocosts.learn(last.column, !last.is_upper, gain, node.fraction);
            }
            (ctx.tree.strengthen(bound.min(ctx.node.cutoff)).max(node.bound), &*x, &*y)
        }
    };
    if bound >= ctx.tree.cutoff() {
        cut_off(ctx, &node.path, bound);
        return None;
    }
    if ctx.is_leaf() {
        close_leaf(ctx, node, bound, reduced, (x, y));
        return None;
    }
    let cutoff = ctx.tree.strengthen(ctx.tree.cutoff());
    if !fix_by_reduced_costs(ctx, reduced, x, y) {
        cut_off(ctx, &node.path, cutoff);
        return None;
    }
    Some((bound, projection.lift(x)))
}

/// Closes a node whose integers are all fixed, and offers the point of its relaxation.
fn close_leaf(
    ctx: &mut Context<'_>,
    node: &Node,
    bound: f64,
    reduced: &Reduced,
    (x, y): (&[f64], &[f64]),
) {
    ctx.tree.count(|s| s.leaves += 1);
    let before = ctx.tree.begin(Heuristic::Leaf);
    let (mut bound, mut is_settled) = (bound, offer_leaf(ctx, reduced, x, y));
    let has_cones = !reduced.cones.is_empty();
    if is_settled && bound < ctx.tree.cutoff() && has_cones {
        bound = bound.max(bound_below_cutoff(ctx));
    }
    // A log holds the multipliers of the program itself.
    if bound < ctx.tree.cutoff() && has_cones && ctx.options().proof_path().is_none() {
        let loosened = settle_loosened(ctx, x);
        bound = bound.max(loosened.bound);
        is_settled |= loosened.is_settled;
    }
    if is_settled {
        ctx.tree.close(bound);
    } else {
        ctx.tree.stall(bound);
    }
    ctx.tree.end(before);
    ctx.tree.keep_leaf(&node.path, bound);
}
