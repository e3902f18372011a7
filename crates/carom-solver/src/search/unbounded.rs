//! A root whose relaxation is unbounded.

use super::context::Context;
use super::found::SearchResult;
use super::node::Node;
use super::task::SolveTask;
use crate::solution::Termination;
use crate::solver::BranchingRule;

/// Decides a root without a bound below: the program is unbounded if it has any feasible point.
pub(super) fn settle_descent(ctx: &mut Context<'_>, node: Node) {
    let mut flat = ctx.program().clone();
    flat.make_feasibility_problem();
    let mut options = ctx.options().nested();
    options.branching = BranchingRule::LatestFirst;
    let (program, cutoff) = (&flat, f64::INFINITY);
    let (exact, options) = (None, &options);
    let task = SolveTask { program, exact, root: None, options, cutoff, ..*ctx.task() };
    let SearchResult { termination, points, statistics, .. } = (ctx.tree.tree.nested)(task);
    let incumbent = points.into_iter().next();
    ctx.clock.restart();
    ctx.tree.count(|s| s.add(&statistics));
    match (termination, incumbent) {
        (Termination::Infeasible, _) => {}
        (_, Some(point)) => {
            let value = ctx.program().objective(&point);
            ctx.tree.offer(value, point);
            ctx.tree.stop(Termination::Unbounded);
        }
        (reason, None) if reason.is_limit() => ctx.tree.give_back(node, reason),
        _ => ctx.tree.stall(f64::NEG_INFINITY),
    }
}
