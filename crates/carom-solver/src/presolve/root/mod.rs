//! Presolve before the search: a smaller program with the same optimum, and the way back.
//!
//! Each [`PresolveRule`] has its own file. They are applied in turn until none finds anything; then
//! `blocks` finds independent parts.
//!
//! # Cones
//!
//! A column of a second-order cone keeps its place (`WorkingProgram::is_held`), and the cones are
//! carried over. Rules are right with cones for one of three reasons:
//!
//! * They conclude from rows and bounds what holds at every point, so further conditions change
//!   nothing: singleton rows, redundant rows, parallel rows, coefficients, exclusive rows. A row
//!   that forces columns stays if one of them is in a cone: a cone may turn a rounding of its head
//!   into a large change of its tail.
//! * They put a column in terms of others, or fix or merge it: fixed columns (one of a cone leaves
//!   rows and objective, and stays), complements, far columns, binary codes, doubletons,
//!   lineality, slack columns, implied free columns, parallel columns, open integers. The columns
//!   that go or move are in no cone, so that the cones do not change.
//! * They move a column while all others stay, at no cost, until something stops it: implied
//!   binaries, held columns, dominated columns. Columns of cones are not moved, and cones do not
//!   stop others. What needs multipliers is left out (see `dominated_columns`).
//!
//! `cones` makes the cones themselves shorter, and frees columns. At the end constant heads of
//! cones become columns that binaries switch off, see [`tighten_switched_cones`], and heads lose
//! what they have too much while a binary is off, see [`tighten_conditional_cones`]. Multipliers of
//! programs with cones are not restored.

mod activity_range;
mod binary_codes;
mod blocks;
mod coefficients;
mod complements;
mod cones;
mod determined_columns;
mod dominated_columns;
mod doubletons;
mod exclusive_rows;
mod far_columns;
mod fixed_columns;
mod held_columns;
mod implied_binaries;
mod implied_free;
mod lineality;
mod open_integers;
mod parallel_columns;
mod parallel_rows;
mod postsolve;
mod redundant_rows;
mod singleton_rows;
mod slack_columns;
mod substitute;
mod units;
mod working_program;

pub use blocks::{ProgramBlock, blocks};
pub(crate) use lineality::shifts;
pub use postsolve::Presolved;
pub(crate) use postsolve::{Origins, Postsolve};

use crate::error::Error;
use crate::presolve::{tighten_conditional_cones, tighten_switched_cones};
use crate::program::Program;
use crate::solver::StopToken;
use working_program::{Infeasible, WorkingProgram};

/// The rules of the presolve before the search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum PresolveRule {
    /// Columns far from 0 are measured from a bound.
    FarColumns,
    /// Columns with one value left are put into rows and objective.
    FixedColumns,
    /// Rows over one column become bounds.
    SingletonRows,
    /// Sides of rows that the bounds imply are dropped.
    RedundantRows,
    /// Rows that are multiples of another one are merged into it.
    ParallelRows,
    /// Cones become shorter, bounds or rows.
    Cones,
    /// Binaries are replaced by their complements where rows say "exactly one" or "at least one" of
    /// these.
    Complements,
    /// Columns of which exactly one is 1, as the code of some binaries determines, become binaries.
    BinaryCodes,
    /// Equalities over two columns replace one of them.
    Doubletons,
    /// If columns can be shifted together without changing any row or the objective, one of them is
    /// fixed.
    Lineality,
    /// Continuous columns that are in one row only become part of its limits.
    SlackColumns,
    /// Columns whose bounds an equality implies are replaced by it.
    ImpliedFree,
    /// Columns between 0 and 1 that are whole in some optimum become binaries.
    ImpliedBinaries,
    /// The only row that keeps a column from moving becomes an equality.
    HeldColumns,
    /// Columns whose reduced cost has a known sign are fixed at a bound.
    DominatedColumns,
    /// Columns that are multiples of another one are merged into it.
    ParallelColumns,
    /// Coefficients and limits of rows with integers are tightened.
    Coefficients,
    /// Rows that differ in binaries of which at most one is 1 become one row.
    ExclusiveRows,
    /// Integers without bounds are taken out of equalities over whole numbers.
    OpenIntegers,
}

impl PresolveRule {
    /// All rules, in the order of their application.
    pub const ALL: [PresolveRule; 19] = [
        PresolveRule::FarColumns,
        PresolveRule::FixedColumns,
        PresolveRule::SingletonRows,
        PresolveRule::RedundantRows,
        PresolveRule::ParallelRows,
        PresolveRule::Cones,
        PresolveRule::Complements,
        PresolveRule::BinaryCodes,
        PresolveRule::Doubletons,
        PresolveRule::Lineality,
        PresolveRule::SlackColumns,
        PresolveRule::ImpliedFree,
        PresolveRule::ImpliedBinaries,
        PresolveRule::HeldColumns,
        PresolveRule::DominatedColumns,
        PresolveRule::ParallelColumns,
        PresolveRule::Coefficients,
        PresolveRule::ExclusiveRows,
        PresolveRule::OpenIntegers,
    ];

