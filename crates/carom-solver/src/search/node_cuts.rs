//! Cuts that are found at nodes, and hold at all of them.
//!
//! Takes the relaxed point of a node; leaves cuts of rows within the bounds of the root, which all
//! whole points of the program satisfy (Padberg and Rinaldi, A branch-and-cut algorithm for the
//! resolution of large-scale symmetric traveling salesman problems, SIAM Review 33, 1991). A worker
//! appends its cuts to each relaxation that follows. Separating takes longer than many a
//! relaxation, so nodes that are cut become rare where cuts lift few bounds.

use super::context::Context;
use super::cuts::{MOST_ROWS, mixed_integer_rounding_cuts, select_deepest};
use super::node_cut_pool::is_wrong;
use super::node_relaxation::relax;
use crate::presolve::Projection;
use crate::relaxation::{Purpose, RelaxationVerdict};

/// Most rounds of cuts at a node, and most cuts of a round.
const MOST_NODE_ROUNDS: usize = 4;
const MOST_NODE_CUTS: usize = 30;

/// The least part of the gap to the cutoff that a round closes if another one follows.
const FOLLOWED_SHARE: f64 = 0.05;

/// The gap that is assumed where there is no cutoff, relative to the bound.
const SLIGHT_GAP: f64 = 1e-3;

/// Relaxes a projected program with the cuts of the worker, and looks for more of them if it is
/// time.
pub(super) fn relax_with_cuts(
    ctx: &mut Context<'_>,
    projection: &mut Projection,
    purpose: Purpose,
) -> RelaxationVerdict {
    if !ctx.node_cuts.is_on || ctx.tree.keeps_duals() || ctx.is_leaf() {
        return relax(ctx, &mut projection.reduced, purpose);
    }
    let rows = ctx.program().row_count();
    ctx.node_cuts.append_to(&mut projection.reduced, &ctx.node.domain, rows);
    let mut verdict = relax(ctx, &mut projection.reduced, purpose);
    if purpose == Purpose::Node && ctx.node_cuts.is_due() {
        verdict = cut_node(ctx, projection, verdict);
    }
    if let RelaxationVerdict::Relaxed { y, .. } = &verdict {
        ctx.node_cuts.note(&projection.reduced, y, rows);
    }
    verdict
}

/// Cuts off the relaxed point of a node while that lifts its bound.
fn cut_node(
    ctx: &mut Context<'_>,
    projection: &mut Projection,
    mut verdict: RelaxationVerdict,
) -> RelaxationVerdict {
    let rows = ctx.program().row_count();
    let parent = ctx.node.warm.clone();
    let mut closed = 0.0;
    for _ in 0..MOST_NODE_ROUNDS {
        let RelaxationVerdict::Relaxed { bound, x, warm, converged: true, .. } = &verdict else {
            break;
        };
        let (bound, gap) = (*bound, ctx.tree.cutoff() - *bound);
        if gap <= 0.0 || bound == f64::NEG_INFINITY || ctx.token.is_over() {
            break;
        }
        let point = projection.lift(x);
        let (program, root) = (ctx.program(), ctx.root());
        let found =
            mixed_integer_rounding_cuts(program, &root.domain, &point, MOST_ROWS, &ctx.token);
        let found = select_deepest(found, MOST_NODE_CUTS, &point);
        if found.is_empty() {
            break;
        }
        // Points may come from other workers and from searches inside this one.
        if let Some((_, best)) = ctx.tree.incumbent()
            && (ctx.node_cuts.exclude(&best) || found.iter().any(|cut| is_wrong(cut, &best)))
        {
            ctx.tree.note_wrong_cut(&best);
            ctx.node_cuts.is_on = false;
            break;
        }
        if warm.is_some() {
            ctx.node.warm = warm.clone();
        }
        let place = projection.reduced.places();
        for cut in found {
            ctx.node_cuts.add(cut, &mut projection.reduced, &place, &ctx.node.domain, rows);
        }
        let mut next = relax(ctx, &mut projection.reduced, Purpose::Node);
        let share = match &mut next {
            RelaxationVerdict::Relaxed { bound: lifted, converged: true, .. } => {
                // What was proved before still holds.
                *lifted = lifted.max(bound);
                let all = if gap.is_finite() { gap } else { SLIGHT_GAP * bound.abs().max(1e-6) };
                (*lifted - bound) / all
            }
            RelaxationVerdict::Refuted(_) => 1.0,
            _ => break,
        };
        ctx.cascade.reuse(std::mem::replace(&mut verdict, next));
        closed += share * (1.0 - f64::min(closed, 1.0));
        if share < FOLLOWED_SHARE {
            break;
        }
    }
    ctx.node.warm = parent;
    ctx.node_cuts.book(closed);
    verdict
}
