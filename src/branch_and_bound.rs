//! The default backend: the whole pipeline, one function per step.

mod alternation;
mod blocks;
mod curvature;
mod history;
mod looks;
mod multipliers;
mod pipeline;
mod prepared;
mod refusals;
mod seeding;
mod stage;

use crate::error::Error;
use crate::model::Model;
use crate::relaxation::LadderPool;
use crate::search::{ColumnGuidance, Found};
use crate::solution::{Multipliers, Outcome, SeedReport, Solution, Verification};
use crate::solver::{Control, Options, PoolMode, Prepared, Solver, StopToken, TreeSeed};
use multipliers::Derivatives;
use pipeline::Pipeline;
use prepared::PreparedProgram;
use refusals::Refusals;
use seeding::{leaf_of, report, seed_of};

/// Branch and bound over continuous relaxations.
///
/// A model is lowered to rows, assembled, presolved and searched. An incumbent is accepted only if
/// it passes the [`Verification`] against the model, including its
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
        let token = StopToken::new(options.time_limit, control.interrupt());
        options.check()?;
        let guidance = ColumnGuidance::new(model, control.guidance())?;
        let given = control.seed().map(|seed: &TreeSeed| seed_of(model, seed));
        let seed = given.as_ref().map(|(seed, _)| seed);
        let ladders = &LadderPool::new(options);
        let (guidance, token, refusals) = (&guidance, &token, &Refusals::default());
        let pipeline = Pipeline { model, options, token, guidance, ladders, refusals, seed };
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

/// The verified solution with all that is known of it.
fn answer(
    model: &Model,
    options: &Options,
    found: Found,
    derivatives: Option<Derivatives>,
    seed_report: Option<SeedReport>,
    refused: Option<Verification>,
) -> Result<Solution, Error> {
    let sign = model.sense().sign();
    let signed = |values: Vec<f64>| values.into_iter().map(|v| sign * v + 0.0).collect();
    let multipliers =
        derivatives.map(|d| Multipliers::new(model, signed(d.rows), signed(d.columns)));
    let solution = solution(model, options, found)?
        .with_seed_report(seed_report)
        .with_refused(refused)
        .with_multipliers(multipliers);
    #[cfg(feature = "tracing")]
    tracing::info!(
        termination = %solution.termination(),
        objective = solution.objective(),
        bound = solution.bound(),
        nodes = solution.statistics().nodes,
        "done"
    );
    Ok(solution)
}

/// The verified solution, in values of the model's variables.
fn solution(model: &Model, options: &Options, found: Found) -> Result<Solution, Error> {
    let (sign, feasibility) = (model.sense().sign(), options.feasibility);
    let mut points = found.points.into_iter();
    let outcome = Outcome {
        termination: found.termination,
        values: points.next(),
        bound: sign * found.bound,
        statistics: found.statistics,
    };
    let leaves = found.leaves.iter().map(|leaf| leaf_of(model, leaf, sign)).collect();
    let solution = Solution::new(model, outcome, feasibility)?;
    // A proof of the answer is one of a pool that holds nothing else.
    let is_proved = solution.is_optimal() || solution.is_infeasible();
    let is_alone = options.pool == 1 && options.pool_mode == PoolMode::Best;
    let complete = found.pool_complete || (is_alone && is_proved);
    let solution = solution.with_pool(model, points, complete, feasibility)?;
    Ok(solution.with_leaves(leaves))
}
