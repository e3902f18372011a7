//! The relaxation of a node.

use std::sync::Arc;

use super::clock::Activity;
use super::cone_method::ConeMethod;
use super::cone_pool::{append_cone_rows, note_cone_rows, separate_cones};
use super::context::Context;
use super::leaf_reduction::reduce_leaf;
use super::node_cuts::relax_with_cuts;
use super::saved_tree::ProofMultipliers;
use crate::presolve::{Projection, Reduced, tighten_coefficients};
use crate::program::ConeRole;
use crate::relaxation::{Purpose, RelaxationQuestion, RelaxationVerdict, WarmState};
use web_time::Instant;

/// Most rounds of cuts of cones at a node, and the least lift of the bound by one that is followed
/// by another one, as a share of the gap to the cutoff.
const MAX_CONE_ROUNDS: usize = 20;
const CONE_LIFT: f64 = 0.1;

/// The program to relax at the node of the domain; `None` if the node is refuted.
pub(super) fn project_node(ctx: &mut Context<'_>) -> Option<Projection> {
    let reduced = reduce_node(ctx)?;
    Some(project_reduced(ctx, reduced))
}

/// The reduced program without the binaries that a relaxation does not need.
pub(super) fn project_reduced(ctx: &mut Context<'_>, reduced: Reduced) -> Projection {
    let activity = ctx.clock.switch(Activity::Reduction);
    let integral = &ctx.program().integral;
    let projection = ctx.cascade.reducer().project(reduced, integral);
    ctx.clock.switch(activity);
    projection
}

/// The program of the node of the domain; `None` if it is refuted.
pub(super) fn reduce_node(ctx: &mut Context<'_>) -> Option<Reduced> {
    let activity = ctx.clock.switch(Activity::Reduction);
    let program = ctx.program();
    let mut reduced = match ctx.is_leaf() {
        true => reduce_leaf(ctx, ctx.task().exact.unwrap_or(program).with_squares()),
        false => ctx.cascade.reducer().reduce(program, &ctx.node.domain),
    };
    if let Some(reduced) = &mut reduced {
        tighten_coefficients(reduced, &ctx.program().integral);
    }
    ctx.clock.switch(activity);
    reduced
}

/// Solves a reduced program and verifies the answer.
///
/// # Arguments
///
/// * `purpose`: the root, a node below or a trial; a node whose integers are all fixed is a leaf.
pub(super) fn relax(
    ctx: &mut Context<'_>,
    reduced: &mut Reduced,
    purpose: Purpose,
) -> RelaxationVerdict {
    let activity = ctx.clock.switch(Activity::Proof);
    let verdict = match reduced.is_cut_off && !reduced.cones.is_empty() {
        true => relax_cut_off(ctx, reduced, purpose),
        false => relax_as_is(ctx, reduced, purpose),
    };
    ctx.book_relaxations();
    ctx.clock.switch(activity);
    verdict
}

/// Solves a reduced program whose cones may be cut off, in the quicker way.
fn relax_cut_off(
    ctx: &mut Context<'_>,
    reduced: &mut Reduced,
    purpose: Purpose,
) -> RelaxationVerdict {
    // Threads of a deterministic search must not differ in what they have seen.
    let method = match (ctx.options().deterministic, purpose) {
        (true, _) => ConeMethod::Cuts,
        // Tangents of squares are quick to converge, and a linear program keeps its basis.
        _ if reduced.cones.iter().all(|cone| cone.role == ConeRole::Square) => ConeMethod::Cuts,
        (false, Purpose::Trial) => ctx.cone_record.current(),
        (false, _) => ctx.cone_record.next(),
    };
    let began = Instant::now();
    let is_warm = ctx.node.warm.is_some();
    let verdict = match method {
        ConeMethod::Cuts => relax_in_rounds(ctx, reduced, purpose),
        ConeMethod::Conic => relax_with_cones(ctx, reduced, purpose),
    };
    if purpose != Purpose::Trial {
        ctx.cone_record.note(method, began.elapsed(), is_warm);
    }
    verdict
}

