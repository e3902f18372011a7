//! The feasibility pump: alternate rounding and projection.
//!
//! The relaxed point is rounded, and then the nearest point of the relaxation is computed, with a
//! decreasing share of the objective (Fischetti, Glover and Lodi 2005; Achterberg and Berthold
//! 2007). Distances are absolute differences for integers that are rounded to a bound, and squares
//! for others. Rounding propagates, so the pump ends as soon as the rounding heuristic succeeds
//! from one of its points. If it returns to the same rounded point, the least certain integers are
//! flipped.

use super::rounding::round_and_propagate;
use crate::presolve::{Reduced, Reduction, reduce};
use crate::relaxation::{Claim, Purpose};
use crate::search::context::Context;
use crate::search::leaf::try_assignment;
use crate::search::trace::span;
use crate::solution::Heuristic;

/// Most projections.
const ROUNDS: usize = 10;

/// What is left of the objective's share after a projection.
const FADE: f64 = 0.8;

/// Integers that are turned over when the pump comes back to a point.
const TURNED: usize = 10;

/// Pumps from the relaxed point of the root if there is no point yet but an objective.
pub(super) fn pump_at_root(ctx: &mut Context<'_>, point: &[f64], bound: f64) {
    let base = ctx.base();
    let wanted = ctx.tree.cutoff() == f64::INFINITY && bound > f64::NEG_INFINITY;
    if wanted && !base.is_feasibility_problem() {
        span!(DEBUG, "heuristic", name = "pump");
        let source = ctx.tree.begin(Heuristic::Pump);
        pump(ctx, point);
        ctx.tree.end(source);
    }
}

/// Pumps from a relaxed point. The domain is left as it was.
fn pump(ctx: &mut Context<'_>, point: &[f64]) {
    let mut point = point.to_vec();
    let (mut share, mut seen): (f64, Vec<Vec<f64>>) = (1.0, Vec::new());
    for _ in 0..ROUNDS {
        if ctx.token.is_over() {
            return;
        }
        let mut target: Vec<f64> = ctx.own_integers().iter().map(|&j| point[j].round()).collect();
        if seen.contains(&target) {
            turn_over(ctx, &point, &mut target);
        }
        share *= FADE;
        let Some(next) = project_onto(ctx, &target, share) else { return };
        seen.push(target);
        point = next;
        let whole = ctx.is_integral(&point);
        if if whole { try_assignment(ctx, &point) } else { round_and_propagate(ctx, &point) } {
            return;
        }
    }
}

/// Rounds the least sure integers the other way.
fn turn_over(ctx: &Context<'_>, point: &[f64], target: &mut [f64]) {
    let integers = ctx.own_integers();
    let far = |k: usize| (point[integers[k]] - target[k]).abs();
    let mut order: Vec<usize> = (0..integers.len()).collect();
    order.retain(|&k| !ctx.node.domain.is_fixed(integers[k]));
    order.sort_by(|&a, &b| far(b).total_cmp(&far(a)).then(a.cmp(&b)));
    for &k in order.iter().take(TURNED) {
        let [lower, upper] = ctx.node.domain.bounds(integers[k]);
        let up = point[integers[k]] > target[k] || target[k] <= lower;
        let other = if up { target[k] + 1.0 } else { target[k] - 1.0 };
        target[k] = other.clamp(lower, upper);
    }
}

/// The relaxed point nearest to the target, one entry an integer, with a share of the objective.
fn project_onto(ctx: &mut Context<'_>, target: &[f64], share: f64) -> Option<Vec<f64>> {
    let base = ctx.base();
    let largest = base.linear.iter().fold(0.0_f64, |m, q| m.max(q.abs()));
    let largest = base.quadratic.val().iter().fold(largest, |m, p| m.max(p.abs()));
    let weight = if largest > 0.0 { share / largest } else { 0.0 };
    let mut linear: Vec<f64> = base.linear.iter().map(|q| weight * q).collect();
    let mut products = Vec::new();
    for j in 0..base.column_count() {
        let (rows, values) = base.quadratic_column(j);
        products.extend(rows.iter().zip(values).map(|(&i, p)| (i, j, weight * p)));
    }
    for (&j, &aim) in ctx.own_integers().iter().zip(target) {
        let [lower, upper] = ctx.node.domain.bounds(j);
        if aim <= lower {
            linear[j] += 1.0;
        } else if aim >= upper {
            linear[j] -= 1.0;
        } else {
            linear[j] -= 2.0 * aim;
            products.push((j, j, 2.0));
        }
    }
    let mut program = base.clone();
    program.replace_objective(linear, &products)?;
    let Reduction::Reduced(reduced) = reduce(&program, &ctx.node.domain) else { return None };
    let x = solve_roughly(ctx, &reduced)?;
    Some(ctx.complete_point(reduced.lift(&x)))
}

/// A point near the optimum of a program of our own; nothing is concluded from it.
fn solve_roughly(ctx: &mut Context<'_>, reduced: &Reduced) -> Option<Vec<f64>> {
    if reduced.columns.is_empty() {
        return Some(Vec::new());
    }
    let answer = ctx.ladder.solve_once(reduced, Purpose::Projection, &ctx.token);
    ctx.book_relaxations();
    let usable = !matches!(answer.claim, Claim::Infeasible | Claim::Unbounded);
    (usable && answer.x.iter().all(|v| v.is_finite())).then_some(answer.x)
}
