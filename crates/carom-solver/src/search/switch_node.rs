//! From node to node: decisions applied to the domain, propagated, and probed.

use super::clock::Activity;
use super::context::Context;
use super::node::Decision;
use super::node_probing::NodeProbing;
use super::settled_binaries::settle_binaries;
use crate::presolve::{Conflict, probe_again};

/// Brings the domain to a node: on from its nearest ancestor that the current path went through,
/// with all that was concluded there.
///
/// # Errors
///
/// A conflict if propagation or probing refutes the node. The domain is then that of the ancestor.
pub(super) fn switch_to(
    ctx: &mut Context<'_>,
    probing: &mut NodeProbing,
    path: &[Decision],
) -> Result<(), Conflict> {
    ctx.node.go_back_towards(path, &mut ctx.propagator);
    let program = ctx.program();
    ctx.node.cutoff = ctx.propagator.set_cutoff(program, ctx.tree.cutoff());
    let mark = ctx.node.domain.mark();
    let fresh = &path[ctx.node.path.len()..];
    for decision in fresh {
        ctx.node.apply_if_news(decision);
    }
    let activity = ctx.clock.switch(Activity::Propagation);
    let mut result = ctx.propagator.propagate_since(program, &mut ctx.node.domain, mark);
    if result.is_ok() {
        let before = ctx.node.domain.mark();
        settle_binaries(ctx);
        if ctx.node.domain.mark() != before {
            result = ctx.propagator.propagate_since(program, &mut ctx.node.domain, before);
        }
    }
    let probes = probing.is_due() && result.is_ok() && ctx.options().parts().probing;
    if probes {
        ctx.clock.switch(Activity::Probing);
        result = probe_node(ctx, probing);
    }
    ctx.clock.switch(activity);
    if result.is_err() {
        ctx.node.domain.undo_to(mark);
        return result;
    }
    ctx.node.path.extend_from_slice(fresh);
    if probes && !ctx.options().parts().keep_leaves {
        // The finds of trials become part of the path, so that no child has to find them again.
        let found = probing.record.found().iter();
        let facts = found.map(|&(column, is_upper, value)| Decision { column, is_upper, value });
        ctx.node.path.extend(facts);
    }
    Ok(())
}

/// Probes within the credit that probing has earned.
fn probe_node(ctx: &mut Context<'_>, probing: &mut NodeProbing) -> Result<(), Conflict> {
    let program = ctx.program();
    let before = ctx.node.domain.mark();
    let order = (&ctx.root().late_first[..], probing.trials());
    let (domain, propagator) = (&mut ctx.node.domain, &mut ctx.propagator);
    let result = probe_again(program, domain, propagator, order, &mut probing.record, &ctx.token);
    let decided = |&(j, _): &(usize, bool)| program.integral[j];
    let gains = ctx.node.domain.changed_since(before).filter(decided).count();
    probing.book(probing.record.tried(), gains, result.is_err());
    result
}
