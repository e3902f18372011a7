//! The children of a node.

use super::branching::{Branching, Child, RelaxedPoint, Split, choose_split};
use super::close_node::{closed_bound, keep_closed, opposite};
use super::context::Context;
use super::node::{Decision, Node};
use super::saved_tree::SavedSplit;

/// Splits a node. Returns the child to visit first, and leaves the others to the tree.
pub(super) fn branch(
    ctx: &mut Context<'_>,
    branching: &mut Branching,
    node: &Node,
    relaxed: RelaxedPoint<'_>,
) -> Option<Node> {
    let RelaxedPoint { x, bound, .. } = relaxed;
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
    // What trials have closed is one child more.
    let share = node.share / (children.len() + usize::from(closed)).max(1) as f64;
    let node_of = |child: Child| {
        let moved = |last: &Decision| (x[last.column] - last.value).abs();
        let fraction = child.decisions.last().map_or(0.0, moved);
        let path = ctx.tree.path_with(&path, &child.decisions);
        let warm = ctx.node.warm.clone();
        let own = child.multipliers.filter(|_| child.bound >= bound);
        let multipliers = own.or_else(|| ctx.node.multipliers.clone());
        let (bound, known, id) = (child.bound.max(bound), child.known, ctx.tree.new_id());
        Node { path, bound, share, fraction, known, warm, serial: 0, id, multipliers }
    };
    let shape: Option<Vec<Decision>> = chain_of(&children);
    let nodes: Vec<Node> = children.into_iter().map(node_of).collect();
    ctx.tree.keep_split(|| {
        let mut split =
            SavedSplit { id: node.id, closed: ctx.node.closed.clone(), ..SavedSplit::default() };
        let Some(chain) = &shape else { return split };
        let ids = nodes.iter().map(|node| node.id);
        split.chain = chain.iter().copied().zip(ids).collect();
        split.rest = nodes.get(chain.len()).map(|node| node.id);
        split
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

/// The decisions of children each of which also excludes the decisions of those before it; `None`
/// if the children are not such a chain. The last child may do no more than exclude the others.
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
