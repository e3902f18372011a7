//! Columns that soften rows at a price, such as the depth in an obstacle that may be entered.
//!
//! Relaxed points tell little about the integers of such rows, because softening each a little is
//! cheap. With these columns at their lower bounds propagation tells much, so such a point is
//! looked for as well.

use crate::program::Program;
use crate::search::context::Context;
use crate::search::local_bounds::propagate_since;
use crate::tolerance::FEASIBILITY;

/// The continuous columns whose increase costs something and relaxes every row that they are in.
pub(super) fn penalties(program: &Program) -> Vec<usize> {
    let is_penalty = |&j: &usize| {
        let (rows, factors) = program.column(j);
        let relaxes = |(&row, &factor): (&usize, &f64)| match factor > 0.0 {
            true => program.row_upper[row] == f64::INFINITY,
            false => program.row_lower[row] == f64::NEG_INFINITY,
        };
        program.linear[j] > 0.0
            && program.lower[j].is_finite()
            && !rows.is_empty()
            && rows.iter().zip(factors).all(relaxes)
            && program.quadratic_column(j).0.iter().all(|&i| i == j)
    };
    let continuous = (0..program.column_count()).filter(|j| !program.integers.contains(j));
    continuous.filter(is_penalty).collect()
}

/// Whether such a column is above its lower bound at a point.
pub(super) fn pays(program: &Program, penalties: &[usize], point: &[f64]) -> bool {
    penalties.iter().any(|&j| point[j] > program.lower[j] + FEASIBILITY)
}

/// Fixes such columns at their lower bounds. Returns `false` if that is a contradiction; the domain
/// may have changed then.
pub(super) fn forgo(ctx: &mut Context<'_>, penalties: &[usize]) -> bool {
    let mark = ctx.node.domain.mark();
    for &j in penalties {
        let [lower, upper] = ctx.node.domain.bounds(j);
        let least = ctx.program().lower[j];
        if lower > least || upper < least {
            return false;
        }
        ctx.node.fix(j, least);
    }
    propagate_since(ctx, mark).is_ok()
}
