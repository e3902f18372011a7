//! The second phase: the program becomes smaller.

use super::binary_curvature::with_raised_squares;
use super::lower::LoweredProgram;
use super::row_judge::RowJudge;
use super::solve::{EarlierResults, Solve};
use crate::error::Error;
use crate::presolve::root::{Presolve, PresolveRule, Presolved, presolve_around};
use crate::search::{Start, with_perspective_cones};
use crate::solver::PoolMode;

/// Largest change of the objective of a point by presolve, relative to the terms (no unit): the
/// point keeps the equalities that were used up to the feasibility tolerance only.
const OBJECTIVE_CHANGE: f64 = 1e-6;

/// The fewest integers of a program whose squares of binaries are raised.
const FEWEST_INTEGERS: usize = 11;

/// The rules by which the program of a solve is presolved.
pub(super) fn rules(solve: &Solve<'_>, known: &EarlierResults<'_>) -> &'static [PresolveRule] {
    let options = solve.options;
    // Leaves are about all columns.
    if known.is_presolved || !options.parts().reductions || options.parts().keep_leaves {
        return &[];
    }
    // Nothing that a start knows may be reduced away, rows may come that speak of all points, and
    // the best points differ in integers that other rules would decide.
    let wants_all = options.pool > 1 && options.pool_mode == PoolMode::Best;
    let expects_rows = solve.rows.is_some_and(RowJudge::expects_rows);
    let is_faithful = known.start.is_some() || expects_rows || wants_all;
    if is_faithful { &PresolveRule::FAITHFUL } else { &PresolveRule::ALL }
}

/// The result of the phase of presolve.
pub(super) enum PresolveOutcome<'a> {
    Presolved(Presolution<'a>),
    Infeasible,
    /// A limit came first.
    Stopped,
}

/// Presolves a program by some rules, unless that was done for all values of the parameters.
pub(super) fn presolve<'a>(
    solve: &Solve<'_>,
    known: &EarlierResults<'_>,
    lowered: &'a LoweredProgram,
    rules: &[PresolveRule],
) -> Result<PresolveOutcome<'a>, Error> {
    if known.is_presolved {
        return Ok(PresolveOutcome::Presolved(Presolution::new(lowered, None)));
    }
    // Systems are in units of their own.
    let may_scale = !solve.model.has_systems();
    Ok(match presolve_around(&lowered.program, &[], may_scale, rules, solve.token)? {
        Presolve::Presolved(mut presolved) => {
            // A proof follows the squares of the lowered program.
            if rules == PresolveRule::ALL && solve.options.proof_path().is_none() {
                let stated = with_perspective_cones(&presolved.program, solve.token);
                presolved.program = stated.unwrap_or(presolved.program);
                // Trees of fewer integers end sooner than better squares are found.
                if presolved.program.integers.len() >= FEWEST_INTEGERS {
                    let raised = with_raised_squares(&presolved.program);
                    presolved.program = raised.unwrap_or(presolved.program);
                }
            }
            PresolveOutcome::Presolved(Presolution::new(lowered, Some(presolved)))
        }
        Presolve::Infeasible => PresolveOutcome::Infeasible,
        Presolve::Stopped => PresolveOutcome::Stopped,
    })
}

/// A presolved program, and the way back to the model.
pub(super) struct Presolution<'a> {
    pub(super) lowered: &'a LoweredProgram,
    /// `None` if the lowered program is presolved already.
    pub(super) presolved: Option<Box<Presolved>>,
}

impl<'a> Presolution<'a> {
    fn new(lowered: &'a LoweredProgram, presolved: Option<Box<Presolved>>) -> Self {
        Presolution { lowered, presolved }
    }

    pub(super) fn program(&self) -> &crate::program::Program {
        self.presolved.as_ref().map_or(&self.lowered.program, |presolved| &presolved.program)
    }

    /// From values of the program's columns to values of the lowered program's. Those that
    /// equations determine follow from the others.
    pub(super) fn lowered_point(&self, x: &[f64]) -> Vec<f64> {
        let mut point = match &self.presolved {
            Some(presolved) => presolved.postsolve.point(x),
            None => x.to_vec(),
        };
        let program = &self.lowered.program;
        if let Some(determined) = self.lowered.leaf_columns.of(program) {
            determined.follow(&mut point);
        }
        point
    }

    /// From values of the program's columns to values of the model's variables.
    pub(super) fn restore(&self, x: &[f64]) -> Vec<f64> {
        self.lowered.restore(&self.lowered_point(x))
    }

    /// A start in columns of the lowered program as one in columns of the presolved program.
    pub(super) fn carry(&self, start: &Start) -> Start {
        let integers = match &self.presolved {
            Some(presolved) => presolved.postsolve.carry(&start.integers),
            None => start.integers.clone(),
        };
        Start { integers, ..start.clone() }
    }

    /// By column of the program, whether it decides one of some variables of the model.
    pub(super) fn decides(&self, variables: impl Iterator<Item = usize>) -> Vec<bool> {
        let variables: Vec<(usize, f64)> = variables.map(|j| (j, 0.0)).collect();
        let mut columns = self.lowered.carry(&variables);
        if let Some(presolved) = &self.presolved {
            columns = presolved.postsolve.carry(&columns);
        }
        let mut decides = vec![false; self.program().column_count()];
        columns.iter().for_each(|&(column, _)| decides[column] = true);
        decides
    }

    /// The place of a column among the variables of the lowered model.
    pub(super) fn column(&self, column: usize) -> Option<usize> {
        let column = match &self.presolved {
            Some(presolved) => presolved.postsolve.columns().get(column).copied()?,
            None => column,
        };
        self.lowered.column(column)
    }

    /// The part of the objective that presolve may have lost to rounding.
    pub(super) fn rounding(&self) -> f64 {
        let own = self.presolved.as_ref().map_or(0.0, |presolved| presolved.rounding);
        own + self.lowered.rounding
    }

    /// Whether presolve has changed the objective of a point by more than rounding explains. The
    /// point is compared before columns follow from others: they may be missed within the
    /// tolerance, and the equations of an unstable system make that any number.
    pub(super) fn changes_objective(&self, values: &[f64]) -> bool {
        let Some(presolved) = &self.presolved else { return false };
        let (program, small) = (&self.lowered.program, &presolved.program);
        let point = presolved.postsolve.point(values);
        let terms = program.linear.iter().zip(&point).map(|(c, x)| (c * x).abs());
        let size = terms.sum::<f64>() + program.offset.abs() + small.offset.abs();
        let (before, after) = (program.objective(&point), small.objective(values));
        let allowed = presolved.rounding + OBJECTIVE_CHANGE * (size + before.abs().max(1.0));
        (before - after).abs() > allowed
    }
}
