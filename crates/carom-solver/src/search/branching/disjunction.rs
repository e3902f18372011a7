//! Splitting a disjunction into its sides.
//!
//! A covering row `z_1 + ... + z_k >= 1` means that at least one of `k` sides holds. If its columns
//! are split one by one, only the children that set one to 1 move the relaxation; the others
//! exclude one side, leave the relaxed point where it was, and cost a node each. Here the node gets
//! one child per side, and the child of side `s` excludes the sides before it. Sides are scored
//! like columns, by the pseudocosts of setting them to 1, initialised by strong branching. If
//! excluding a side moves the bound as well, splitting a column may be better. Of the best
//! disjunction and the best column, the one is split for which the tree is expected to grow less.

use std::collections::BTreeMap;

use super::growth::growth_rate;
use super::parameters::BRANCHING;
use super::split::{Child, Split};
use super::strong_branching::{ChildTrial, try_child};
use crate::search::context::Context;
use crate::search::node::Decision;
use crate::search::pseudocosts::{LEAST_GAIN, Pseudocosts};

/// A disjunction that the relaxed point violates.
struct Violated {
    /// The sides that are left, the nearest to holding first.
    sides: Vec<usize>,
    score: f64,
}

/// Splits a violated disjunction, if there is one. Also returns the rate at which the tree would
/// grow.
pub(super) fn split_disjunction(
    ctx: &mut Context<'_>,
    pseudocosts: &mut Pseudocosts,
    x: &[f64],
    bound: f64,
) -> Option<(Split, f64)> {
    let near = 1.0 - ctx.options().integrality;
    let mut violated = violated(ctx, near, x);
    if violated.is_empty() {
        return None;
    }
    // Those least near to holding first: their sides are likely to cost most.
    let nearest = |v: &Violated| x[v.sides[0]];
    violated.sort_by(|a, b| nearest(a).total_cmp(&nearest(b)).then(a.sides.cmp(&b.sides)));
    let mut trials = BRANCHING.trials;
    let mut tried = BTreeMap::new();
    for disjunction in &mut violated {
        if trials == 0 {
            break;
        }
        let mut left = Vec::with_capacity(disjunction.sides.len());
        for &j in &disjunction.sides {
            if !pseudocosts.known_up(j) && trials > 0 {
                trials -= 1;
                let Some(trial) = try_child(ctx, pseudocosts, on(j), x[j], bound) else { continue };
                tried.insert(j, trial);
            }
            left.push(j);
        }
        if left.len() < disjunction.sides.len() {
            // Some sides are closed: that is as good as a split.
            disjunction.sides = left;
            return Some((sides(&disjunction.sides, bound, tried, true), 0.0));
        }
    }
    let average = average_gain(pseudocosts, &violated);
    for disjunction in &mut violated {
        disjunction.score = score_of(pseudocosts, &disjunction.sides, x, average);
    }
    let best = violated
        .iter()
        .max_by(|a, b| a.score.total_cmp(&b.score).then_with(|| b.sides.cmp(&a.sides)))?;
    let rate = growth_rate(&gains_of(pseudocosts, &best.sides, x, average));
    Some((sides(&best.sides, bound, tried, false), rate))
}

/// The disjunctions that a point violates, where `near` counts as holding.
fn violated(ctx: &Context<'_>, near: f64, x: &[f64]) -> Vec<Violated> {
    let domain = &ctx.node.domain;
    let mut violated = Vec::new();
    for &row in &ctx.root().covers {
        let cover = ctx.program().row(row).0;
        if cover.iter().any(|&j| x[j] >= near || domain.lower(j) == 1.0) {
            continue;
        }
        let mut sides: Vec<usize> =
            cover.iter().copied().filter(|&j| domain.upper(j) > 0.0).collect();
        sides.sort_by(|&a, &b| x[b].total_cmp(&x[a]).then(a.cmp(&b)));
        if !sides.is_empty() {
            violated.push(Violated { sides, score: 0.0 });
        }
    }
    violated
}

/// Mean gain of turning a side on, per unit of fraction, over what is known.
fn average_gain(pseudocosts: &Pseudocosts, violated: &[Violated]) -> f64 {
    let known = violated.iter().flat_map(|v| &v.sides);
    let gains: Vec<f64> = known.filter_map(|&j| pseudocosts.gain_up(j, 1.0)).collect();
    gains.iter().sum::<f64>() / (gains.len().max(1) as f64)
}

/// The geometric mean of the sides' gains, in the unit of a product of two.
fn score_of(pseudocosts: &Pseudocosts, sides: &[usize], x: &[f64], average: f64) -> f64 {
    let log: f64 = gains_of(pseudocosts, sides, x, average).into_iter().map(f64::ln).sum();
    log / (sides.len() as f64) - (sides.len() as f64).ln()
}

/// The expected gain of turning each side on.
fn gains_of(pseudocosts: &Pseudocosts, sides: &[usize], x: &[f64], average: f64) -> Vec<f64> {
    let gain = |&j: &usize| {
        let fraction = 1.0 - x[j];
        let known = pseudocosts.gain_up(j, fraction);
        known.unwrap_or(average * fraction).max(LEAST_GAIN)
    };
    sides.iter().map(gain).collect()
}

/// The children of a disjunction's sides, with the results of their trials.
fn sides(
    sides: &[usize],
    bound: f64,
    mut tried: BTreeMap<usize, ChildTrial>,
    closed: bool,
) -> Split {
    let child = |k: usize| {
        let off = |&column: &usize| Decision { column, is_upper: true, value: 0.0 };
        let mut decisions: Vec<Decision> = sides[..k].iter().map(off).collect();
        decisions.push(on(sides[k]));
        let Some(mut trial) = tried.remove(&sides[k]) else {
            return Child { decisions, bound, known: None, multipliers: None };
        };
        if let Some(known) = &mut trial.known {
            // The trial did not exclude the sides before it; this one holds without them.
            sides[..k].iter().for_each(|&j| known.point[j] = 0.0);
        }
        let ChildTrial { bound: own, known, multipliers, .. } = trial;
        Child { decisions, bound: own.max(bound), known, multipliers }
    };
    Split { children: (0..sides.len()).map(child).collect(), closed }
}

fn on(column: usize) -> Decision {
    Decision { column, is_upper: false, value: 1.0 }
}
