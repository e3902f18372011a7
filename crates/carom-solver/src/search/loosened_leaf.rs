//! Leaves whose relaxation proves nothing near the optimum, because cones only touch.
//!
//! Only the search for a bound loosens the leaf: the point is judged by the model, as any other.

use super::context::Context;
use super::leaf::offer_loosened;
use super::node_relaxation::{reduce_node, relax};
use crate::relaxation::{Purpose, RelaxationVerdict, loosened};

/// The shares of the tolerance by which a leaf is loosened, one after the other, because presolve
/// may have scaled rows, and points miss their rows a little more than the loosened ones (no unit).
const LOOSENING_SHARES: [f64; 3] = [0.8, 0.08, 0.008];

/// The outcome of a loosened leaf.
pub(super) struct LoosenedLeaf {
    /// A bound of the leaf, also without loosening; infinite if it has no point.
    pub(super) bound: f64,
    /// Whether its point was accepted, or it has none.
    pub(super) is_settled: bool,
}

/// Solves the leaf of the domain with rows and cones that are wider by less than points may miss,
/// and offers its point.
///
/// # Arguments
///
/// * `x`: a point of the leaf that was not good enough.
pub(super) fn settle_loosened(ctx: &mut Context<'_>, x: &[f64]) -> LoosenedLeaf {
    let mut settled = LoosenedLeaf { bound: f64::NEG_INFINITY, is_settled: false };
    let Some(leaf) = reduce_node(ctx) else { return settled };
    // The domain holds no more than what is better than this.
    let cutoff = ctx.tree.strengthen(ctx.node.cutoff);
    for share in LOOSENING_SHARES {
        if settled.bound >= ctx.tree.cutoff() || ctx.token.is_over() {
            break;
        }
        let mut wide = loosened(&leaf, x, share);
        let rows = wide.rows.len();
        let verdict = relax(ctx, &mut wide, Purpose::Node);
        match &verdict {
            RelaxationVerdict::Refuted(_) => {
                settled = LoosenedLeaf { bound: cutoff, is_settled: true };
            }
            RelaxationVerdict::Relaxed { bound, x, .. } => {
                wide.truncate_rows(rows);
                settled.is_settled |= offer_loosened(ctx, &wide, x);
                settled.bound = settled.bound.max(ctx.tree.strengthen(*bound).min(cutoff));
            }
            _ => {}
        }
        ctx.cascade.reuse(verdict);
    }
    settled
}
