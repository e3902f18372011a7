//! The paper's planner for a web page: tasks and answers are JSON.
//!
//! [`plan`] finds the shortest plans with and without collisions and says how that was proved.
//! [`explain`] says in words why one step less is not enough; it takes as long again, so that the
//! page asks for it once the plans are drawn.

mod answer;
mod task;
mod words;

use carom::collision_tolerant::{self, PlanComparison, PlanningOptions, compare};
use carom::hybrid::ShortestOptions;
use carom::prelude::*;
use std::time::Duration;
use wasm_bindgen::prelude::*;

use answer::{Answer, Reasons};
use task::Task;

/// Time for each of the two searches, in s. Most take a tenth of one.
const PATIENCE: u64 = 10;

/// Finds the shortest plans of a task with and without collisions. The answer is always an object;
/// its `error` says in a sentence what is wrong with the task.
#[wasm_bindgen]
pub fn plan(task: &str) -> String {
    let answer = solve(task).unwrap_or_else(|error| Answer::of_error(&error));
    serde_json::to_string(&answer).unwrap_or_else(|error| format!(r#"{{"error":"{error}"}}"#))
}

/// Why no plan of a task has so many steps, without (`free`) and with collisions (`tolerant`).
/// `null` for a side about which nothing is asked (0 steps), or that the reach sets do not exclude.
#[wasm_bindgen]
pub fn explain(task: &str, free: usize, tolerant: usize) -> String {
    let reasons = reasons(task, free, tolerant).unwrap_or_default();
    serde_json::to_string(&reasons).unwrap_or_else(|_| "{}".into())
}

fn solve(task: &str) -> Result<Answer, String> {
    let task = Task::read(task)?;
    let plans = search(&task).map_err(|error| error.to_string())?;
    Ok(Answer::new(&task, &plans))
}

fn search(task: &Task) -> Result<PlanComparison, Error> {
    let search = ShortestOptions::default()
        .with_max_steps(task.max_steps())
        .with_time_limit(Duration::from_secs(PATIENCE));
    let options = PlanningOptions::default().with_search(search);
    compare(&task.scenario()?, &options, &mut BranchAndBound::default())
}

fn reasons(task: &str, free: usize, tolerant: usize) -> Result<Reasons, String> {
    let scenario = Task::read(task)?.scenario().map_err(|error| error.to_string())?;
    let why = |scenario: &collision_tolerant::Scenario, steps: usize| {
        let reason = (steps > 0).then(|| collision_tolerant::explain(scenario, steps));
        reason.and_then(Result::ok).flatten().map(|reason| reason.to_string())
    };
    Ok(Reasons { free: why(&scenario.collision_free(), free), tolerant: why(&scenario, tolerant) })
}
