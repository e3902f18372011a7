//! One solve: lower, assemble, presolve, search, restore.

use super::curvature::check_curvature;
use super::multipliers::{Derivatives, derivatives};
use super::refusals::Refusals;
use super::row_judge::RowJudge;
use super::stage::Stage;
use crate::error::Error;
use crate::model::Model;
use crate::presolve::root::{Presolve, Presolved, Rule, presolve};
use crate::program::Program;
use crate::reformulate::{self, WayBack};
use crate::relaxation::LadderPool;
use crate::search::{ColumnGuidance, Contradiction, Found, GuessEnd, Seed};
use crate::solution::{Point, Termination};
use crate::solver::{Control, Options, StopToken};

/// Rounding of bounds below this, relative, is below that of any objective (no unit).
const VISIBLE: f64 = 1e-10;

/// By how much presolve may seem to change the objective of a point, relative to the terms (no unit):
/// the point keeps the equalities that were used up to the feasibility tolerance only.
const CHANGED: f64 = 1e-6;

/// The data that the steps of a solve share.
#[derive(Clone, Copy)]
pub(super) struct Pipeline<'a> {
    pub(super) model: &'a Model,
    pub(super) options: &'a Options,
    pub(super) token: &'a StopToken,
    pub(super) guidance: &'a ColumnGuidance<'a>,
    pub(super) ladders: &'a LadderPool,
    pub(super) refusals: &'a Refusals,
    /// Judges points by rows that are found while the program is searched.
    pub(super) judge: Option<&'a RowJudge<'a>>,
    pub(super) seed: Option<&'a Seed>,
}

