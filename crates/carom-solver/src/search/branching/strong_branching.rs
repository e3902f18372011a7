//! Strong branching: trials of children, and the results that are kept.
//!
//! A trial solves the relaxation of a child before the child exists. Its gain scores the split, and
//! a trial that refutes its child closes it. Its bound and relaxed point go to the child, which
//! need not be solved again.

use std::sync::Arc;

use crate::relaxation::{Purpose, RelaxationVerdict};
use crate::search::context::Context;
use crate::search::local_bounds::propagate_since;
use crate::search::node::{Decision, KnownRelaxation};
use crate::search::node_relaxation::{project_reduced, reduce_node, relax_and_keep};
use crate::search::pseudocosts::Pseudocosts;
use crate::search::saved_tree::{End, ProofMultipliers, SavedDuals};

/// A child that a trial has left open.
#[derive(Debug, Clone)]
pub(super) struct ChildTrial {
    /// Growth of the bound over the parent's.
    pub(super) gain: f64,
    /// Proved bound of the child.
    pub(super) bound: f64,
    /// The child's relaxed point, if there is one.
    pub(super) known: Option<Box<KnownRelaxation>>,
    /// The multipliers that proved its bound, if they are kept.
    pub(super) multipliers: Option<Arc<ProofMultipliers>>,
}

/// Solves a child on trial and learns from it. Returns `None` if it needs no visit.
///
/// # Arguments
///
/// * `value`: of the column at the relaxed point.
/// * `bound`: of the current node.
pub(super) fn try_child(
    ctx: &mut Context<'_>,
    pseudocosts: &mut Pseudocosts,
    decision: Decision,
    value: f64,
    bound: f64,
) -> Option<ChildTrial> {
    let mark = ctx.node.domain.mark();
    ctx.node.domain.apply(decision.column, decision.is_upper, decision.value);
    ctx.propagator.set_on_trial(true);
    let propagated = propagate_since(ctx, mark);
    ctx.propagator.set_on_trial(false);
    let reduced = propagated.ok().and_then(|()| reduce_node(ctx));
    let Some(reduced) = reduced else {
        ctx.node.domain.undo_to(mark);
        close_side(ctx, decision, f64::INFINITY);
        return None;
    };
    let mut projection = project_reduced(ctx, reduced);
    let (mut verdict, multipliers) = relax_and_keep(ctx, &mut projection, Purpose::Trial);
    let mut point = Vec::new();
    if let RelaxationVerdict::Relaxed { x, converged: true, .. } = &verdict {
        point = projection.lift(x);
    }
    ctx.cascade.reducer().reuse_projection(projection);
    ctx.node.domain.undo_to(mark);
    let trial = match &mut verdict {
        RelaxationVerdict::Refuted(_) => {
            keep_duals(ctx, &decision, multipliers);
            close_side(ctx, decision, f64::INFINITY);
            None
        }
        RelaxationVerdict::Relaxed { bound: child, warm, .. } => {
            let fraction = (value - decision.value).abs();
            let gain = *child - bound;
            pseudocosts.learn(decision.column, !decision.is_upper, gain, fraction);
            let child = ctx.tree.strengthen(child.min(ctx.node.cutoff));
            if child >= ctx.tree.cutoff() {
                keep_duals(ctx, &decision, multipliers);
                close_side(ctx, decision, child);
                None
            } else {
                let known = (!point.is_empty())
                    .then(|| Box::new(KnownRelaxation { point, warm: warm.take() }));
                let gain = if gain.is_finite() { gain } else { 0.0 };
                Some(ChildTrial { gain, bound: child, known, multipliers })
            }
        }
        RelaxationVerdict::Stopped | RelaxationVerdict::Descent => {
            Some(ChildTrial { gain: 0.0, bound: f64::NEG_INFINITY, known: None, multipliers: None })
        }
    };
    ctx.cascade.reuse(verdict);
    trial
}

/// Keeps the multipliers that closed a side of the current node.
fn keep_duals(ctx: &Context<'_>, side: &Decision, multipliers: Option<Arc<ProofMultipliers>>) {
    if let Some(multipliers) = multipliers {
        ctx.tree.keep_duals(|| SavedDuals::new(End::Side(ctx.node.id, *side), multipliers));
    }
}

/// Books a side of the current node as closed by a bound. The bound is infinite if the side has no
/// feasible point.
fn close_side(ctx: &mut Context<'_>, side: Decision, bound: f64) {
    ctx.tree.count(|s| s.closed_by_trials += 1);
    ctx.node.closed.push(side);
    if bound < f64::INFINITY {
        ctx.tree.close(ctx.tree.strengthen(bound));
    }
}
