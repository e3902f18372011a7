//! Splits of a node, and what its children inherit.

use std::sync::Arc;

use super::strong_branching::ChildTrial;
use crate::presolve::Domain;
use crate::search::context::Context;
use crate::search::local_bounds::add_facts;
use crate::search::node::{Decision, KnownRelaxation};
use crate::search::saved_tree::ProofMultipliers;

/// The relaxed point of the current node.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RelaxedPoint<'x> {
    /// The point, with whole values for indifferent binaries.
    pub(crate) x: &'x [f64],
    /// The point before indifferent binaries outside all groups got whole values.
    pub(crate) raw: &'x [f64],
    /// The proved bound of the node.
    pub(crate) bound: f64,
}

/// A child of a split: its decisions, its bound, and the relaxation of its trial if there was one.
pub(crate) struct Child {
    pub(crate) decisions: Vec<Decision>,
    pub(crate) bound: f64,
    pub(crate) known: Option<Box<KnownRelaxation>>,
    /// The multipliers that proved its bound, if they are kept.
    pub(crate) multipliers: Option<Arc<ProofMultipliers>>,
}

/// A split of a node.
pub(crate) struct Split {
    /// The child to visit first is in front. No child: all of the node is closed.
    pub(crate) children: Vec<Child>,
    /// Whether the children leave out a part of the node, which was refuted or is beyond the
    /// cutoff.
    pub(crate) closed: bool,
}

impl Split {
    /// No child, because all of the node is refuted or beyond the cutoff.
    pub(super) fn nothing() -> Self {
        Split { children: Vec::new(), closed: true }
    }

    /// Two children.
    pub(super) fn both(decisions: [Decision; 2], bound: f64) -> Self {
        let child = |d| Child { decisions: vec![d], bound, known: None, multipliers: None };
        Split { children: decisions.map(child).into(), closed: false }
    }

    /// One child; the other side is closed.
    fn only(decision: Decision, bound: f64) -> Self {
        Split {
            children: vec![Child {
                decisions: vec![decision],
                bound,
                known: None,
                multipliers: None,
            }],
            closed: true,
        }
    }

    /// One child, which is the same node with tighter bounds.
    pub(super) fn again(bound: f64) -> Self {
        Split {
            children: vec![Child { decisions: Vec::new(), bound, known: None, multipliers: None }],
            closed: true,
        }
    }
}

impl Child {
    /// A child that was tried.
    pub(super) fn tried(decision: Decision, trial: ChildTrial, bound: f64) -> Self {
        let ChildTrial { bound: own, known, multipliers, .. } = trial;
        Child { decisions: vec![decision], bound: own.max(bound), known, multipliers }
    }
}

/// Goes on with one side of a column, whose other side is closed. If the leaves of the tree are
/// kept, the result is a split with one child.
pub(super) fn keep_only(ctx: &mut Context<'_>, side: Decision, bound: f64) -> Result<(), Split> {
    if ctx.options().parts().keep_leaves {
        return Err(Split::only(side, bound));
    }
    add_facts(ctx, &[side]).map_err(|_| Split::nothing())
}

/// Both sides of the value of a relaxation, `x <= floor` and `x >= floor + 1`, the nearer one
/// first.
pub(super) fn both_sides(domain: &Domain, column: usize, value: f64) -> [Decision; 2] {
    let [lower, upper] = domain.bounds(column);
    let value =
        if value.is_finite() { value.clamp(lower, upper) } else { lower.max(upper.min(0.0)) };
    // Integral values are split so that both sides are smaller than the whole.
    let below = value.floor().clamp(lower, (upper - 1.0).max(lower));
    let down = Decision { column, is_upper: true, value: below };
    let up = Decision { column, is_upper: false, value: below + 1.0 };
    if value - below > 0.5 { [up, down] } else { [down, up] }
}
