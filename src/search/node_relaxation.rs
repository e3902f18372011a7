//! The relaxation of a node.

use super::clock::Activity;
use super::context::Context;
use super::node::Decision;
use super::proofs::Proof;
use crate::presolve::{Projection, Reduced, Reduction, project, tighten_coefficients};
use crate::relaxation::{Purpose, Question, Verdict};

/// What is to be relaxed at the node of the domain; `None` if it is refuted.
pub(super) fn project_node(ctx: &mut Context<'_>) -> Option<Projection> {
    let activity = ctx.clock.switch(Activity::Reduction);
    let program = ctx.base();
    let program = ctx.shared.task.exact.filter(|_| ctx.is_leaf()).unwrap_or(program);
    let projection = match ctx.reducer.reduce(program, &ctx.node.domain) {
        Reduction::Reduced(mut reduced) => {
            let integral = &ctx.program().integral;
            if let Some(windows) = ctx.shared.windows {
                windows.add_rows(&ctx.node.domain, &mut reduced);
            }
            tighten_coefficients(&mut reduced, integral);
            Some(project(*reduced, integral))
        }
        Reduction::Infeasible => None,
    };
    ctx.clock.switch(activity);
    projection
}

/// Solves a reduced program and verifies the answer.
///
/// # Arguments
///
/// * `purpose`: the root, a node below or a trial; a node whose integers are all fixed is a leaf.
pub(super) fn relax(ctx: &mut Context<'_>, reduced: &Reduced, purpose: Purpose) -> Verdict {
    let activity = ctx.clock.switch(Activity::Proof);
    let is_leaf = purpose != Purpose::Trial && ctx.is_leaf();
    let question = Question {
        purpose: if is_leaf { Purpose::Leaf } else { purpose },
        cutoff: ctx.tree.cutoff(),
        options: ctx.options(),
        look_for_descent: purpose == Purpose::Root,
        token: &ctx.token,
        warm: ctx.node.warm.as_ref(),
    };
    let verdict = ctx.ladder.solve(reduced, &question);
    ctx.book_relaxations();
    ctx.clock.switch(activity);
    verdict
}

/// As [`relax`], for a program after a decision: what closed the same decision in an earlier solve is
/// tried first, and what closes it now is kept for a later one.
pub(super) fn relax_after(
    ctx: &mut Context<'_>,
    reduced: &Reduced,
    purpose: Purpose,
    decision: &Decision,
) -> Verdict {
    let Some(proofs) = ctx.tree.proofs() else { return relax(ctx, reduced, purpose) };
    let cutoff = ctx.tree.cutoff();
    let activity = ctx.clock.switch(Activity::Proof);
    let closed = proofs.close(reduced, decision, cutoff);
    ctx.clock.switch(activity);
    if let Some((verdict, proof)) = closed {
        ctx.tree.count(|s| s.closed_by_proofs += 1);
        ctx.tree.keep_proof(|| proof);
        return verdict;
    }
    let verdict = relax(ctx, reduced, purpose);
    let keep = |x: &[f64], y: &[f64]| {
        let rows = ctx.base().row_count();
        ctx.tree.keep_proof(|| Proof::new(decision, reduced, rows, x, y));
    };
    match &verdict {
        Verdict::Refuted(y) => keep(&[], y),
        Verdict::Relaxed { bound, x, y, .. } if *bound >= ctx.tree.cutoff() => keep(x, y),
        _ => {}
    }
    verdict
}
