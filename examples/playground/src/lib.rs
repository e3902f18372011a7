//! Planners for a web page: tasks and answers are JSON.
//!
//! [`plan`] finds the paper's shortest plans with and without collisions, and [`plan_scene`] those
//! of a scene in the plane; both say how that was proved, tell how far they are, and give the task
//! as a Rust program. [`explain`] and [`explain_scene`] say in words why one step less is not
//! enough; the page asks for it once the plans are drawn.

// Without the doors to scenes, what only they use is left out of the file.
#![cfg_attr(not(feature = "scenes"), allow(dead_code))]

mod answer;
mod code;
mod gusts;
mod less;
mod motion;
mod progress;
mod reasons;
mod scene;
mod scene_answer;
mod scene_task;
mod task;
mod wall;
mod words;

use carom::hybrid::{HorizonEvent, ShortestOptions};
use carom::prelude::BranchAndBound;
use carom::solver::{Interrupt, Options};
use serde::Serialize;
use std::time::Duration;
use wasm_bindgen::prelude::*;

use answer::Answer;
use scene_answer::SceneAnswer;

/// Nodes of a solve, and of all solves of a search together before the last one; most searches need
/// a hundredth of them. It is work that is limited and not time, so that an answer does not depend
/// on the machine: a visitor sees how far a long search is, and can end it.
const WORK: u64 = 6000;

/// Time for the search for plans with collisions while something is being dragged.
const PATIENCE_OF_DRAGS: Duration = Duration::from_millis(150);

/// Time for each of the two reasons that a page asks for when plans are drawn.
const REASON: Duration = Duration::from_millis(600);

/// Finds the shortest plans of a task with and without collisions. The answer is always an object;
/// its `error` says in a sentence what is wrong with the task.
///
/// # Arguments
///
/// * `tell`: is called with news as JSON: the `side`, how many steps are `refuted`, and what is
///   `found`.
#[wasm_bindgen]
pub fn plan(task: &str, tell: Option<js_sys::Function>) -> String {
    plan_with(task, message_callback(tell))
}

/// The same for a scene.
#[cfg(feature = "scenes")]
#[wasm_bindgen]
pub fn plan_scene(task: &str, tell: Option<js_sys::Function>) -> String {
    plan_scene_with(task, message_callback(tell))
}

/// Why no plan of a task has so many steps, without (`free`) and with collisions (`tolerant`).
/// `null` for a side about which nothing is asked (0 steps), or that the reach sets do not exclude.
#[wasm_bindgen]
pub fn explain(task: &str, free: usize, tolerant: usize) -> String {
    text(&wall::reasons(task, free, tolerant).unwrap_or_default())
}

/// The same for a scene.
#[cfg(feature = "scenes")]
#[wasm_bindgen]
pub fn explain_scene(task: &str, free: usize, tolerant: usize) -> String {
    text(&scene::reasons(task, free, tolerant).unwrap_or_default())
}

/// The sets that exclude a plan of so many steps with collisions (`tolerant`), or without (`free`);
/// `null` if sets exclude neither, or nothing is asked (0 steps).
#[wasm_bindgen]
pub fn less(task: &str, free: usize, tolerant: usize) -> String {
    text(&less::of_wall(task, free, tolerant).unwrap_or_default())
}

/// The same for a scene.
#[cfg(feature = "scenes")]
#[wasm_bindgen]
pub fn less_scene(task: &str, free: usize, tolerant: usize) -> String {
    text(&less::of_scene(task, free, tolerant).unwrap_or_default())
}

/// As [`plan`], outside a page.
pub fn plan_with(task: &str, tell: impl FnMut(&str) + 'static) -> String {
    let answer = progress::told(tell, || wall::solve(task));
    text(&answer.unwrap_or_else(|error| Answer::of_error(&error)))
}

/// As [`plan_scene`], outside a page.
pub fn plan_scene_with(task: &str, tell: impl FnMut(&str) + 'static) -> String {
    let answer = progress::told(tell, || scene::solve(task));
    text(&answer.unwrap_or_else(|error| SceneAnswer::of_error(&error)))
}

fn message_callback(function: Option<js_sys::Function>) -> impl FnMut(&str) {
    move |news| {
        if let Some(function) = &function {
            // A page that fails to show news still gets the answer.
            let _ = function.call1(&JsValue::NULL, &JsValue::from_str(news));
        }
    }
}

fn text(answer: &impl Serialize) -> String {
    serde_json::to_string(answer).unwrap_or_else(|error| format!(r#"{{"error":"{error}"}}"#))
}

fn search_options(max_steps: usize) -> ShortestOptions {
    ShortestOptions::default().with_max_steps(max_steps)
}

/// Options of a search that tells its news, and ends when its work is done.
fn told_options(side: &'static str, options: &ShortestOptions) -> ShortestOptions {
    let interrupt = Interrupt::new();
    let options = options.clone().with_interrupt(&interrupt);
    let (mut tell, mut nodes) = (progress::refuted(side), 0);
    options.with_progress(move |event| {
        tell(event);
        if let HorizonEvent::Decided(attempt) = event {
            nodes += attempt.statistics.nodes;
            if nodes >= WORK {
                interrupt.trigger();
            }
        }
    })
}

fn solver() -> BranchAndBound {
    BranchAndBound::new(Options::default().with_node_limit(WORK))
}