/// Solves a reduced program with its cones in place of their cuts.
fn relax_with_cones(
    ctx: &mut Context<'_>,
    reduced: &mut Reduced,
    purpose: Purpose,
) -> RelaxationVerdict {
    if let Some(cuts) = &ctx.program().cone_cuts {
        reduced.drop_rows(cuts);
    }
    reduced.is_cut_off = false;
    relax_as_is(ctx, reduced, purpose)
}

/// Solves a reduced program as it is, and keeps the cuts that the multipliers of its cones are.
fn relax_as_is(
    ctx: &mut Context<'_>,
    reduced: &mut Reduced,
    purpose: Purpose,
) -> RelaxationVerdict {
    let known = ctx.node.warm.take();
    let mut verdict = relax_once(ctx, reduced, purpose, known.as_ref());
    let cuts = ctx.cascade.take_cone_cuts();
    if ctx.program().cone_cuts.is_some()
        && !cuts.is_empty()
        && let RelaxationVerdict::Relaxed { warm, .. } = &mut verdict
        && let Some(state) = warm.take().or_else(|| known.clone())
    {
        let rows = cuts.into_iter().map(|cut| ctx.cone_pool.row(cut)).collect();
        *warm = Some(state.with_cone_rows(rows));
    }
    ctx.node.warm = known;
    verdict
}

/// Solves a reduced program once.
fn relax_once(
    ctx: &mut Context<'_>,
    reduced: &mut Reduced,
    purpose: Purpose,
    warm: Option<&WarmState>,
) -> RelaxationVerdict {
    let is_leaf = purpose != Purpose::Trial && ctx.is_leaf();
    let question = RelaxationQuestion {
        purpose: if is_leaf { Purpose::Leaf } else { purpose },
        cutoff: ctx.tree.cutoff(),
        options: ctx.options(),
        constant: ctx.program().constant,
        look_for_descent: purpose == Purpose::Root,
        token: &ctx.token,
        warm,
    };
    ctx.cascade.solve(reduced, &question)
}

/// Solves a reduced program with cuts in place of its cones, and cuts off its points while that
/// lifts the bound.
fn relax_in_rounds(
    ctx: &mut Context<'_>,
    reduced: &mut Reduced,
    purpose: Purpose,
) -> RelaxationVerdict {
    let (place, own) = (reduced.places(), reduced.rows.len());
    let mut warm = ctx.node.warm.clone();
    let mut rows = warm.as_ref().map_or(Vec::new(), |warm| warm.cone_rows().to_vec());
    append_cone_rows(&rows, reduced, &place);
    let mut round = if purpose == Purpose::Node { Purpose::Round } else { purpose };
    let mut verdict = relax_once(ctx, reduced, round, warm.as_ref());
    let mut last = f64::NEG_INFINITY;
    for _ in 0..MAX_CONE_ROUNDS {
        let RelaxationVerdict::Relaxed { bound, x, warm: state, converged, .. } = &verdict else {
            break;
        };
        let (bound, cutoff) = (*bound, ctx.tree.cutoff());
        if purpose == Purpose::Trial || bound >= cutoff || ctx.token.is_over() {
            break;
        }
        if round == Purpose::Round && !converged {
            reduced.truncate_rows(own);
            return relax_with_cones(ctx, reduced, purpose);
        }
        let room = if cutoff.is_finite() { cutoff - last } else { last.abs().max(1.0) };
        if last.is_finite() && bound - last <= CONE_LIFT * room {
            break;
        }
        let cuts = separate_cones(reduced, x);
        if cuts.is_empty() {
            break;
        }
        warm = state.clone().or(warm);
        for cut in cuts {
            let row = ctx.cone_pool.row(cut);
            reduced.append_row(&row.cut.terms, &place, row.name);
            rows.push(row);
        }
        (round, last) = (Purpose::Round, bound);
        let next = relax_once(ctx, reduced, round, warm.as_ref());
        ctx.cascade.reuse(std::mem::replace(&mut verdict, next));
    }
    if let RelaxationVerdict::Relaxed { y, warm: state, .. } = &mut verdict {
        note_cone_rows(&mut rows, reduced, own, y);
        *state = state.take().or(warm).map(|state| state.with_cone_rows(rows));
    }
    verdict
}