impl Pipeline<'_> {
    /// The result of searching the model's program; points are values of its variables. If a limit comes
    /// before the search, there is no point and no bound. With multipliers of the lowered model if it has
    /// no integers.
    pub(super) fn run(
        &self,
        control: &mut Control<'_>,
    ) -> Result<(Found, Option<Derivatives>), Error> {
        let (program, way_back) = if self.model.has_only_rows() {
            (Program::assemble(self.model)?, WayBack::to_rows(self.model))
        } else {
            let Some(lowered) = reformulate::lower_until(self.model, None, self.token)? else {
                return Ok((self.stopped(), None));
            };
            (Program::assemble(lowered.model())?, lowered.into_way_back())
        };
        check_curvature(self.model, &program, false)?;
        self.run_program(program, &|values| way_back.restore(values), control)
    }

    /// The same from a program on: that of the lowered model, or what a presolve for all values of
    /// the parameters has left of it. Seed and guidance are about its columns.
    ///
    /// # Arguments
    ///
    /// * `restore`: from values of the program's columns to values of the model's variables.
    pub(super) fn run_program(
        &self,
        mut program: Program,
        restore: &(dyn Fn(&[f64]) -> Vec<f64> + Sync),
        control: &mut Control<'_>,
    ) -> Result<(Found, Option<Derivatives>), Error> {
        program.constant = program.sign * self.model.objective_constant();
        let rules: &[Rule] = match self.options.reductions && !self.is_about_columns() {
            false => &[],
            // Nothing that is known may be reduced away.
            true if self.seed.is_some() || self.guidance.proposes() => &Rule::FAITHFUL,
            // Rows may come that speak of all points.
            true if self.judge.is_some_and(RowJudge::expects_rows) => &Rule::FAITHFUL,
            true => &Rule::ALL,
        };
        let (found, derivatives) = self.run_presolved(&program, rules, restore, control)?;
        let contradicted = found.contradiction.is_some();
        debug_assert!(!contradicted, "presolve has changed the objective of {:?}", found.points);
        // What has found rows is searched again with them.
        let is_over = self.token.is_over() || self.judge.is_some_and(RowJudge::has_new_rows);
        let is_doubtful = found.is_widened || found.termination == Termination::Stalled;
        if !contradicted && (rules.is_empty() || !is_doubtful || is_over) {
            return Ok((found, derivatives));
        }
        // Callbacks see one search only.
        let control = &mut Control::default();
        let (mut plain, derivatives) = self.run_presolved(&program, &[], restore, control)?;
        plain.statistics.add(&found.statistics);
        plain.statistics.contradictions += u64::from(contradicted);
        if !contradicted && !is_conclusion(&plain, &found) {
            let statistics = plain.statistics;
            return Ok((Found { statistics, ..found }, None));
        }
        Ok((plain, derivatives))
    }

    /// Presolves a program by some rules, searches it, and restores what is found.
    fn run_presolved(
        &self,
        program: &Program,
        rules: &[Rule],
        restore: &(dyn Fn(&[f64]) -> Vec<f64> + Sync),
        control: &mut Control<'_>,
    ) -> Result<(Found, Option<Derivatives>), Error> {
        let as_is = self.is_about_tree();
        let presolved = match presolve(program, rules, self.token)? {
            Presolve::Presolved(presolved) => presolved,
            Presolve::Infeasible => return Ok((Found::infeasible(), None)),
            Presolve::Stopped => return Ok((self.stopped(), None)),
        };
        let postsolve = &presolved.postsolve;
        let guidance = self.guidance.presolved(postsolve, program);
        let carried = |seed: &Seed| Seed { guess: postsolve.carry(&seed.guess), ..seed.clone() };
        let seed = self.seed.map(carried);
        let continuous = program.integers.is_empty().then_some(program);
        let restore = |values: &[f64]| restore(&postsolve.point(values));
        let stage = Stage {
            model: self.model,
            options: self.options,
            token: self.token,
            guidance: &guidance,
            ladders: self.ladders,
            refusals: self.refusals,
            judge: self.judge,
            program: &presolved.program,
            restore: &restore,
            as_is,
            tightened: None,
            strengthens: true,
        };
        let mut found = stage.run(control, seed.as_ref());
        let optimal = found.points.first().filter(|_| found.termination == Termination::Optimal);
        let derivatives = continuous.zip(optimal).and_then(|(program, values)| {
            let mut ladder = self.ladders.take();
            let point = postsolve.point(values);
            let found = derivatives(program, &presolved, &point, &mut ladder, self.token);
            self.ladders.give_back(ladder);
            found
        });
        if let Some(values) = found.points.first()
            && changes_objective(program, &presolved, values)
        {
            found.contradiction = Some(Contradiction::Objective);
        }
        found.points = found.points.iter().map(|values| restore(values)).collect();
        found.guess = match found.guess {
            Some(GuessEnd::Point(values)) => Some(GuessEnd::Point(restore(&values))),
            Some(GuessEnd::Contradiction(column)) => {
                let column = postsolve.columns().get(column).copied().unwrap_or(column);
                Some(GuessEnd::Contradiction(column))
            }
            // Where presolve has decided all that was guessed, any point tells.
            None if self.seed.is_some_and(|seed| !seed.guess.is_empty()) => {
                let nothing_left = seed.is_some_and(|seed| seed.guess.is_empty());
                let point = found.points.first().filter(|_| nothing_left);
                point.cloned().map(GuessEnd::Point)
            }
            other => other,
        };
        self.charge(presolved.rounding, &mut found)?;
        Ok((found, derivatives))
    }

    pub(super) fn stopped(&self) -> Found {
        Found::stopped(self.token.ended().unwrap_or(Termination::Interrupted))
    }

    /// Takes what presolve may have lost to rounding off the bound, where it can be seen at all; the
    /// gap asked for may not be met then.
    pub(super) fn charge(&self, rounding: f64, found: &mut Found) -> Result<(), Error> {
        if !found.bound.is_finite() || rounding <= VISIBLE * found.bound.abs().max(1.0) {
            return Ok(());
        }
        found.bound -= rounding;
        if let (Termination::Optimal, Some(values)) = (found.termination, found.points.first()) {
            let point = Point::new(self.model, values.clone())?;
            let value = self.model.sense().sign() * point.value(self.model.objective())?;
            let constant = self.model.sense().sign() * self.model.objective_constant();
            if value - found.bound > self.options.allowed_gap(value, constant) {
                found.termination = Termination::Stalled;
            }
        }
        Ok(())
    }

    /// Whether an option or the guidance refers to the tree or to all columns: pools, leaves and splits do.
    pub(super) fn is_about_columns(&self) -> bool {
        self.options.pool > 1 || self.is_about_tree()
    }

    /// Whether an option or the guidance refers to the tree: leaves and splits do. Rows that all points
    /// satisfy do not affect pools.
    fn is_about_tree(&self) -> bool {
        let boxes = self.seed.is_some_and(|seed| !seed.leaves.is_empty());
        self.options.keep_leaves || boxes || self.guidance.splits()
    }
}

/// Whether a search without presolve says more than one with it: it has come to an end.
fn is_conclusion(plain: &Found, found: &Found) -> bool {
    match plain.termination {
        Termination::Optimal | Termination::Unbounded => true,
        Termination::Infeasible => found.points.is_empty(),
        _ => false,
    }
}

/// Whether presolve has changed the objective of a point by more than rounding explains.
fn changes_objective(program: &Program, presolved: &Presolved, values: &[f64]) -> bool {
    let own = presolved.program.column_count();
    let values = values.get(..own).unwrap_or(values);
    let point = presolved.postsolve.point(values);
    let terms = program.linear.iter().zip(&point).map(|(c, x)| (c * x).abs());
    let size = terms.sum::<f64>() + program.offset.abs() + presolved.program.offset.abs();
    let (before, after) = (program.objective(&point), presolved.program.objective(values));
    let allowed = presolved.rounding + CHANGED * (size + before.abs().max(1.0));
    (before - after).abs() > allowed
}
