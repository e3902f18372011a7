//! From what a search found to the verified solution.

use super::multipliers::Derivatives;
use super::seeding::leaf_of;
use crate::error::Error;
use crate::model::Model;
use crate::search::Found;
use crate::solution::{Multipliers, Outcome, SeedReport, Solution, Verification};
use crate::solver::{Options, PoolMode};

/// The verified solution with all that is known of it.
pub(super) fn answer(
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
