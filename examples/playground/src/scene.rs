//! Scenes in the plane.

use std::time::Duration;

use carom::Error;
use carom::hybrid::ShortestHorizon;
use carom::hybrid::reach::ReachSets;
use carom::hybrid::scene::{Scene, ScenePlan};
use carom::model::mps;
use carom::prelude::*;
use carom::reformulate;

use crate::progress;
use crate::scene_answer::{SceneAnswer, Side};
use crate::scene_task::SceneTask;
use crate::{
    PATIENCE_OF_DRAGS, REASON, Reasons, code, reason, search_options, solver, told_options, words,
};

/// For the search for what is in the way.
const WITHOUT: Duration = Duration::from_millis(800);

/// Answers a task.
pub fn solve(task: &str) -> Result<SceneAnswer, String> {
    let task = SceneTask::read(task)?;
    answer(&task).map_err(|error| error.to_string())
}

fn answer(task: &SceneTask) -> Result<SceneAnswer, Error> {
    let free = plan(&task.free()?, "free", &search_options(task.max_steps()))?;
    progress::found("free", free.refuted_steps.unwrap_or(0), &Side::of(task, &free));
    let scene = task.tolerant()?;
    // The careful plan is a plan of this scene too, so that only shorter ones are looked for.
    let mut options = search_options(free.steps.map_or(task.max_steps(), |steps| steps - 1));
    if task.hurried {
        options = options.with_time_limit(PATIENCE_OF_DRAGS);
    }
    let tolerant = match free.steps {
        Some(1) => None,
        _ => Some(plan(&scene, "tolerant", &options)?),
    };
    let mut answer = SceneAnswer::new(task, &free, tolerant.as_ref());
    answer.code = code::of_scene(task);
    answer.reason = reason(&free, tolerant.as_ref());
    if task.files {
        let found = tolerant.as_ref().and_then(|found| found.steps.or(found.refuted_steps));
        let steps = found.or(free.steps).unwrap_or(1);
        let program = scene.plain_program(steps)?;
        answer.mps = Some(mps::write(reformulate::lower(program.model())?.model())?);
    }
    Ok(answer)
}

fn plan(
    scene: &Scene,
    side: &'static str,
    options: &ShortestOptions,
) -> Result<ShortestHorizon<ScenePlan>, Error> {
    scene.shortest_with(&told_options(side, options), &mut solver())
}

/// Why plans with so many steps are impossible.
pub fn reasons(task: &str, free: usize, tolerant: usize) -> Result<Reasons, String> {
    let task = SceneTask::read(task)?;
    let why = |scene: Result<Scene, Error>, steps: usize| {
        if steps == 0 {
            return None;
        }
        let scene = scene.ok()?;
        let known = sets(&scene, steps)?.explain_within(steps, REASON);
        known.ok().flatten().map(|reason| reason.to_string())
    };
    let free = why(task.free(), free).or_else(|| in_the_way(&task, free));
    Ok(Reasons { free, tolerant: why(task.tolerant(), tolerant) })
}

/// The sets of a scene that a search uses.
fn sets(scene: &Scene, steps: usize) -> Option<ReachSets> {
    let options = search_options(steps).with_time_limit(Duration::ZERO);
    scene.shortest_with(&options, &mut solver()).ok()?.sets
}

/// What has to go for a careful plan of so many steps.
fn in_the_way(task: &SceneTask, steps: usize) -> Option<String> {
    let parts = task.parts();
    let limit = WITHOUT / (parts.len().max(1) as u32);
    let enough = parts.into_iter().filter(|_| steps > 0).find_map(|(name, rest)| {
        let options = search_options(steps).with_time_limit(limit);
        let found = rest.free().ok()?.shortest_with(&options, &mut solver());
        found.ok()?.steps.map(|found| (name, found))
    });
    enough.map(|(name, found)| {
        let seconds = words::number(found as f64 * task.time_step);
        let steps = words::steps(steps);
        format!("`{name}` is in the way of plans of {steps}: without it {seconds} s are enough")
    })
}
