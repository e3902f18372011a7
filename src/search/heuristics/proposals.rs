//! Points that the user proposes at a node.

use super::rounding::round_and_propagate;
use crate::search::context::Context;
use crate::search::local_bounds::fix_to;
use crate::solution::Heuristic;

/// Tries the points that the user proposes at the current node. The domain is left as it was.
pub(super) fn try_proposals(ctx: &mut Context<'_>, x: &[f64], bound: f64) {
    for source in ctx.shared.task.guidance.proposals() {
        let before = ctx.tree.begin(Heuristic::Proposal);
        let proposed = ctx.show(x, bound, |node, _| {
            let columns = source.propose(node).into_iter();
            let known = columns.filter_map(|(v, value)| node.column(v).map(|j| (j, value)));
            known.collect::<Vec<_>>()
        });
        let mark = ctx.node.domain.mark();
        for (j, value) in ctx.shared.task.guidance.carried(proposed) {
            if ctx.program().integral[j] && value.is_finite() {
                fix_to(ctx, j, value);
            }
        }
        round_and_propagate(ctx, x);
        ctx.node.domain.undo_to(mark);
        ctx.tree.end(before);
    }
}
