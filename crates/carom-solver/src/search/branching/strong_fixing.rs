//! Strong-branching fixings: trying values that the relaxed point of a node does not take.
//!
//! A binary that can be 0 or 1 with the same dynamics is useless for branching, but one of its
//! values may be worse than the cutoff; then it is fixed to the other one. On some programs this
//! excludes most impacts. On others, such trials find nothing, and small trees need none. So trials
//! are paid from a credit: each node adds a little to it, and each fixing adds more. In a prepared
//! solve, a node whose tree is expected to end at once does without, too.

use super::parameters::BRANCHING;
use super::split::{RelaxedPoint, Split, both_sides, keep_only};
use super::strong_branching::try_child;
use crate::search::context::Context;
use crate::search::pseudocosts::Pseudocosts;

/// The credit of one worker; none at first.
#[derive(Debug, Default)]
pub struct FixingCredit {
    credit: f64,
}

impl FixingCredit {
    /// Whether there is credit for a trial.
    pub fn may_try(&mut self) -> bool {
        if self.credit < 1.0 {
            self.credit += BRANCHING.credit_per_node;
            return false;
        }
        true
    }

    /// Books a trial, and whether it fixed a column.
    pub fn book(&mut self, fixed: bool) {
        let gain = if fixed { BRANCHING.credit_per_fixing } else { -1.0 };
        self.credit = (self.credit + gain).min(BRANCHING.fixing_credit);
    }
}

/// Tries the other value of binaries that are whole at the point `x` and were not at `raw`, those
/// with most choice first. Returns whether any was fixed; `Err` is a split that this leads to.
pub(super) fn fix_by_trials(
    ctx: &mut Context<'_>,
    credit: &mut FixingCredit,
    pseudocosts: &mut Pseudocosts,
    RelaxedPoint { x, raw, bound }: RelaxedPoint<'_>,
) -> Result<bool, Split> {
    let integrality = ctx.options().integrality;
    let away = |value: f64| (value - value.round()).abs();
    let settled = |j: &usize| away(raw[*j]) > integrality && away(x[*j]) <= integrality;
    let mut settled: Vec<usize> = ctx.root().ungrouped.iter().copied().filter(settled).collect();
    settled.sort_by(|&a, &b| away(raw[b]).total_cmp(&away(raw[a])).then(a.cmp(&b)));
    let (mut idle, mut any) = (0, false);
    for j in settled {
        if idle == BRANCHING.fixing_idle_trials || !credit.may_try() {
            break;
        }
        if ctx.node.domain.is_fixed(j) {
            continue;
        }
        let [near, far] = both_sides(&ctx.node.domain, j, x[j]);
        let closed = try_child(ctx, pseudocosts, far, x[j], bound).is_none();
        credit.book(closed);
        if closed {
            keep_only(ctx, near, bound)?;
            (idle, any) = (0, true);
        } else {
            idle += 1;
        }
    }
    Ok(any)
}
