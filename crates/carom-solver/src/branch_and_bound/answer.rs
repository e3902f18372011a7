//! From the result of a search to the verified solution.

use std::collections::BTreeMap;

use super::mip_start::GivenStart;
use super::solve::{Solve, SolveResult};
use crate::error::Error;
use crate::model::{Model, Variable};
use crate::search::{ClosedNode, SearchResult};
use crate::solution::{LeafBound, LeafBox, Multipliers, Outcome, Solution};
use crate::solver::{Options, PoolMode};

/// The verified solution, with its multipliers, the report on the start and a refused point.
pub(super) fn answer(
    solve: &Solve<'_>,
    solved: SolveResult,
    given: Option<&GivenStart>,
) -> Result<Solution, Error> {
    let Solve { model, options, .. } = *solve;
    let SolveResult { mut found, derivatives, proof, .. } = solved;
    found.statistics.time = solve.token.elapsed();
    let report = given.map(|given| given.report(model, &found));
    let sign = model.sense().sign();
    let signed = |values: Vec<f64>| values.into_iter().map(|v| sign * v + 0.0).collect();
    let multipliers =
        derivatives.map(|d| Multipliers::new(model, signed(d.rows), signed(d.columns)));
    let solution = solution(model, options, found)?
        .with_start_report(report)
        .with_refused(solve.refusals.take())
        .with_proof(proof)
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
fn solution(model: &Model, options: &Options, found: SearchResult) -> Result<Solution, Error> {
    let (sign, feasibility) = (model.sense().sign(), options.feasibility);
    let mut points = found.points.into_iter();
    let outcome =
        Outcome::new(found.termination, points.next(), sign * found.bound, found.statistics);
    let leaves = found.leaves.iter().map(|leaf| leaf_of(model, leaf, sign)).collect();
    let solution = Solution::new(model, outcome, feasibility)?;
    // A proof of the answer is one of a pool that holds nothing else.
    let is_proved = solution.is_optimal() || solution.is_infeasible();
    let is_alone = options.pool == 1 && options.pool_mode == PoolMode::Best;
    let complete = found.pool_complete || (is_alone && is_proved);
    let solution = solution.with_pool(model, points, complete, feasibility)?;
    Ok(solution.with_leaves(leaves))
}

/// An end of the tree over the variables of the model. Decisions on auxiliary columns are left out,
/// which makes the end larger.
fn leaf_of(model: &Model, closed: &ClosedNode, sign: f64) -> LeafBox {
    let variables: Vec<Variable> = model.variables().map(|variable| variable.id()).collect();
    let mut bounds: BTreeMap<usize, [f64; 2]> = BTreeMap::new();
    for decision in &closed.decisions {
        let [lower, upper] =
            bounds.entry(decision.column).or_insert([f64::NEG_INFINITY, f64::INFINITY]);
        if decision.is_upper {
            *upper = upper.min(decision.value);
        } else {
            *lower = lower.max(decision.value);
        }
    }
    let bounds = bounds.into_iter().filter_map(|(column, [lower, upper])| {
        Some(LeafBound::new(*variables.get(column)?, [lower, upper]))
    });
    LeafBox::new(bounds.collect(), sign * closed.bound)
}
