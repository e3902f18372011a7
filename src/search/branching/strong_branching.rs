//! Strong branching: trials of children, and what is kept of them.
//!
//! A trial solves the relaxation of a child before the child exists. Its gain scores the split, and
//! a trial that refutes its child closes it. Its bound and relaxed point go to the child, which
//! need not be solved again. Bounds that propagation finds in both children of a column hold in the
//! parent.

use crate::relaxation::{Purpose, Verdict};
use crate::search::context::Context;
use crate::search::local_bounds::propagate_since;
use crate::search::node::{Decision, Known};
use crate::search::node_relaxation::{project_node, relax_after};
use crate::search::pseudocosts::Pseudocosts;

/// Trials of new columns at a node.
pub(super) const TRIALS: usize = 8;

/// A child that a trial has left open.
#[derive(Debug, Clone)]
pub(super) struct Trial {
    /// Growth of the bound over the parent's.
    pub(super) gain: f64,
    /// Proved bound of the child.
    pub(super) bound: f64,
    /// The child's relaxed point, if there is one.
    pub(super) known: Option<Box<Known>>,
    /// Bounds of integral columns that propagation moved in the child.
    moved: Vec<Decision>,
}

/// What holds in both of two children: bounds that both moved, at the weaker of both values.
pub(super) fn common(one: &Trial, other: &Trial) -> Vec<Decision> {
    let mut facts = Vec::new();
    for a in &one.moved {
        let same = |b: &&Decision| (b.column, b.is_upper) == (a.column, a.is_upper);
        if let Some(b) = other.moved.iter().find(same) {
            let value = if a.is_upper { a.value.max(b.value) } else { a.value.min(b.value) };
            facts.push(Decision { value, ..*a });
        }
    }
    facts
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
) -> Option<Trial> {
    let mark = ctx.node.domain.mark();
    ctx.node.domain.apply(decision.column, decision.is_upper, decision.value);
    ctx.propagator.set_on_trial(true);
    let propagated = propagate_since(ctx, mark);
    ctx.propagator.set_on_trial(false);
    let mut point = Vec::new();
    let verdict = match propagated.ok().and_then(|()| project_node(ctx)) {
        Some(projection) => {
            let verdict = relax_after(ctx, &projection.reduced, Purpose::Trial, &decision);
            if let Verdict::Relaxed { x, converged: true, .. } = &verdict {
                point = ctx.complete_point(projection.lift(x));
            }
            verdict
        }
        None => Verdict::Refuted(Vec::new()),
    };
    let moved = moved_since(ctx, mark, decision.column);
    ctx.node.domain.undo_to(mark);
    match verdict {
        Verdict::Refuted(_) => {
            ctx.tree.count(|s| s.closed_by_trials += 1);
            None
        }
        Verdict::Relaxed { bound: child, warm, .. } => {
            let fraction = (value - decision.value).abs();
            let gain = child - bound;
            pseudocosts.learn(decision.column, !decision.is_upper, gain, fraction);
            let child = ctx.tree.strengthen(child.min(ctx.node.cutoff));
            if child >= ctx.tree.cutoff() {
                ctx.tree.count(|s| s.closed_by_trials += 1);
                ctx.tree.close(child);
                return None;
            }
            let known = (!point.is_empty()).then(|| Box::new(Known { point, warm }));
            let gain = if gain.is_finite() { gain } else { 0.0 };
            Some(Trial { gain, bound: child, known, moved })
        }
        Verdict::Stopped | Verdict::Descent => {
            Some(Trial { gain: 0.0, bound: f64::NEG_INFINITY, known: None, moved })
        }
    }
}

/// Whether a child needs no visit, by propagation or by a proof of an earlier solve; no relaxation.
pub(super) fn is_closed_by_proof(ctx: &mut Context<'_>, decision: Decision) -> bool {
    let Some(proofs) = ctx.tree.proofs().filter(|proofs| proofs.knows(&decision)) else {
        return false;
    };
    let mark = ctx.node.domain.mark();
    ctx.node.domain.apply(decision.column, decision.is_upper, decision.value);
    ctx.propagator.set_on_trial(true);
    let propagated = propagate_since(ctx, mark);
    ctx.propagator.set_on_trial(false);
    let closed = match propagated.ok().and_then(|()| project_node(ctx)) {
        Some(projection) => {
            let closed = proofs.close(&projection.reduced, &decision, ctx.tree.cutoff());
            closed.map(|(verdict, proof)| {
                ctx.tree.count(|s| s.closed_by_proofs += 1);
                ctx.tree.keep_proof(|| proof);
                verdict
            })
        }
        None => Some(Verdict::Refuted(Vec::new())),
    };
    ctx.node.domain.undo_to(mark);
    if let Some(verdict) = &closed {
        ctx.tree.count(|s| s.closed_by_trials += 1);
        if let Verdict::Relaxed { bound, .. } = verdict {
            ctx.tree.close(ctx.tree.strengthen(*bound));
        }
    }
    closed.is_some()
}

/// The bounds of integral columns other than `except` that moved since a mark, as they are now.
fn moved_since(ctx: &Context<'_>, mark: usize, except: usize) -> Vec<Decision> {
    let domain = &ctx.node.domain;
    let integral = &ctx.program().integral;
    let others = domain.changed_since(mark).filter(|&(j, _)| j != except && integral[j]);
    let mut sides: Vec<(usize, bool)> = others.collect();
    sides.sort_unstable();
    sides.dedup();
    let now = |(column, is_upper)| {
        let [lower, upper] = domain.bounds(column);
        Decision { column, is_upper, value: if is_upper { upper } else { lower } }
    };
    sides.into_iter().map(now).collect()
}