/// As [`relax`], with multipliers for a later solve, if they are kept.
pub(super) fn relax_and_keep(
    ctx: &mut Context<'_>,
    projection: &mut Projection,
    purpose: Purpose,
) -> (RelaxationVerdict, Option<Arc<ProofMultipliers>>) {
    let verdict = relax_with_cuts(ctx, projection, purpose);
    let (x, y) = match &verdict {
        RelaxationVerdict::Refuted(y) => (None, y),
        RelaxationVerdict::Relaxed { x, y, .. } => (Some(x), y),
        _ => return (verdict, None),
    };
    let multipliers = ctx.tree.keeps_duals().then(|| {
        let x = x.map_or(Vec::new(), |x| projection.reduced.lift(x));
        let y = projection.multipliers(y, ctx.program().row_count());
        Arc::new(ProofMultipliers { x, y })
    });
    (verdict, multipliers)
}

/// A bound of the leaf of the domain among the points that are better than the best one. Columns of
/// cones often have bounds only there, and a bound is as rough as the columns of its multipliers
/// are wide.
pub(super) fn bound_below_cutoff(ctx: &mut Context<'_>) -> f64 {
    let activity = ctx.clock.switch(Activity::Propagation);
    let (program, mark) = (ctx.program(), ctx.node.domain.mark());
    let cutoff = ctx.propagator.set_cutoff(program, ctx.tree.cutoff());
    let result = ctx.propagator.propagate_since(program, &mut ctx.node.domain, mark);
    ctx.clock.switch(activity);
    let mut bound = f64::NEG_INFINITY;
    if cutoff.is_finite() && (result.is_err() || ctx.node.domain.mark() > mark) {
        bound = match result.is_ok().then(|| reduce_node(ctx)).flatten() {
            None => ctx.tree.strengthen(cutoff),
            Some(mut reduced) => {
                let verdict = relax(ctx, &mut reduced, Purpose::Node);
                let found = match &verdict {
                    RelaxationVerdict::Refuted(_) => cutoff,
                    RelaxationVerdict::Relaxed { bound, .. } => bound.min(cutoff),
                    _ => f64::NEG_INFINITY,
                };
                ctx.cascade.reuse(verdict);
                ctx.cascade.reducer().reuse(reduced);
                ctx.tree.strengthen(found)
            }
        };
    }
    ctx.node.domain.undo_to(mark);
    bound
}

/// The relaxation of the exact program at the node of the domain.
pub(super) struct ExactRelaxation {
    /// A proved bound; infinite if there is no point.
    pub(super) bound: f64,
    /// The relaxed point.
    pub(super) point: Option<Vec<f64>>,
}

/// Relaxes the exact program at the node of the domain; `None` if the node was relaxed exactly
/// before.
///
/// Tighter costs and rows are those of whole integers. Where a relaxed point is whole up to a
/// tolerance only, the cost may be a little too low: by what a steep slope makes of `1e-7`.
/// Splitting such a node further and further would not lift its bound.
pub(super) fn relax_exactly(ctx: &mut Context<'_>) -> Option<ExactRelaxation> {
    let exact = ctx.task().exact?;
    let is_linear = exact.quadratic.compute_nnz() == 0 && exact.cones.is_empty();
    if std::ptr::eq(exact, ctx.program()) || is_linear {
        return None;
    }
    let activity = ctx.clock.switch(Activity::Reduction);
    let reduced = ctx.cascade.reducer().reduce(exact, &ctx.node.domain);
    ctx.clock.switch(activity);
    // Nothing below the cutoff that the domain was propagated with.
    let refuted = ExactRelaxation { bound: ctx.tree.strengthen(ctx.node.cutoff), point: None };
    let Some(reduced) = reduced else { return Some(refuted) };
    let warm = ctx.node.warm.take();
    let mut projection = project_reduced(ctx, reduced);
    let verdict = relax(ctx, &mut projection.reduced, Purpose::Node);
    ctx.node.warm = warm;
    let found = match &verdict {
        RelaxationVerdict::Refuted(_) => Some(refuted),
        RelaxationVerdict::Relaxed { bound, x, converged, .. } => {
            let point = converged.then(|| projection.lift(x));
            Some(ExactRelaxation { bound: ctx.tree.strengthen(bound.min(ctx.node.cutoff)), point })
        }
        _ => None,
    };
    ctx.cascade.reuse(verdict);
    ctx.cascade.reducer().reuse_projection(projection);
    found
}
