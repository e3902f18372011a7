//! Reduced-cost fixing: bounds of integers from the multipliers of a relaxation.
//!
//! The multipliers of a relaxation prove how much the objective grows at least per unit by which a
//! column moves away from its bound. Values that would take it beyond the cutoff are removed.

use super::clock::Activity;
use super::context::Context;
use super::local_bounds::add_facts;
use super::node::Decision;
use crate::presolve::Reduced;

/// A whole value is kept when it is missed by less than this (no unit).
const WHOLE_MARGIN: f64 = 1e-6;

/// Tightens integral columns at the current node; `false` when nothing is left of it.
pub(super) fn fix_by_reduced_costs(
    ctx: &mut Context<'_>,
    reduced: &Reduced,
    x: &[f64],
    y: &[f64],
) -> bool {
    let cutoff = ctx.tree.cutoff();
    if cutoff == f64::INFINITY || y.len() != reduced.rows.len() {
        return true;
    }
    let integral = &ctx.program().integral;
    let activity = ctx.clock.switch(Activity::Proof);
    let (bound, slopes) = ctx.cascade.prover().reduced_costs(reduced, x, y);
    let room = (cutoff - bound) + 1e-9 * cutoff.abs().max(1.0);
    let facts = facts(reduced, integral, slopes, room);
    ctx.clock.switch(activity);
    if facts.is_empty() {
        return true;
    }
    ctx.tree.close(ctx.tree.strengthen(cutoff));
    add_facts(ctx, &facts).is_ok()
}

/// The bounds of integral columns beyond which the objective has grown by more than `room`.
fn facts(reduced: &Reduced, integral: &[bool], slopes: &[f64], room: f64) -> Vec<Decision> {
    let mut facts = Vec::new();
    for (k, (&column, &slope)) in reduced.columns.iter().zip(slopes).enumerate() {
        let [lower, upper] = [reduced.lower[k], reduced.upper[k]];
        if !integral[column] || slope == 0.0 {
            continue;
        }
        let reach = room / slope.abs();
        let fact = if slope > 0.0 {
            Decision { column, is_upper: true, value: (lower + reach + WHOLE_MARGIN).floor() }
        } else {
            Decision { column, is_upper: false, value: (upper - reach - WHOLE_MARGIN).ceil() }
        };
        let cuts = if fact.is_upper { fact.value < upper } else { fact.value > lower };
        if cuts && fact.value.is_finite() {
            facts.push(fact);
        }
    }
    facts
}
