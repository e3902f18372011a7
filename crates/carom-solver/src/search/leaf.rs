//! Points from fixed integers: solve the rest, polish, verify, report.

use std::hash::{DefaultHasher, Hash, Hasher};

use super::clock::Activity;
use super::context::Context;
use super::leaf_reduction::{determined, reduce_leaf};
use super::local_bounds::propagate_since;
use super::node_relaxation::relax;
use crate::presolve::Reduced;
use crate::program::Program;
use crate::relaxation::{Purpose, RelaxationVerdict, polish, polish_cones, polish_leaf};
use crate::tolerance;

/// Fixes all integers to the rounded values of `point`, solves the rest and offers the result.
/// Returns whether it was accepted. The domain is left as it was.
pub(super) fn try_assignment(ctx: &mut Context<'_>, point: &[f64]) -> bool {
    let mark = ctx.node.domain.mark();
    for &j in &ctx.program().integers {
        let value = point[j].round();
        ctx.node.domain.apply(j, false, value.max(ctx.node.domain.lower(j)));
        ctx.node.domain.apply(j, true, value.min(ctx.node.domain.upper(j)));
    }
    let found = solve_assignment(ctx, mark);
    ctx.node.domain.undo_to(mark);
    found
}

/// Solves the leaf that the domain has become since `mark` and offers its point. Returns whether it
/// was accepted.
pub(super) fn solve_assignment(ctx: &mut Context<'_>, mark: usize) -> bool {
    if propagate_since(ctx, mark).is_err() {
        return false;
    }
    // The same integers lead to the same point.
    if !ctx.is_leaf() || !is_new_assignment(ctx) {
        return false;
    }
    let program = ctx.task().exact.unwrap_or(ctx.program()).with_squares();
    let Some(mut reduced) = reduce_leaf(ctx, program) else { return false };
    let verdict = relax(ctx, &mut reduced, Purpose::Node);
    let found = match &verdict {
        RelaxationVerdict::Relaxed { x, y, .. } => offer_leaf(ctx, &reduced, x, y),
        _ => false,
    };
    ctx.cascade.reuse(verdict);
    ctx.cascade.reducer().reuse(reduced);
    found
}

/// Whether the integers of the domain, all fixed, were not seen here before.
fn is_new_assignment(ctx: &mut Context<'_>) -> bool {
    let mut hasher = DefaultHasher::new();
    for &j in &ctx.program().integers {
        ctx.node.domain.lower(j).to_bits().hash(&mut hasher);
    }
    ctx.assignments.insert(hasher.finish())
}

/// Polishes a leaf's point and offers it. Returns `false` if the check refuses it.
///
/// # Arguments
///
/// * `y`: the multipliers of the rows.
pub(super) fn offer_leaf(ctx: &mut Context<'_>, reduced: &Reduced, x: &[f64], y: &[f64]) -> bool {
    let activity = ctx.clock.switch(Activity::Verification);
    let found = offer_verified(ctx, reduced, x);
    if found && gains_by_widening(ctx, reduced, x, y) {
        ctx.tree.note_widened();
    }
    ctx.clock.switch(activity);
    found
}

/// Whether a visible part of the value of a leaf is due to limits that presolve has widened.
fn gains_by_widening(ctx: &mut Context<'_>, reduced: &Reduced, x: &[f64], y: &[f64]) -> bool {
    let program = ctx.task().exact.unwrap_or(ctx.program());
    let [rows, columns] = &program.widened;
    if rows.is_empty() && columns.is_empty() {
        return false;
    }
    let by = |widened: &[f64], k: usize| widened.get(k).copied().unwrap_or(0.0);
    let of_rows = y.iter().zip(&reduced.origin).map(|(y, &row)| y.abs() * by(rows, row));
    let mut gain = of_rows.sum::<f64>();
    if y.len() == reduced.rows.len() {
        // A row may have become a bound.
        let of_row = |(&row, a): (&usize, &f64)| by(rows, row) / a.abs();
        let (_, slopes) = ctx.cascade.prover().reduced_costs(reduced, x, y);
        for (slope, &j) in slopes.iter().zip(&reduced.columns).filter(|(slope, _)| **slope != 0.0) {
            let (uses, values) = program.column(j);
            let widest = uses.iter().zip(values).map(of_row).fold(by(columns, j), f64::max);
            gain += slope.abs() * widest;
        }
    }
    let value = reduced.objective(x);
    gain > 0.5 * ctx.options().allowed_gap(value, program.constant)
}

/// As [`offer_leaf`], for a leaf that was loosened.
pub(super) fn offer_loosened(ctx: &mut Context<'_>, reduced: &Reduced, x: &[f64]) -> bool {
    let activity = ctx.clock.switch(Activity::Verification);
    let found = offer_verified(ctx, reduced, x);
    ctx.clock.switch(activity);
    found
}

fn offer_verified(ctx: &mut Context<'_>, reduced: &Reduced, x: &[f64]) -> bool {
    let mut polished = x.to_vec();
    polish(reduced, &mut polished, &ctx.token);
    polish_cones(reduced, &mut polished, &ctx.token);
    // For columns without bounds and curvature, bounds are proved inside a radius only; a point
    // outside must not be measured by them.
    let open = |j: usize| {
        let steepness = reduced.steepness.get(j).copied().unwrap_or(0.0);
        steepness <= 0.0 && (reduced.lower[j].is_infinite() || reduced.upper[j].is_infinite())
    };
    for candidate in [&polished[..], x] {
        let far = |(j, v): (usize, &f64)| v.abs() > tolerance::FREE_RADIUS && open(j);
        if candidate.iter().enumerate().any(far) {
            ctx.tree.count(|s| s.beyond_radius += 1);
            continue;
        }
        let mut point = reduced.lift(candidate);
        for &j in &ctx.program().integers {
            point[j] = point[j].round();
        }
        complete(ctx, &mut point);
        if offer_accepted(ctx, &point) {
            return true;
        }
        // Columns that the reduction has fixed inside narrow bounds may have to move.
        let program = exact_program(ctx);
        polish_leaf(program, &mut point, &ctx.token);
        complete(ctx, &mut point);
        if offer_accepted(ctx, &point) {
            return true;
        }
    }
    false
}

/// Offers a point as it is. Returns whether it was accepted.
pub(super) fn offer_point(ctx: &mut Context<'_>, point: &[f64]) -> bool {
    let activity = ctx.clock.switch(Activity::Verification);
    let mut point = point.to_vec();
    complete(ctx, &mut point);
    let found = offer_accepted(ctx, &point);
    ctx.clock.switch(activity);
    found
}

/// Gives columns that follow from others their values.
fn complete(ctx: &Context<'_>, point: &mut [f64]) {
    if let Some(determined) = determined(ctx.tree.tree) {
        determined.follow(point);
    }
    exact_program(ctx).complete_parts(point);
}

/// The program before it was strengthened.
fn exact_program<'a>(ctx: &Context<'a>) -> &'a Program {
    ctx.task().exact.unwrap_or(ctx.program())
}

fn offer_accepted(ctx: &Context<'_>, point: &[f64]) -> bool {
    let task = ctx.task();
    if !task.judge.accepts(point) {
        return false;
    }
    if task.judge.excludes(point) {
        ctx.tree.count(|s| s.excluded_by_rows += 1);
        return false;
    }
    if ctx.node_cuts.exclude(point) {
        ctx.tree.note_wrong_cut(point);
    }
    ctx.tree.offer(task.value(point), point.to_vec());
    true
}
