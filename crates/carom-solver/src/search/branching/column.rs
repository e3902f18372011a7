//! The column to split, by pseudocosts and strong branching.

use super::parameters::BRANCHING;
use super::split::{Child, RelaxedPoint, Split, both_sides, keep_only};
use super::strong_branching::{ChildTrial, try_child};
use crate::search::context::Context;
use crate::search::pseudocosts::{LEAST_GAIN, Pseudocosts};

/// The column that a node is split at.
pub(super) struct Chosen {
    /// The column, and its children if they were tried; `None` if all columns are fixed by now.
    pub(super) column: Option<(usize, Option<[ChildTrial; 2]>)>,
    /// Whether trials have closed sides of columns.
    pub(super) fixed: bool,
}

/// The result of a trial of a column.
enum ColumnTrial {
    /// One side is closed, and the column decided.
    Fixed,
    /// The gain of raising the column was known, and that of lowering it has been tried.
    Half,
    Both([ChildTrial; 2]),
}

/// Chooses the best of some open columns. Compares the most promising ones first, and tries those
/// whose gains are not known yet. Returns a split as `Err` if a trial leaves no child of the node,
/// or one.
pub(super) fn choose_column(
    ctx: &mut Context<'_>,
    pseudocosts: &mut Pseudocosts,
    relaxed: RelaxedPoint<'_>,
    open: &[usize],
    beside: bool,
) -> Result<Chosen, Split> {
    let x = relaxed.x;
    let mut ranked: Vec<(f64, usize)> =
        open.iter().map(|&j| (pseudocosts.score(j, x[j]), j)).collect();
    ranked.sort_by(|a, b| {
        let distance = |j: usize| (x[j] - x[j].round()).abs();
        let fractional = || distance(b.1).total_cmp(&distance(a.1));
        b.0.total_cmp(&a.0).then_with(fractional).then(a.1.cmp(&b.1))
    });
    let (mut trials, mut idle) =
        (if beside { BRANCHING.trials_beside_disjunction } else { BRANCHING.trials }, 0);
    let (mut most, mut best) = (f64::NEG_INFINITY, Chosen { column: None, fixed: false });
    for (expected, j) in ranked {
        if ctx.node.domain.is_fixed(j) {
            continue;
        }
        let (mut score, mut tried) = (expected, None);
        let wanted = trials > 0 && idle < BRANCHING.idle_trials && !pseudocosts.known(j);
        if wanted && !ctx.token.is_over() {
            trials -= 1;
            match try_column(ctx, pseudocosts, relaxed, j, beside)? {
                ColumnTrial::Fixed => {
                    (best.fixed, idle) = (true, 0);
                    continue;
                }
                ColumnTrial::Half => score = pseudocosts.score(j, x[j]),
                ColumnTrial::Both(children) => {
                    let [a, b] = children.each_ref().map(|child| child.gain.max(LEAST_GAIN));
                    (score, tried) = (a * b, Some(children));
                }
            }
            idle = if score > most { 0 } else { idle + 1 };
        }
        if score > most && !ctx.node.domain.is_fixed(j) {
            (most, best.column) = (score, Some((j, tried)));
        }
    }
    Ok(best)
}

/// Tries the children of a column.
fn try_column(
    ctx: &mut Context<'_>,
    pseudocosts: &mut Pseudocosts,
    RelaxedPoint { x, bound, .. }: RelaxedPoint<'_>,
    j: usize,
    beside: bool,
) -> Result<ColumnTrial, Split> {
    // The far child is the likelier one to be closed; then its sibling is the node itself with a
    // tighter bound, which may wait for more of them.
    let [mut near, mut far] = both_sides(&ctx.node.domain, j, x[j]);
    // The rise of a side was tried with its disjunction.
    let half = beside && pseudocosts.known_up(j);
    if half && near.is_upper {
        (near, far) = (far, near);
    }
    let Some(b) = try_child(ctx, pseudocosts, far, x[j], bound) else {
        keep_only(ctx, near, bound)?;
        return Ok(ColumnTrial::Fixed);
    };
    if half {
        return Ok(ColumnTrial::Half);
    }
    let Some(a) = try_child(ctx, pseudocosts, near, x[j], bound) else {
        let children = vec![Child::tried(far, b, bound)];
        return Err(Split { children, closed: true });
    };
    Ok(ColumnTrial::Both([a, b]))
}