    /// The rules that keep the meaning of every remaining column, and every assignment of the
    /// integral ones that has a point. They suit programs whose columns are referred to from
    /// outside.
    pub const FAITHFUL: [PresolveRule; 10] = [
        PresolveRule::FixedColumns,
        PresolveRule::SingletonRows,
        PresolveRule::RedundantRows,
        PresolveRule::ParallelRows,
        PresolveRule::Cones,
        PresolveRule::Doubletons,
        PresolveRule::SlackColumns,
        PresolveRule::ImpliedFree,
        PresolveRule::Coefficients,
        PresolveRule::ExclusiveRows,
    ];

    fn apply(self, work: &mut WorkingProgram) -> Result<usize, Infeasible> {
        match self {
            PresolveRule::FarColumns => {
                Ok(work.each_column(work.live_columns(), far_columns::apply))
            }
            PresolveRule::FixedColumns => Ok(fixed_columns::apply(work)),
            PresolveRule::SingletonRows => work.each_row(singleton_rows::apply),
            PresolveRule::RedundantRows => work.each_row(redundant_rows::apply),
            PresolveRule::ParallelRows => parallel_rows::apply(work),
            PresolveRule::Cones => cones::apply(work),
            PresolveRule::Complements => Ok(complements::apply(work)),
            PresolveRule::BinaryCodes => {
                work.each_row(|work, row| Ok(binary_codes::apply(work, row)))
            }
            PresolveRule::Doubletons => work.each_row(|work, row| Ok(doubletons::apply(work, row))),
            PresolveRule::Lineality => Ok(lineality::apply(work)),
            PresolveRule::SlackColumns => {
                Ok(work.each_column(work.live_columns(), slack_columns::apply))
            }
            PresolveRule::ImpliedFree => {
                work.each_row(|work, row| Ok(implied_free::apply(work, row)))
            }
            PresolveRule::ImpliedBinaries => Ok(implied_binaries::apply(work)),
            PresolveRule::HeldColumns => {
                Ok(work.each_column(work.live_columns(), held_columns::apply))
            }
            PresolveRule::DominatedColumns => Ok(dominated_columns::apply(work)),
            PresolveRule::ParallelColumns => Ok(parallel_columns::apply(work)),
            PresolveRule::Coefficients => work.each_row(coefficients::apply),
            PresolveRule::ExclusiveRows => Ok(exclusive_rows::apply(work)),
            PresolveRule::OpenIntegers => Ok(open_integers::apply(work)),
        }
    }
}

/// The result of [`presolve`].
#[derive(Debug)]
pub enum Presolve {
    /// An equivalent program and the way back.
    Presolved(Box<Presolved>),
    /// Rows and bounds contradict each other.
    Infeasible,
    /// The token was over before the rules came to their end.
    Stopped,
}

/// Most rounds of all rules; each is linear in the entries, and nearly all programs need fewer.
const MAX_RULE_ROUNDS: usize = 30;

/// Applies rules to a program, in their order, repeatedly until nothing changes.
///
/// # Errors
///
/// [`ErrorKind::Allocation`](crate::error::ErrorKind::Allocation) when the matrices cannot be
/// allocated.
pub fn presolve(
    program: &Program,
    rules: &[PresolveRule],
    token: &StopToken,
) -> Result<Presolve, Error> {
    presolve_around(program, &[], true, rules, token)
}

/// As [`presolve`], for every value of some continuous columns within their bounds. These columns
/// stay, with their bounds, and no conclusion depends on their values.
///
/// # Errors
///
/// Those of [`presolve`].
pub(crate) fn presolve_around(
    program: &Program,
    given: &[usize],
    may_scale: bool,
    rules: &[PresolveRule],
    token: &StopToken,
) -> Result<Presolve, Error> {
    let mut work = WorkingProgram::new(program, token);
    given.iter().for_each(|&j| work.given[j] = true);
    if may_scale {
        units::apply(&mut work);
    }
    let determined = determined_columns::apply(&mut work, rules.is_empty());
    match determined.and_then(|()| reduce(&mut work, rules, token)) {
        Err(Infeasible) => Ok(Presolve::Infeasible),
        Ok(()) if token.is_over() => Ok(Presolve::Stopped),
        Ok(()) => {
            let mut presolved = work.finish()?;
            // Columns and rows that this adds are not of the original.
            if !rules.is_empty() && !presolved.program.cones.is_empty() {
                for tighten in [tighten_switched_cones, tighten_conditional_cones] {
                    let tighter = tighten(&presolved.program, token);
                    presolved.program = tighter.unwrap_or(presolved.program);
                }
            }
            Ok(Presolve::Presolved(Box::new(presolved)))
        }
    }
}

/// Applies the rules until they find nothing more, or the token is over.
fn reduce(
    work: &mut WorkingProgram,
    rules: &[PresolveRule],
    token: &StopToken,
) -> Result<(), Infeasible> {
    work.settle()?;
    let mut changes = 0;
    // By rule, the changes when it was last applied.
    let mut seen = vec![None; rules.len()];
    for _ in 0..MAX_RULE_ROUNDS {
        let before = changes;
        for (rule, seen) in rules.iter().zip(&mut seen) {
            if token.is_over() {
                return Ok(());
            }
            if seen.replace(changes) != Some(changes) {
                changes += rule.apply(work)?;
            }
        }
        if changes == before {
            break;
        }
    }
    Ok(())
}
