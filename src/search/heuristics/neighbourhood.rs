//! Small searches near the best point: relaxation-induced neighbourhoods, and local branching.
//!
//! Integers on which the best point and a relaxed point agree are fixed (Danna, Rothberg and Le
//! Pape 2005). Local branching instead adds a row that lets only few binaries differ from the best
//! point (Fischetti and Lodi 2003). The rest is searched for a better point with few nodes. Nested
//! searches do not nest further.

use super::allowance::Allowance;
use crate::program::Program;
use crate::search::context::Context;
use crate::search::found::Found;
use crate::search::task::Task;
use crate::search::trace::span;
use crate::solution::Heuristic;

/// Iterations that must be left for a search to begin.
const LEAST: u64 = 150;

/// Fewest and most nodes of a search.
const NODES: [u64; 2] = [10, 200];

/// Distance up to which the best point and the relaxed one agree on an integer (no unit).
const AGREE: f64 = 0.1;

/// Least share of the open integers that must be fixed.
const LEAST_FIXED: f64 = 0.4;

/// Share of the gap by which a new point must be better.
const GAIN: f64 = 0.02;

/// Share of the binaries that local branching lets differ, and fewest and most of them.
const BALL: f64 = 0.2;
const RADIUS: [f64; 2] = [4.0, 20.0];

/// What both kinds of searches have spent.
#[derive(Debug, Default)]
pub(super) struct Neighbourhoods {
    induced: Allowance,
    local_branching: Allowance,
}

/// Searches near the best point if an allowance has room for it.
///
/// # Arguments
///
/// * `nodes`: that this worker has processed.
/// * `point`, `bound`: the relaxed point of the current node, and its bound.
pub(super) fn search_near_incumbent(
    ctx: &mut Context<'_>,
    spent: &mut Neighbourhoods,
    nodes: u64,
    point: &[f64],
    bound: f64,
) {
    let (on, total) = (ctx.options().heuristics, ctx.iterations);
    let cutoff = ctx.tree.cutoff();
    let induced = on.neighbourhood && spent.induced.left(total, false) >= LEAST;
    let local = on.local_branching && spent.local_branching.left(total, false) >= LEAST;
    if !(induced || local) || bound == f64::NEG_INFINITY || bound >= cutoff {
        return;
    }
    let base = ctx.base();
    let Some((value, best)) = ctx.tree.incumbent() else { return };
    if base.is_feasibility_problem() {
        return;
    }
    let wanted = cutoff.min(value - GAIN * (value - bound).max(0.0));
    if induced && let Some(program) = agreement(base, point, &best) {
        span!(DEBUG, "heuristic", name = "neighbourhood");
        let left = spent.induced.left(total, false);
        let source = ctx.tree.begin(Heuristic::Neighbourhood);
        let taken = search_within(ctx, &program, wanted, left, nodes);
        ctx.tree.end(source);
        spent.induced.book(taken, ctx.tree.cutoff() < cutoff);
    }
    let still = ctx.tree.cutoff();
    if local
        && still == cutoff
        && let Some(program) = ball(base, &best)
    {
        span!(DEBUG, "heuristic", name = "local branching");
        let left = spent.local_branching.left(total, false);
        let source = ctx.tree.begin(Heuristic::LocalBranching);
        let taken = search_within(ctx, &program, wanted, left, nodes);
        ctx.tree.end(source);
        spent.local_branching.book(taken, ctx.tree.cutoff() < still);
    }
}

/// Searches a part of the program for a point below `cutoff`, with about so many iterations, and
/// offers it. Returns the iterations that it took.
///
/// # Arguments
///
/// * `nodes`: that this worker has processed, from which follows what a node takes.
fn search_within(
    ctx: &mut Context<'_>,
    program: &Program,
    cutoff: f64,
    iterations: u64,
    nodes: u64,
) -> u64 {
    let a_node = (ctx.iterations / nodes.max(1)).max(1);
    let mut options = ctx.options().nested();
    options.symmetry = false;
    options.node_limit = Some((iterations / a_node).clamp(NODES[0], NODES[1]));
    options.memory_limit = ctx.tree.memory_left();
    let guidance = ctx.shared.task.guidance.idle();
    let (options, guidance) = (&options, &guidance);
    let task = Task { program, root: None, guidance, options, cutoff, ..ctx.shared.task };
    let activity = ctx.clock.pause();
    let Found { points, statistics, .. } = (ctx.shared.nested)(task);
    ctx.clock.resume(activity);
    ctx.iterations += statistics.iterations;
    ctx.tree.count(|s| s.add_nested(&statistics));
    if let Some(mut found) = points.into_iter().next() {
        found.truncate(program.column_count());
        let found = ctx.complete_point(found);
        let value = ctx.program().objective(&found);
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
    let agree = |&j: &usize| (point[j] - best[j]).abs() <= AGREE;
    let open: Vec<usize> = base.integers.iter().filter(open).copied().collect();
    let fixed: Vec<usize> = open.iter().copied().filter(agree).collect();
    let enough = fixed.len() as f64 >= LEAST_FIXED * open.len() as f64;
    if fixed.is_empty() || fixed.len() == open.len() || !enough {
        return None;
    }
    let mut program = base.clone();
    for j in fixed {
        (program.lower[j], program.upper[j]) = (best[j].round(), best[j].round());
    }
    Some(program)
}

/// The program among the points that differ from the best one in few binaries; `None` if all points
/// do.
fn ball(base: &Program, best: &[f64]) -> Option<Program> {
    let binary = |&&j: &&usize| base.lower[j] == 0.0 && base.upper[j] == 1.0;
    let binaries: Vec<usize> = base.integers.iter().filter(binary).copied().collect();
    let radius = (BALL * binaries.len() as f64).round().clamp(RADIUS[0], RADIUS[1]);
    if binaries.len() as f64 <= 2.0 * radius {
        return None;
    }
    let ones = binaries.iter().filter(|&&j| best[j] > 0.5).count() as f64;
    let side = |&j: &usize| (j, if best[j] > 0.5 { -1.0 } else { 1.0 });
    let terms = binaries.iter().map(side).collect();
    let mut program = base.clone();
    program.append(&[], &[(terms, [f64::NEG_INFINITY, radius - ones])])?;
    Some(program)
}
