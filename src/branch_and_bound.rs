//! The default backend: the whole pipeline, one function per step.

mod alternation;
mod answer;
mod blocks;
mod curvature;
mod far;
mod first_point;
mod history;
mod looks;
mod multipliers;
mod pipeline;
mod prepared;
mod refusals;
mod row_judge;
mod row_rounds;
mod rows;
mod seeding;
mod stage;
mod user_cuts;

use crate::error::Error;
use crate::model::Model;
use crate::relaxation::LadderPool;
use crate::search::ColumnGuidance;
use crate::solution::Solution;
use crate::solver::{Control, Options, Prepared, Solver, StopToken, TreeSeed};
use answer::answer;
use pipeline::Pipeline;
use prepared::PreparedProgram;
use refusals::Refusals;
use row_rounds::{finds_rows, solve_in_rounds};
use seeding::{report, seed_of};

/// Branch and bound over continuous relaxations.
///
/// A model is lowered to rows, assembled, presolved and searched. An incumbent is accepted only if
/// it passes the [`Verification`](crate::solution::Verification) against the model, including its
/// implications.
///
/// ```
/// use carom::prelude::*;
///
/// let mut model = Model::new("either");
/// let x = model.continuous("x", 0.0, 10.0)?;
/// let far = model.binary("far")?;
/// model.add("far", far.on().implies(x.ge(7.0)))?;
/// model.add("near", far.off().implies(x.le(2.0)))?;
/// model.minimize((x - 5.0).square())?;
///
/// let solution = BranchAndBound::default().solve(&model)?;
/// assert!(solution.is_optimal());
/// assert!((solution.value(x)? - 7.0).abs() < 1e-6);
/// assert!(solution.verification().is_some_and(|v| v.holds()));
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct BranchAndBound {
    options: Options,
}

impl BranchAndBound {
    /// A solver with these options.
    pub fn new(options: Options) -> Self {
        BranchAndBound { options }
    }
}

impl Solver for BranchAndBound {
    fn name(&self) -> &str {
        "carom"
    }

    fn options(&self) -> &Options {
        &self.options
    }

    fn options_mut(&mut self) -> &mut Options {
        &mut self.options
    }

    fn solve_with(&mut self, model: &Model, control: &mut Control<'_>) -> Result<Solution, Error> {
        #[cfg(feature = "tracing")]
        let _span = tracing::info_span!("solve", model = model.name()).entered();
        let options = &self.options;
        if finds_rows(control) {
            options.check()?;
            return solve_in_rounds(model, options, control);
        }
        let token = StopToken::new(options.time_limit, control.interrupt());
        options.check()?;
        let guidance = ColumnGuidance::new(model, control.guidance())?;
        let given = control.seed().map(|seed: &TreeSeed| seed_of(model, seed));
        let seed = given.as_ref().map(|(seed, _)| seed);
        let ladders = &LadderPool::new(options);
        let (guidance, token, refusals, judge) = (&guidance, &token, &Refusals::default(), None);
        let pipeline = Pipeline { model, options, token, guidance, ladders, refusals, judge, seed };
        let (mut found, derivatives) = pipeline.run(control)?;
        found.statistics.time = token.elapsed();
        let seed_report =
            given.as_ref().map(|(seed, ignored)| report(model, &found, seed, *ignored));
        answer(model, options, found, derivatives, seed_report, refusals.take())
    }

    fn prepare<'a>(&'a mut self, model: &Model) -> Result<Box<dyn Prepared + 'a>, Error> {
        Ok(Box::new(PreparedProgram::new(&mut self.options, model)?))
    }
}
