//! The round-and-propagate heuristic.
//!
//! Integers are fixed one after the other, the most certain first, each to its rounded relaxation
//! value, with propagation in between. If a value is infeasible, the other side is tried once. The
//! result is solved as a leaf.

use crate::search::context::Context;
use crate::search::leaf::solve_assignment;
use crate::search::local_bounds::fix_near;

/// Tries to turn a relaxed point into a feasible one. Returns whether it did. The domain is left as
/// it was.
pub(super) fn round_and_propagate(ctx: &mut Context<'_>, point: &[f64]) -> bool {
    let mark = ctx.node.domain.mark();
    let mut order: Vec<usize> = ctx.own_integers().to_vec();
    let distance = |j: usize| (point[j] - point[j].round()).abs();
    order.sort_by(|&a, &b| distance(a).total_cmp(&distance(b)).then(a.cmp(&b)));
    let complete = order.into_iter().all(|j| fix_near(ctx, j, point[j]) && !ctx.is_late());
    let end = ctx.node.domain.mark();
    let found = complete && solve_assignment(ctx, end);
    ctx.node.domain.undo_to(mark);
    found
}
