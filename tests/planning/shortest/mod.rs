//! The shortest plan agrees with brute force.
//!
//! Brute force tries every set of steps that could have an impact and asks of each whether there
//! are accelerations for it: a small linear program in the accelerations alone, whose answer comes
//! with a proof that is checked in plain arithmetic. Nothing of it uses the crate's models, solver
//! or contact laws; it reads a [`Scenario`] and nothing else.
//!
//! | module | holds |
//! | --- | --- |
//! | [`least_violation`] | linear inequalities: by how little can they be missed |
//! | [`brute_force`] | the scenario as such inequalities, and every set of impacts |
//! | [`scenes`] | scenarios as plain numbers in wall coordinates, and random ones |
//! | [`random_scenarios`], [`cases`], [`invariance`], [`statements`], [`logs`] | the tests |

mod brute_force;
mod cases;
mod invariance;
mod least_violation;
mod logs;
mod random_scenarios;
mod scenes;
mod statements;

use carom::collision_tolerant::{Plan, Scenario};
use carom::hybrid::{self, ShortestOptions, ShortestStatus, shortest_horizon};
use carom::prelude::*;
use proptest::prelude::*;

use brute_force::{Conditions, ShortestHorizon, shortest};

/// Random cases that failed once, tried first in every run.
const REGRESSIONS: &str = "tests/regressions/shortest.txt";

/// By how much a plan of the crate may miss a row: its bounds, its samples and its replay agree to
/// 1e-6 each, and a row here joins no more than a few of them.
const MISSED: f64 = 5e-6;

/// The shortest plan by the crate, checked row by row and for contradictions.
///
/// # Errors
///
/// What is wrong, in words.
fn answer(scenario: &Scenario, max_steps: usize) -> Result<ShortestHorizon, String> {
    answer_with(scenario, &options(max_steps))
}

/// The options of every test: only the largest horizon is not the default.
fn options(max_steps: usize) -> ShortestOptions {
    ShortestOptions::default().with_max_steps(max_steps)
}

/// As [`answer`], with other options.
fn answer_with(scenario: &Scenario, options: &ShortestOptions) -> Result<ShortestHorizon, String> {
    let found = scenario.shortest_with(options, &mut BranchAndBound::default());
    let found = found.map_err(|error| error.to_string())?;
    if found.plan.as_ref().is_some_and(|plan| !plan.fewest_impacts) {
        return Err("the impacts are not minimised".into());
    }
    judged(scenario, found)
}

/// As [`answer_with`], with the first plan of the shortest horizon, whatever its impacts are.
fn any_answer(scenario: &Scenario, options: &ShortestOptions) -> Result<ShortestHorizon, String> {
    let found = shortest_horizon(scenario, options, &mut BranchAndBound::default());
    let found = found.and_then(|found| found.try_map(|own| own.program.plan(&own.solution)));
    judged(scenario, found.map_err(|error| error.to_string())?)
}

/// An outcome of a search, checked.
fn judged(
    scenario: &Scenario,
    found: hybrid::ShortestHorizon<Plan>,
) -> Result<ShortestHorizon, String> {
    match found.status {
        ShortestStatus::Found => checked(scenario, &found),
        ShortestStatus::NoneWithin { max_steps } => {
            let nothing = found.steps.is_none() && found.plan.is_none();
            if nothing && found.refuted_steps == Some(max_steps) {
                Ok(ShortestHorizon::NoneWithin { max_steps })
            } else {
                Err(format!("none within {max_steps}, but {found:?}"))
            }
        }
        status => Err(status.to_string()),
    }
}

/// A plan that was found.
fn checked(
    scenario: &Scenario,
    found: &hybrid::ShortestHorizon<Plan>,
) -> Result<ShortestHorizon, String> {
    let steps = found.steps.ok_or("found without steps")?;
    let plan = found.plan.as_ref().ok_or("found without a plan")?;
    if found.refuted_steps.unwrap_or(0) + 1 != steps {
        return Err(format!("{steps} steps, {:?} refuted", found.refuted_steps));
    }
    let trajectory = &plan.trajectory;
    let contacts = trajectory.contact.iter().take(steps).enumerate();
    let set = contacts.fold(0, |set, (t, &hit)| set | (u32::from(hit) << t));
    let impacts = trajectory.impacts.len();
    if trajectory.steps() != steps || set.count_ones() as usize != impacts {
        return Err(format!("a plan that contradicts itself: {trajectory:?}"));
    }
    let conditions = Conditions::new(scenario, steps, set);
    let missed = conditions.missed_by(&trajectory.acceleration[..steps]);
    if missed > MISSED {
        return Err(format!("a plan that misses its conditions by {missed}: {trajectory:?}"));
    }
    Ok(ShortestHorizon::Found { steps, impacts })
}

/// As [`answer`], for scenarios that no tolerance decides; others are passed over.
fn clear_answer(scenario: &Scenario, max_steps: usize) -> Result<ShortestHorizon, TestCaseError> {
    prop_assume!(shortest(scenario, max_steps) != ShortestHorizon::TooClose);
    answer(scenario, max_steps)
        .map_err(|error| TestCaseError::fail(format!("{error}\n{scenario:?}")))
}

/// Fails where the crate and brute force differ; passes over what a tolerance decides.
fn compare(scenario: &Scenario, max_steps: usize) -> Result<(), TestCaseError> {
    let expected = shortest(scenario, max_steps);
    prop_assume!(expected != ShortestHorizon::TooClose);
    let found = answer(scenario, max_steps);
    prop_assert_eq!(found, Ok(expected), "{:?}", scenario);
    Ok(())
}
