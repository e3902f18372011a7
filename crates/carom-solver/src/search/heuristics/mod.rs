//! Primal heuristics, and the times at which they run.

mod allowance;
mod completion;
mod diving;
mod feasibility_jump;
mod jump_value;
mod near_origin;
mod neighbourhood;
mod parameters;
mod penalties;
mod roll_out;
mod rounding;

pub use allowance::Allowance;
pub(super) use completion::complete_start;
use diving::dive_where_it_pays;
pub(super) use feasibility_jump::suits as suits_jumps;
use feasibility_jump::{jump_to_feasibility, mend_rounded};
pub use jump_value::Kinks;
use near_origin::search_near_origin;
use neighbourhood::search_near_incumbent;
use parameters::HEURISTICS;
pub use roll_out::Frontier;
use roll_out::roll_out;
use rounding::{fix_at_cheap_ends, round_and_propagate};

use super::clock::Activity;
use super::context::Context;
use super::leaf::try_assignment;
use super::pseudocosts::Pseudocosts;
use super::trace::span;
use crate::solution::Heuristic;

/// The accounts of the heuristics of one worker.
pub(super) struct HeuristicAccounts {
    /// Nodes since the rounding heuristic last ran.
    since_rounding: u64,
    /// Nodes that this worker has processed.
    nodes: u64,
    diving: Allowance,
    neighbourhood: Allowance,
}

impl HeuristicAccounts {
    pub(super) fn new() -> Self {
        HeuristicAccounts {
            since_rounding: u64::MAX,
            nodes: 0,
            diving: Allowance::default(),
            neighbourhood: Allowance::default(),
        }
    }

    /// Notes that a warm start has made the root smaller, so that its relaxed point is another one.
    /// Then rounding and roll-outs have their turn again, except beside a good point and a small
    /// tree.
    pub(super) fn note_tree_warm_start(&mut self, ctx: &Context<'_>, bound: f64) {
        let large = ctx.tree.saved_tree().is_some_and(|tree| tree.is_large());
        if large || !has_good_point(ctx, bound) {
            self.since_rounding = u64::MAX;
        }
    }

    pub(super) fn count_node(&mut self) {
        self.nodes += 1;
    }
}

/// Whether the best point is a good one: its gap to the bound of the current node is small.
fn has_good_point(ctx: &Context<'_>, bound: f64) -> bool {
    let cutoff = ctx.tree.cutoff();
    cutoff < f64::INFINITY && cutoff - bound <= HEURISTICS.good_point_gap * cutoff.abs()
}

/// Looks for points near the relaxed point of the current node.
pub(super) fn look_for_points(
    ctx: &mut Context<'_>,
    heuristics: &mut HeuristicAccounts,
    pseudocosts: &Pseudocosts,
    point: &[f64],
    bound: f64,
    at_root: bool,
) {
    let on = ctx.options().heuristics;
    let activity = ctx.clock.switch(Activity::Heuristic);
    let whole = ctx.is_integral(point);
    if whole {
        try_whole_point(ctx, point);
    }
    let pause = if ctx.tree.cutoff() == f64::INFINITY {
        HEURISTICS.pause_without_point
    } else {
        HEURISTICS.pause_with_point
    };
    if at_root || heuristics.since_rounding >= pause {
        heuristics.since_rounding = 0;
        // Where a pilot search has tried them at the same root, and beside a good start, they can
        // wait.
        let start = ctx.tree.start().filter(|_| at_root);
        let good = has_good_point(ctx, bound);
        let waits = start.is_some_and(|start| start.is_rounded.unwrap_or(good));
        // A point within the gap of the bound is the best one of the node.
        if on.rounding && !waits && bound < ctx.tree.cutoff() {
            span!(DEBUG, "heuristic", name = "rounding");
            let before = ctx.tree.begin(Heuristic::Rounding);
            let is_rounded = round_and_propagate(ctx, point);
            if at_root && !is_rounded && ctx.tree.cutoff() == f64::INFINITY {
                mend_rounded(ctx, point);
            }
            ctx.tree.end(before);
        }
        let is_closed = bound >= ctx.tree.cutoff();
        if on.roll_out && !waits && !is_closed && !ctx.program().is_feasibility_problem() {
            span!(DEBUG, "heuristic", name = "roll-out");
            let before = ctx.tree.begin(Heuristic::RollOut);
            roll_out(ctx, point);
            ctx.tree.end(before);
        }
    }
    heuristics.since_rounding = heuristics.since_rounding.saturating_add(1);
    if on.diving && !whole {
        dive_where_it_pays(ctx, &mut heuristics.diving, pseudocosts, point, bound);
    }
    if on.neighbourhood && at_root {
        search_near_origin(ctx);
    }
    if on.neighbourhood {
        search_near_incumbent(ctx, &mut heuristics.neighbourhood, heuristics.nodes, point, bound);
    }
    ctx.clock.switch(activity);
}

/// Tries a point before anything is relaxed.
pub(super) fn look_for_first_point(ctx: &mut Context<'_>) {
    span!(DEBUG, "heuristic", name = "first point");
    let activity = ctx.clock.switch(Activity::Heuristic);
    let before = ctx.tree.begin(Heuristic::Rounding);
    // No jumps follow where there are cones.
    let left = ctx.token.left().filter(|_| ctx.program().cones.is_empty());
    let share = left.map(|left| left.mul_f64(HEURISTICS.cheap_ends_share));
    let part = ctx.token.child(share);
    let whole = std::mem::replace(&mut ctx.token, part);
    let found = fix_at_cheap_ends(ctx);
    ctx.token = whole;
    if !found {
        jump_to_feasibility(ctx);
    }
    ctx.tree.end(before);
    ctx.clock.switch(activity);
}

/// Tries a point that has become whole because indifferent binaries got whole values.
pub(super) fn look_for_settled_point(ctx: &mut Context<'_>, raw: &[f64], settled: &[f64]) {
    if raw != settled && ctx.is_integral(settled) {
        let activity = ctx.clock.switch(Activity::Heuristic);
        try_whole_point(ctx, settled);
        ctx.clock.switch(activity);
    }
}

fn try_whole_point(ctx: &mut Context<'_>, point: &[f64]) {
    span!(DEBUG, "heuristic", name = "relaxation");
    let before = ctx.tree.begin(Heuristic::Relaxation);
    try_assignment(ctx, point);
    ctx.tree.end(before);
}
