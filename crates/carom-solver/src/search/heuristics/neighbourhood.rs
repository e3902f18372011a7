//! Relaxation-induced neighbourhood search: a small search near the best point.
//!
//! Integers on which the best point and a relaxed point agree are fixed (Danna, Rothberg and Le
//! Pape 2005). The rest is searched for a better point with few nodes. Nested searches do not nest
//! further.

use super::allowance::Allowance;
use super::parameters::HEURISTICS;
use crate::program::Program;
use crate::search::context::Context;
use crate::search::found::SearchResult;
use crate::search::task::SolveTask;
use crate::search::trace::span;
use crate::solution::Heuristic;

/// Searches near the best point if an allowance has room for it.
///
/// # Arguments
///
/// * `nodes`: that this worker has processed.
/// * `point`, `bound`: the relaxed point of the current node, and its bound.
pub(super) fn search_near_incumbent(
    ctx: &mut Context<'_>,
    spent: &mut Allowance,
    nodes: u64,
    point: &[f64],
    bound: f64,
) {
    let (left, cutoff, base) =
        (spent.left(ctx.iterations, false), ctx.tree.cutoff(), ctx.program());
    if left < HEURISTICS.neighbourhood_iterations || bound == f64::NEG_INFINITY || bound >= cutoff {
        return;
    }
    let Some((value, best)) = ctx.tree.incumbent() else { return };
    if base.is_feasibility_problem() {
        return;
    }
    let wanted = cutoff.min(value - HEURISTICS.gap_share * (value - bound).max(0.0));
    let Some(program) = agreement(base, point, &best) else { return };
    span!(DEBUG, "heuristic", name = "neighbourhood");
    let source = ctx.tree.begin(Heuristic::Neighbourhood);
    let taken = search_within(ctx, &program, wanted, left, nodes);
    ctx.tree.end(source);
    spent.book(taken, ctx.tree.cutoff() < cutoff);
}

/// Searches a part of the program for a point below `cutoff`, with about so many iterations, and
/// offers it. Returns the iterations that it took.
///
/// # Arguments
///
/// * `nodes`: that this worker has processed, for the mean cost of a node.
pub(super) fn search_within(
    ctx: &mut Context<'_>,
    program: &Program,
    cutoff: f64,
    iterations: u64,
    nodes: u64,
) -> u64 {
    let a_node = (ctx.iterations / nodes.max(1)).max(1);
    let mut options = ctx.options().nested();
    options.node_limit = Some(
        (iterations / a_node)
            .clamp(HEURISTICS.neighbourhood_nodes[0], HEURISTICS.neighbourhood_nodes[1]),
    );
    options.memory_limit = ctx.tree.memory_left();
    let task = SolveTask { program, root: None, options: &options, cutoff, ..*ctx.task() };
    let activity = ctx.clock.pause();
    let SearchResult { points, statistics, .. } = (ctx.tree.tree.nested)(task);
    ctx.clock.resume(activity);
    ctx.iterations += statistics.iterations;
    ctx.tree.count(|s| s.add_nested(&statistics));
    if let Some(found) = points.into_iter().next() {
        let value = ctx.task().value(&found);
        if value < ctx.tree.cutoff() {
            ctx.tree.offer(value, found);
        }
    }
    statistics.iterations
}

/// The program with the integers fixed on which both points agree; `None` if these are too few, or
/// all.
fn agreement(base: &Program, point: &[f64], best: &[f64]) -> Option<Program> {
    let open = |&&j: &&usize| base.lower[j] < base.upper[j];
    let agree = |&j: &usize| (point[j] - best[j]).abs() <= HEURISTICS.agreement;
    let open: Vec<usize> = base.integers.iter().filter(open).copied().collect();
    let fixed: Vec<usize> = open.iter().copied().filter(agree).collect();
    let enough = fixed.len() as f64 >= HEURISTICS.fixed_share * open.len() as f64;
    if fixed.is_empty() || fixed.len() == open.len() || !enough {
        return None;
    }
    let mut program = base.clone();
    for j in fixed {
        (program.lower[j], program.upper[j]) = (best[j].round(), best[j].round());
    }
    Some(program)
}
