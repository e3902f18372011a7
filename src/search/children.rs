//! The children of a node: those of a split, and the parts that a seed divides the root into.

use super::branching::{Branching, Child, RelaxedPoint, Split, choose_split};
use super::close_node::{closed_bound, keep_closed, opposite};
use super::context::Context;
use super::node::{Decision, Node};
use super::proofs::Fork;
use super::seed::{Seeded, divide};

/// Splits a node. Returns the child to visit first, and leaves the others to the tree.
pub(super) fn branch(
    ctx: &mut Context<'_>,
    branching: &mut Branching,
    node: &Node,
    relaxed: RelaxedPoint<'_>,
) -> Option<Node> {
    let RelaxedPoint { x, bound, .. } = relaxed;
    if node.path.is_empty() && bound > f64::NEG_INFINITY {
        let parts = parts_of_seed(ctx);
        if !parts.is_empty() {
            return divide_root(ctx, node, bound, parts);
        }
    }
    let Split { children, closed } = choose_split(ctx, branching, relaxed);
    if closed && closed_bound(ctx) < f64::INFINITY {
        ctx.tree.close(closed_bound(ctx));
    }
    let domain = &ctx.node.domain;
    let bounded = |d: &Decision| domain.bounds(d.column).iter().all(|bound| bound.is_finite());
    // Without any bound, splitting an unbounded column would never end.
    let ends = bound > f64::NEG_INFINITY || children.len() < 2;
    if !ends && !children.iter().flat_map(|c| &c.decisions).all(bounded) {
        ctx.tree.count(|s| s.unfinished += 1);
        ctx.tree.stall(bound);
        ctx.tree.keep_leaf(&node.path, bound);
        return None;
    }
    ctx.tree.count(|s| s.split += 1);
    let facts = ctx.node.path.get(node.path.len()..).unwrap_or_default();
    keep_closed(ctx, &node.path, facts, &children);
    let path = ctx.tree.path_with(&node.path, facts);
    let node_of = |child: Child| {
        let moved = |last: &Decision| (x[last.column] - last.value).abs();
        let fraction = child.decisions.last().map_or(0.0, moved);
        let path = ctx.tree.path_with(&path, &child.decisions);
        let warm = ctx.node.warm.clone();
        let own = child.multipliers.filter(|_| child.bound >= bound);
        let multipliers = own.or_else(|| ctx.node.multipliers.clone());
        let (bound, known, id) = (child.bound.max(bound), child.known, ctx.tree.new_id());
        Node { path, bound, fraction, known, warm, serial: 0, id, multipliers }
    };
    let shape: Option<Vec<Decision>> = chain_of(&children);
    let nodes: Vec<Node> = children.into_iter().map(node_of).collect();
    ctx.tree.keep_fork(|| {
        let mut fork = Fork { id: node.id, closed: ctx.node.closed.clone(), ..Fork::default() };
        let Some(chain) = &shape else { return fork };
        let ids = nodes.iter().map(|node| node.id);
        fork.chain = chain.iter().copied().zip(ids).collect();
        fork.rest = nodes.get(chain.len()).map(|node| node.id);
        fork
    });
    let mut nodes = nodes.into_iter();
    let first = nodes.next();
    for mut node in nodes {
        if !ctx.tree.has_room() {
            (node.known, node.warm, node.multipliers) = (None, None, None);
        }
        ctx.tree.push(node);
    }
    first
}

/// The decisions of children each of which is beyond those before it; the last may be the rest.
fn chain_of(children: &[Child]) -> Option<Vec<Decision>> {
    let mut chain: Vec<Decision> = Vec::new();
    for (k, child) in children.iter().enumerate() {
        let before = chain.iter().map(|&decision| opposite(decision));
        if child.decisions.iter().copied().eq(before.clone()) && k + 1 == children.len() {
            break;
        }
        let (last, own) = child.decisions.split_last()?;
        if !own.iter().copied().eq(before) {
            return None;
        }
        chain.push(*last);
    }
    Some(chain)
}

/// Divides the root into parts. Returns the first one, and leaves the others to the tree.
fn divide_root(
    ctx: &Context<'_>,
    root: &Node,
    bound: f64,
    parts: Vec<Vec<Decision>>,
) -> Option<Node> {
    let node_of = |decisions: Vec<Decision>| {
        let path = ctx.tree.path_with(&root.path, &decisions);
        Node { path, bound, warm: ctx.node.warm.clone(), ..Node::root() }
    };
    let mut nodes = parts.into_iter().map(node_of);
    let first = nodes.next();
    ctx.tree.count(|s| s.split += 1);
    nodes.for_each(|node| ctx.tree.push(node));
    first
}

/// The parts that a seed divides the root into, the most promising one first; empty if that is
/// the root itself.
fn parts_of_seed(ctx: &Context<'_>) -> Vec<Vec<Decision>> {
    let Some(seed) = ctx.tree.seed().filter(|seed| !seed.leaves.is_empty()) else {
        return Vec::new();
    };
    let mut parts = divide(ctx.program(), &ctx.node.domain, &seed.leaves);
    let mut seeded = Seeded { used: vec![false; seed.leaves.len()], ..Seeded::default() };
    for part in &parts {
        match part.inside {
            Some(leaf) => (seeded.inside, seeded.used[leaf]) = (seeded.inside + 1, true),
            None => seeded.outside += 1,
        }
    }
    ctx.tree.report_seeded(seeded);
    if parts.len() < 2 {
        return Vec::new();
    }
    parts.sort_by(|a, b| a.order.total_cmp(&b.order));
    parts.into_iter().map(|part| part.path).collect()
}
