//! Closing nodes: bounds, leaves and proofs.

use super::branching::Child;
use super::context::Context;
use super::node::{Decision, Path};
use super::saved_tree::{End, SavedDuals};

/// Closes a node whose bound is at the cutoff.
pub(super) fn cut_off(ctx: &Context<'_>, path: &Path, bound: f64) {
    ctx.tree.count(|s| s.cut_off += 1);
    ctx.tree.close(bound);
    ctx.tree.keep_leaf(path, bound);
    keep_duals(ctx);
}

/// Keeps the multipliers that prove the bound of the current node.
pub(super) fn keep_duals(ctx: &Context<'_>) {
    if let Some(multipliers) = ctx.node.multipliers.clone() {
        ctx.tree.keep_duals(|| SavedDuals::new(End::Node(ctx.node.id), multipliers));
    }
}

/// Closes a node without a feasible point below the cutoff in force.
pub(super) fn close_refuted(ctx: &Context<'_>, path: &Path) {
    let mut bound = f64::INFINITY;
    if ctx.node.cutoff < f64::INFINITY {
        bound = ctx.tree.strengthen(ctx.node.cutoff);
        ctx.tree.close(bound);
    }
    ctx.tree.keep_leaf(path, bound);
    keep_duals(ctx);
}

/// The bound of the parts of the current node that its trials or multipliers have closed.
pub(super) fn closed_bound(ctx: &Context<'_>) -> f64 {
    ctx.tree.strengthen(ctx.tree.cutoff().min(ctx.node.cutoff))
}

/// If leaves are asked for, keeps those that the facts and trials of a split have closed.
pub(super) fn keep_closed(ctx: &Context<'_>, path: &Path, facts: &[Decision], children: &[Child]) {
    if !ctx.options().parts().keep_leaves {
        return;
    }
    let bound = closed_bound(ctx);
    let Some(last) = children.last() else {
        ctx.tree.keep_leaf(path, bound);
        return;
    };
    let mut path = path.clone();
    for fact in facts {
        ctx.tree.keep_leaf(&ctx.tree.path_with(&path, &[opposite(*fact)]), bound);
        path = ctx.tree.path_with(&path, &[*fact]);
    }
    // A split into both sides of a single column covers the whole node.
    let covers = children.len() == 2 && last.decisions.len() == 1;
    if let Some((last, before)) = last.decisions.split_last().filter(|_| !covers) {
        let neither: Vec<Decision> = before.iter().copied().chain([opposite(*last)]).collect();
        ctx.tree.keep_leaf(&ctx.tree.path_with(&path, &neither), bound);
    }
}

/// The decision that allows exactly the values that this one excludes.
pub(crate) fn opposite(decision: Decision) -> Decision {
    let value = decision.value + if decision.is_upper { 1.0 } else { -1.0 };
    Decision { is_upper: !decision.is_upper, value, ..decision }
}
