//! A small search near 0, for programs whose integers have bounds beyond all digits.
//!
//! Relaxed points may be anywhere between such bounds, and where a float has no digits after the
//! point, none of them can be rounded to a point. If there are points near 0, a search between
//! closer bounds finds one.

use super::neighbourhood::search_within;
use super::parameters::HEURISTICS;
use crate::program::Program;
use crate::search::context::Context;
use crate::search::trace::span;
use crate::solution::Heuristic;

/// A bound of an integer beyond this is far away.
const FAR_INTEGER_BOUND: f64 = 1e12;

/// The distance from 0, or from the bound that is nearest to it, within which points are looked
/// for.
const NEAR_DISTANCE: f64 = 1e4;

/// Searches near 0 if no point is known and integers have bounds that are far away.
pub(super) fn search_near_origin(ctx: &mut Context<'_>) {
    let base = ctx.program();
    let is_far = |bound: f64| bound.is_finite() && bound.abs() > FAR_INTEGER_BOUND;
    let has_far_bound = |&&j: &&usize| is_far(base.lower[j]) || is_far(base.upper[j]);
    if ctx.tree.cutoff() < f64::INFINITY || base.integers.iter().find(has_far_bound).is_none() {
        return;
    }
    span!(DEBUG, "heuristic", name = "near origin");
    let mut program: Program = base.clone();
    for &j in &base.integers {
        let nearest = 0.0_f64.max(base.lower[j]).min(base.upper[j]);
        program.lower[j] = base.lower[j].max(nearest - NEAR_DISTANCE);
        program.upper[j] = base.upper[j].min(nearest + NEAR_DISTANCE);
    }
    let source = ctx.tree.begin(Heuristic::Neighbourhood);
    // As many nodes as such a search has at most.
    let (nodes, iterations) = (HEURISTICS.neighbourhood_nodes[1], ctx.iterations.max(1));
    search_within(ctx, &program, f64::INFINITY, nodes, iterations);
    ctx.tree.end(source);
}
