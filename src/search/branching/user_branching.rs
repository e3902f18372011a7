//! Splits by the user's branching rule.

use super::split::Split;
use crate::program::Program;
use crate::search::context::Context;
use crate::solver::{NodeView, SplitAt};

/// By how much a value may be outside the bounds (no unit).
const HAIR: f64 = 1e-6;

/// The split in columns, if it divides a node: the column, and the last value of the lower part.
fn checked(
    program: &Program,
    node: &NodeView<'_>,
    bounds: &[[f64; 2]],
    split: SplitAt,
) -> Option<(usize, f64)> {
    let column = node.column(split.variable)?;
    let [lower, upper] = *bounds.get(column)?;
    // Relaxed values leave their bounds by a hair, and one at the upper bound means the last whole
    // value before it.
    let inside = lower - HAIR <= split.value && split.value <= upper + HAIR;
    let divides = program.integral[column] && lower < upper && split.value.is_finite() && inside;
    divides.then(|| (column, split.value.floor().max(lower).min(upper - 1.0)))
}

/// The split that the user wants, if it divides the current node.
pub(super) fn split_of_user(ctx: &Context<'_>, x: &[f64], bound: f64) -> Option<Split> {
    let rule = ctx.shared.task.guidance.branching()?;
    let (asked, found) = ctx.show(x, bound, |node, bounds| {
        let split = rule.split(node);
        (split.is_some(), split.and_then(|s| checked(ctx.program(), node, bounds, s)))
    });
    ctx.tree.count(|s| match (asked, &found) {
        (_, Some(_)) => s.user_splits += 1,
        (true, None) => s.refused_splits += 1,
        (false, None) => {}
    });
    let (column, value) = found?;
    Some(Split::at(column, value, x[column], bound))
}
