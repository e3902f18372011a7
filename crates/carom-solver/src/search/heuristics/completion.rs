//! Points from the integers of a start: fixed, completed, and repaired if they contradict the
//! program.

use super::parameters::HEURISTICS;
use super::penalties::{forgo, pays, penalties};
use super::rounding::round_and_propagate;
use crate::relaxation::{Purpose, RelaxationVerdict};
use crate::search::context::Context;
use crate::search::leaf::solve_assignment;
use crate::search::local_bounds::{fix_near, fix_to};
use crate::search::node_relaxation::{project_node, relax};
use crate::search::start::Completion;
use crate::search::trace::span;
use crate::solution::Heuristic;

/// Looks for a point with the integers of the start, or with any if it has none. The domain is left
/// as it was.
pub(in crate::search) fn complete_start(ctx: &mut Context<'_>) {
    let Some(start) = ctx.tree.start() else { return };
    span!(DEBUG, "heuristic", name = "start");
    let before = ctx.tree.begin(Heuristic::Start);
    let mut contradiction = None;
    let mut found = None;
    let is_quick = start.saved_tree.is_some() && !ctx.options().may_stop();
    let mut left =
        if is_quick { HEURISTICS.prepared_relaxations } else { HEURISTICS.completion_relaxations };
    for share in HEURISTICS.start_shares {
        let kept = (share * start.integers.len() as f64).ceil() as usize;
        let mark = ctx.node.domain.mark();
        for &(j, value) in &start.integers[..kept] {
            if !fix_to(ctx, j, value) {
                contradiction.get_or_insert(j);
            }
        }
        ctx.tree.take_last_found();
        complete(ctx, &mut left);
        ctx.node.domain.undo_to(mark);
        found = ctx.tree.take_last_found();
        if found.is_some() || left == 0 || kept == 0 || ctx.token.is_over() {
            break;
        }
    }
    if ctx.options().may_stop() {
        let better = complete_unsoftened(ctx, found.as_deref());
        found = better.or(found);
    }
    ctx.tree.end(before);
    ctx.tree.report_completion(match (found, contradiction) {
        (Some(point), _) => Completion::Point(point),
        _ if ctx.token.is_over() => Completion::Stopped,
        (None, Some(column)) => Completion::Contradiction(column),
        (None, None) => Completion::Nothing,
    });
}

/// Looks for a point that softens no row, if there is no point yet or one that softens rows.
fn complete_unsoftened(ctx: &mut Context<'_>, found: Option<&[f64]>) -> Option<Vec<f64>> {
    let penalties = penalties(ctx.program());
    let is_worse = found.is_none_or(|point| pays(ctx.program(), &penalties, point));
    if penalties.is_empty() || !is_worse || ctx.token.is_over() {
        return None;
    }
    let mark = ctx.node.domain.mark();
    if forgo(ctx, &penalties) {
        complete(ctx, &mut { HEURISTICS.completion_relaxations });
    }
    ctx.node.domain.undo_to(mark);
    ctx.tree.take_last_found()
}

/// Looks for a point of the present domain: rounds its relaxed point, and dives if that fails.
/// Solves at most `left` relaxations, and counts them off.
fn complete(ctx: &mut Context<'_>, left: &mut usize) {
    while *left > 0 {
        *left -= 1;
        if ctx.is_leaf() {
            let mark = ctx.node.domain.mark();
            solve_assignment(ctx, mark);
            return;
        }
        let Some(mut projection) = project_node(ctx) else { return };
        let verdict = relax(ctx, &mut projection.reduced, Purpose::Node);
        let point = match &verdict {
            RelaxationVerdict::Relaxed { x, .. } => Some(projection.lift(x)),
            _ => None,
        };
        ctx.cascade.reuse(verdict);
        ctx.cascade.reducer().reuse_projection(projection);
        let Some(point) = point else { return };
        round_and_propagate(ctx, &point);
        if ctx.tree.has_last_found() {
            return;
        }
        let distance = |j: usize| (point[j] - point[j].round()).abs();
        let open = |&&j: &&usize| !ctx.node.domain.is_fixed(j);
        let mut order: Vec<usize> = ctx.program().integers.iter().filter(open).copied().collect();
        order.sort_by(|&a, &b| distance(a).total_cmp(&distance(b)).then(a.cmp(&b)));
        let sure = order.iter().take_while(|&&j| distance(j) <= 1e-3).count();
        for &j in order.iter().take(sure.max(1)) {
            if !fix_near(ctx, j, point[j]) {
                return;
            }
        }
    }
}
