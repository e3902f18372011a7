//! Diving: fix some integers, propagate, relax, and so on down to a point.
//!
//! Each step fixes half of the fractional integers and solves the relaxation again, roughly. The
//! most certain integers go first: those nearest to an integer, those with the smallest
//! pseudocosts, or those nearest to the best point; dives alternate between these. A step that
//! fails is undone once and tried the other way. Dives are paid from an allowance, and a dive whose
//! allowance ends rounds the rest.

use super::allowance::Allowance;
use super::parameters::HEURISTICS;
use super::rounding::round_and_propagate;
use crate::relaxation::{Purpose, RelaxationVerdict};
use crate::search::context::Context;
use crate::search::indifferent_binaries::round_groups;
use crate::search::leaf::try_assignment;
use crate::search::local_bounds::{fix_near, propagate_since};
use crate::search::node_relaxation::{project_node, relax};
use crate::search::pseudocosts::Pseudocosts;
use crate::search::trace::span;
use crate::solution::Heuristic;

/// The measure of how sure a value of an integer is; the surest ones are fixed first.
#[derive(Debug, Clone, Copy)]
enum DivingRule<'r> {
    /// Nearest to a whole value.
    Fraction,
    /// The side that moves the bound less.
    Pseudocosts(&'r Pseudocosts),
    /// Nearest to the best point.
    Incumbent(&'r [f64]),
}

/// An integer to fix: its uncertainty, the column, and a number whose nearest whole number is the
/// value to fix it at. The alternative is the whole number on the other side of that number.
type Fixing = (f64, usize, f64);

/// Dives from the relaxed point of the current node if the allowance has room for it.
pub(super) fn dive_where_it_pays(
    ctx: &mut Context<'_>,
    allowance: &mut Allowance,
    pseudocosts: &Pseudocosts,
    point: &[f64],
    bound: f64,
) {
    let cutoff = ctx.tree.cutoff();
    // Without an objective a plunge of the tree is a dive already.
    let free =
        cutoff == f64::INFINITY && ctx.tree.id == 0 && !ctx.program().is_feasibility_problem();
    let left = allowance.left(ctx.iterations, free);
    if left < HEURISTICS.dive_iterations || bound == f64::NEG_INFINITY || bound >= cutoff {
        return;
    }
    span!(DEBUG, "heuristic", name = "diving");
    let before = ctx.iterations;
    let source = ctx.tree.begin(Heuristic::Diving);
    let incumbent = ctx.tree.incumbent();
    let rule = match (allowance.calls() % 3, &incumbent) {
        (0, _) => DivingRule::Pseudocosts(pseudocosts),
        (1, Some((_, best))) => DivingRule::Incumbent(best),
        _ => DivingRule::Fraction,
    };
    dive(ctx, rule, point, before + left);
    ctx.tree.end(source);
    let spent = ctx.iterations - before;
    allowance.book(spent, ctx.tree.cutoff() < cutoff);
}

/// Dives until the worker has taken `last` iterations. The domain is left as it was.
fn dive(ctx: &mut Context<'_>, rule: DivingRule<'_>, point: &[f64], last: u64) {
    let start = ctx.node.domain.mark();
    let mut point = point.to_vec();
    let mut turned_back = false;
    for _ in 0..HEURISTICS.dive_steps {
        let candidates = candidates(ctx, rule, &point);
        let Some(&(_, first, value)) = candidates.first() else { break };
        let mark = ctx.node.domain.mark();
        let mut next = None;
        if candidates.iter().all(|&(_, j, value)| fix_near(ctx, j, value)) {
            next = relax_dive(ctx);
        }
        if next.is_none() && !turned_back && !ctx.token.is_over() {
            turned_back = true;
            ctx.node.domain.undo_to(mark);
            if exclude(ctx, first, value) {
                next = relax_dive(ctx);
            }
        }
        let Some(found) = next else {
            ctx.node.domain.undo_to(start);
            return;
        };
        point = found;
        if ctx.is_leaf() || ctx.is_integral(&point) || ctx.iterations >= last {
            break;
        }
    }
    if ctx.is_integral(&point) {
        try_assignment(ctx, &point);
    } else {
        round_and_propagate(ctx, &point);
    }
    ctx.node.domain.undo_to(start);
}

/// The fractional integers that the next step fixes, the surest first.
fn candidates(ctx: &Context<'_>, rule: DivingRule<'_>, point: &[f64]) -> Vec<Fixing> {
    let integrality = ctx.options().integrality;
    let distance = |j: usize| (point[j] - point[j].round()).abs();
    let fractional = ctx.program().integers.iter().copied().filter(|&j| distance(j) > integrality);
    let candidate = |j: usize| {
        let (x, below) = (point[j], point[j].floor());
        match rule {
            DivingRule::Incumbent(best) => {
                let aim = if best[j] > x { below + 0.75 } else { below + 0.25 };
                ((x - best[j]).abs(), j, aim)
            }
            DivingRule::Pseudocosts(pseudocosts) => {
                let [down, up] = pseudocosts.gains(j, x);
                let aim = if up < down { below + 0.75 } else { below + 0.25 };
                (down.min(up) / down.max(up), j, aim)
            }
            DivingRule::Fraction => (distance(j), j, x),
        }
    };
    let mut candidates: Vec<Fixing> = fractional.map(candidate).collect();
    candidates.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    candidates.truncate(candidates.len().div_ceil(HEURISTICS.dive_divisor));
    candidates
}

/// Excludes the value that a column was to be fixed at, with all beyond it. Returns `false` if that
/// contradicts the domain.
fn exclude(ctx: &mut Context<'_>, j: usize, value: f64) -> bool {
    let (near, mark) = (value.round(), ctx.node.domain.mark());
    let up = value > near;
    let beyond = if up { near + 1.0 } else { near - 1.0 };
    let [lower, upper] = ctx.node.domain.bounds(j);
    if beyond < lower || beyond > upper {
        return false;
    }
    ctx.node.domain.apply(j, !up, beyond);
    propagate_since(ctx, mark).is_ok()
}

/// The relaxed point of the domain that the dive has reached; `None` if that domain has no better
/// point.
fn relax_dive(ctx: &mut Context<'_>) -> Option<Vec<f64>> {
    let mut projection = project_node(ctx)?;
    let verdict = relax(ctx, &mut projection.reduced, Purpose::Trial);
    let point = match &verdict {
        RelaxationVerdict::Relaxed { bound, x, .. }
            if ctx.tree.strengthen(*bound) < ctx.tree.cutoff() =>
        {
            Some(projection.lift(x))
        }
        _ => None,
    };
    ctx.cascade.reuse(verdict);
    ctx.cascade.reducer().reuse_projection(projection);
    let mut point = point?;
    let integrality = ctx.options().integrality;
    round_groups(ctx.program(), &ctx.node.domain, &ctx.root().groups, integrality, &mut point);
    Some(point)
}
