//! Planners for a web page: tasks and answers are JSON.
//!
//! [`plan`] finds the paper's shortest plans with and without collisions, and [`plan_scene`] those of
//! a scene in the plane; both say how that was proved. [`explain`] and [`explain_scene`] say in words
//! why one step less is not enough; that takes as long again, so that the page asks for it once
//! the plans are drawn.

mod answer;
mod scene_answer;
mod scene_task;
mod task;
mod words;

use carom::collision_tolerant::{self, PlanComparison, PlanningOptions};
use carom::hybrid::ShortestOptions;
use carom::hybrid::scene::Scene;
use carom::prelude::*;
use serde::Serialize;
use std::time::Duration;
use wasm_bindgen::prelude::*;

use answer::{Answer, Reasons};
use scene_answer::SceneAnswer;
use scene_task::SceneTask;
use task::Task;

/// Time for each of the two searches, in s. Most take a tenth of one.
const PATIENCE: u64 = 10;

/// Finds the shortest plans of a task with and without collisions. The answer is always an object;
/// its `error` says in a sentence what is wrong with the task.
#[wasm_bindgen]
pub fn plan(task: &str) -> String {
    text(&solve(task).unwrap_or_else(|error| Answer::of_error(&error)))
}

/// The same for a scene.
#[wasm_bindgen]
pub fn plan_scene(task: &str) -> String {
    text(&solve_scene(task).unwrap_or_else(|error| SceneAnswer::of_error(&error)))
}

/// Why no plan of a task has so many steps, without (`free`) and with collisions (`tolerant`).
/// `null` for a side about which nothing is asked (0 steps), or that the reach sets do not exclude.
#[wasm_bindgen]
pub fn explain(task: &str, free: usize, tolerant: usize) -> String {
    text(&reasons(task, free, tolerant).unwrap_or_default())
}

/// The same for a scene.
#[wasm_bindgen]
pub fn explain_scene(task: &str, free: usize, tolerant: usize) -> String {
    text(&scene_reasons(task, free, tolerant).unwrap_or_default())
}

fn text(answer: &impl Serialize) -> String {
    serde_json::to_string(answer).unwrap_or_else(|error| format!(r#"{{"error":"{error}"}}"#))
}

fn solve(task: &str) -> Result<Answer, String> {
    let task = Task::read(task)?;
    let plans = search(&task).map_err(|error| error.to_string())?;
    Ok(Answer::new(&task, &plans))
}

fn search(task: &Task) -> Result<PlanComparison, Error> {
    let options = PlanningOptions::default().with_search(search_options(task.max_steps()));
    task.scenario()?.compare(&options, &mut BranchAndBound::default())
}

fn reasons(task: &str, free: usize, tolerant: usize) -> Result<Reasons, String> {
    let scenario = Task::read(task)?.scenario().map_err(|error| error.to_string())?;
    let why = |scenario: &collision_tolerant::Scenario, steps: usize| {
        let reason = (steps > 0).then(|| scenario.reach_sets().and_then(|mut s| s.explain(steps)));
        reason.and_then(Result::ok).flatten().map(|reason| reason.to_string())
    };
    let tolerant = why(&scenario, tolerant);
    Ok(Reasons { free: why(&scenario.collision_free(), free), tolerant })
}

fn search_options(max_steps: usize) -> ShortestOptions {
    let patience = Duration::from_secs(PATIENCE);
    ShortestOptions::default().with_max_steps(max_steps).with_time_limit(patience)
}

fn solve_scene(task: &str) -> Result<SceneAnswer, String> {
    let task = SceneTask::read(task)?;
    let plan = |scene: &Scene, max_steps| {
        scene.shortest_plan(&search_options(max_steps), &mut BranchAndBound::default())
    };
    let plans = || -> Result<_, Error> {
        let free = plan(&task.free()?, task.max_steps())?;
        let tolerant = task.tolerant()?;
        // The careful plan is a plan of this scene too, so that only shorter ones are looked for.
        let tolerant = match free.steps {
            Some(1) => None,
            Some(steps) => Some(plan(&tolerant, steps - 1)?),
            None => Some(plan(&tolerant, task.max_steps())?),
        };
        Ok((free, tolerant))
    };
    let (free, tolerant) = plans().map_err(|error| error.to_string())?;
    Ok(SceneAnswer::new(&task, &free, tolerant.as_ref()))
}

fn scene_reasons(task: &str, free: usize, tolerant: usize) -> Result<Reasons, String> {
    let task = SceneTask::read(task)?;
    let why = |scene: Result<Scene, Error>, steps: usize| {
        let sets = (steps > 0).then(|| scene?.reach_sets());
        let reason = sets?.and_then(|mut sets| sets.explain(steps));
        reason.ok().flatten().map(|reason| reason.to_string())
    };
    Ok(Reasons { free: why(task.free(), free), tolerant: why(task.tolerant(), tolerant) })
}
