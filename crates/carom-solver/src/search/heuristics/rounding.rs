//! The round-and-propagate heuristic.
//!
//! Integers are fixed one after the other, the most certain first, each to its rounded relaxation
//! value, with propagation in between. If a value is infeasible, the other side is tried once. The
//! result is solved as a leaf.
//!
//! Without a relaxed point, integers are fixed at the ends of their ranges that cost less, the
//! dearest first.

use crate::search::context::Context;
use crate::search::leaf::solve_assignment;
use crate::search::local_bounds::fix_near;

/// Tries to turn a relaxed point into a feasible one. Returns whether it did. The domain is left as
/// it was.
pub(super) fn round_and_propagate(ctx: &mut Context<'_>, point: &[f64]) -> bool {
    let mut order: Vec<usize> = ctx.program().integers.to_vec();
    let distance = |j: usize| (point[j] - point[j].round()).abs();
    order.sort_by(|&a, &b| distance(a).total_cmp(&distance(b)).then(a.cmp(&b)));
    fix_in_order(ctx, &order, |_, j| point[j])
}

/// Tries the cheap ends of all integers. Returns whether that is feasible. The domain is left as it
/// was.
pub(super) fn fix_at_cheap_ends(ctx: &mut Context<'_>) -> bool {
    let mut order: Vec<usize> = ctx.program().integers.to_vec();
    let costs = &ctx.program().linear;
    order.sort_by(|&a, &b| costs[b].abs().total_cmp(&costs[a].abs()).then(a.cmp(&b)));
    fix_in_order(ctx, &order, |ctx, j| {
        let ends = ctx.node.domain.bounds(j);
        let [cheap, other] = if ctx.program().linear[j] < 0.0 { [ends[1], ends[0]] } else { ends };
        [cheap, other, 0.0].into_iter().find(|end| end.is_finite()).unwrap_or(0.0)
    })
}

/// Fixes integers near values one after the other, and solves the rest.
fn fix_in_order(
    ctx: &mut Context<'_>,
    order: &[usize],
    value: impl Fn(&Context<'_>, usize) -> f64,
) -> bool {
    let mark = ctx.node.domain.mark();
    let mut fix = |j: usize| {
        let value = value(ctx, j);
        fix_near(ctx, j, value) && !ctx.is_late()
    };
    let complete = order.iter().all(|&j| fix(j));
    let end = ctx.node.domain.mark();
    let found = complete && solve_assignment(ctx, end);
    ctx.node.domain.undo_to(mark);
    found
}
