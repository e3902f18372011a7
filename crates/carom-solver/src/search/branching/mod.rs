//! The choice of the column to split, and of the child to visit first.
//!
//! * Without an objective, only infeasibility matters, and under big-M rows fractionality says
//!   little about it. Columns are split latest first (by the step of their name, else by position),
//!   because a late decision propagates backwards through the dynamics.
//! * With an objective, columns are split by pseudocosts: the average growth of the bound per
//!   unit of fraction, initialised by trying both children of a column (strong branching). A child
//!   that the trial refutes is never queued. Disjunctions are split into their sides if the tree is
//!   expected to grow more slowly that way.

mod column;
mod disjunction;
mod growth;
mod parameters;
mod split;
mod strong_branching;
mod strong_fixing;

use column::choose_column;
use disjunction::split_disjunction;
pub use growth::growth_rate;
use parameters::BRANCHING;
use split::both_sides;
pub(super) use split::{Child, RelaxedPoint, Split};
use strong_branching::ChildTrial;
pub use strong_fixing::FixingCredit;
use strong_fixing::fix_by_trials;

use super::context::Context;
use super::pseudocosts::{LEAST_GAIN, Pseudocosts};
use crate::solver::BranchingRule;

/// The experience of a worker with splits.
pub(super) struct Branching {
    pub(super) pseudocosts: Pseudocosts,
    credit: FixingCredit,
}

impl Branching {
    pub(super) fn new(columns: usize) -> Self {
        Branching { pseudocosts: Pseudocosts::new(columns), credit: FixingCredit::default() }
    }
}

/// Chooses a split of the current node.
pub(super) fn choose_split(
    ctx: &mut Context<'_>,
    branching: &mut Branching,
    relaxed: RelaxedPoint<'_>,
) -> Split {
    let RelaxedPoint { x, bound, .. } = relaxed;
    let open = open_columns(ctx, x);
    let program = ctx.program();
    let late = |j: &usize| (program.step[*j].unwrap_or(*j), std::cmp::Reverse(*j));
    let Some(&latest) = open.iter().max_by_key(|j| late(j)) else {
        return Split::again(bound);
    };
    let late_first = match ctx.options().branching {
        BranchingRule::LatestFirst => true,
        BranchingRule::Pseudocosts => false,
        _ => program.is_feasibility_problem(),
    };
    if late_first || bound == f64::NEG_INFINITY {
        return Split::both(both_sides(&ctx.node.domain, latest, x[latest]), bound);
    }
    choose_by_gains(ctx, branching, relaxed, &open).unwrap_or_else(|split| split)
}

/// The integers that can be split: the fractional ones, or all that are not fixed if none is.
fn open_columns(ctx: &Context<'_>, x: &[f64]) -> Vec<usize> {
    let integrality = ctx.options().integrality;
    let fractional = |j: usize| (x[j] - x[j].round()).abs() > integrality;
    let integers = ctx.program().integers.iter().copied();
    let mut open: Vec<usize> = integers.filter(|&j| !ctx.node.domain.is_fixed(j)).collect();
    if open.iter().any(|&j| fractional(j)) {
        open.retain(|&j| fractional(j));
    } else if ctx.wants_all() {
        // Points that differ elsewhere are the same to the user.
        let judge = ctx.task().judge;
        let tells: Vec<usize> = open.iter().copied().filter(|&j| judge.tells_apart(j)).collect();
        open = if tells.is_empty() { open } else { tells };
    }
    open
}

/// Chooses one of some open columns, or a disjunction, by the expected gains. Returns a split as
/// `Err` if trials have decided it.
fn choose_by_gains(
    ctx: &mut Context<'_>,
    branching: &mut Branching,
    relaxed: RelaxedPoint<'_>,
    open: &[usize],
) -> Result<Split, Split> {
    let RelaxedPoint { x, bound, .. } = relaxed;
    let Branching { pseudocosts, credit } = branching;
    let disjunction = match split_disjunction(ctx, pseudocosts, x, bound) {
        Some((split, _)) if split.closed => return Ok(split),
        open => open,
    };
    let beside = disjunction.is_some();
    let chosen = choose_column(ctx, pseudocosts, relaxed, open, beside)?;
    let gains_of =
        |pseudocosts: &Pseudocosts, (j, tried): &(usize, Option<[ChildTrial; 2]>)| match tried {
            Some(trials) => trials.each_ref().map(|trial| trial.gain.max(LEAST_GAIN)),
            None => pseudocosts.gains(*j, x[*j]),
        };
    let grows = ctx.tree.saved_tree().is_none()
        || chosen.column.as_ref().is_some_and(|column| {
            let rate = growth_rate(&gains_of(pseudocosts, column));
            (rate * (ctx.tree.cutoff() - bound)).exp() >= BRANCHING.fixing_tree
        });
    let fixed = grows && fix_by_trials(ctx, credit, pseudocosts, relaxed)? || chosen.fixed;
    let stands = |(j, tried): &(usize, Option<_>)| {
        !ctx.node.domain.is_fixed(*j) && (tried.is_some() || !fixed)
    };
    let Some(column) = chosen.column.filter(stands) else {
        // The same node with tighter bounds.
        return Ok(Split::again(bound));
    };
    if let Some((split, rate)) = disjunction
        && !fixed
        && rate <= growth_rate(&gains_of(pseudocosts, &column))
    {
        return Ok(split);
    }
    let (j, tried) = column;
    let decisions = both_sides(&ctx.node.domain, j, x[j]);
    Ok(match tried {
        None => Split::both(decisions, bound),
        Some(trials) => {
            let child = |(decision, trial)| Child::tried(decision, trial, bound);
            let children = decisions.into_iter().zip(trials).map(child).collect();
            Split { children, closed: fixed }
        }
    })
}
