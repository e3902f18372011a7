//! Tightening the domain of the focus node, with propagation.

use super::clock::Activity;
use super::context::Context;
use super::node::Decision;
use crate::presolve::Conflict;

/// Propagates what changed since a mark.
pub(super) fn propagate_since(ctx: &mut Context<'_>, mark: usize) -> Result<(), Conflict> {
    let activity = ctx.clock.switch(Activity::Propagation);
    let program = ctx.program();
    let result = ctx.propagator.propagate_since(program, &mut ctx.node.domain, mark);
    ctx.clock.switch(activity);
    result
}

/// Fixes an integer to a rounded value. Returns `false`, and changes nothing, if that is a
/// contradiction.
pub(super) fn fix_to(ctx: &mut Context<'_>, j: usize, value: f64) -> bool {
    let (value, [lower, upper]) = (value.round(), ctx.node.domain.bounds(j));
    if !(lower <= value && value <= upper) {
        return false;
    }
    let mark = ctx.node.domain.mark();
    ctx.node.fix(j, value);
    let holds = propagate_since(ctx, mark).is_ok();
    if !holds {
        ctx.node.domain.undo_to(mark);
    }
    holds
}

/// Fixes an integer near a value: to the nearest integer, or to the one on the other side. Returns
/// `false` if both contradict the domain.
pub(super) fn fix_near(ctx: &mut Context<'_>, j: usize, value: f64) -> bool {
    if ctx.node.domain.is_fixed(j) {
        return true;
    }
    let [lower, upper] = ctx.node.domain.bounds(j);
    let near = value.round().clamp(lower, upper);
    let other = if value > near { near + 1.0 } else { near - 1.0 };
    let other = if other < lower || other > upper { 2.0 * near - other } else { other };
    for candidate in [near, other] {
        if !candidate.is_finite() || candidate < lower || candidate > upper {
            continue;
        }
        let mark = ctx.node.domain.mark();
        ctx.node.fix(j, candidate);
        if propagate_since(ctx, mark).is_ok() {
            return true;
        }
        ctx.node.domain.undo_to(mark);
    }
    false
}

/// Tightens the domain of the current node by decisions that hold in it. The facts become part of
/// the path, so that the node's children have them too. If the ends of the tree are kept they are
/// left out, because each would be an end of its own.
///
/// # Errors
///
/// A conflict if the facts leave nothing of the node. The domain is then as it was.
pub(super) fn add_facts(ctx: &mut Context<'_>, facts: &[Decision]) -> Result<(), Conflict> {
    if ctx.options().parts().keep_leaves {
        return Ok(());
    }
    let (mark, known) = (ctx.node.domain.mark(), ctx.node.path.len());
    for fact in facts {
        if ctx.node.apply_if_news(fact) {
            ctx.node.path.push(*fact);
        }
    }
    if ctx.node.domain.mark() == mark {
        return Ok(());
    }
    let result = propagate_since(ctx, mark);
    if result.is_err() {
        ctx.node.domain.undo_to(mark);
        ctx.node.path.truncate(known);
    }
    result
}
