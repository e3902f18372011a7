//! Scenes in the plane.

use carom::Error;
use carom::hybrid::Shortest;
use carom::hybrid::scene::{Scene, ScenePlan};
use carom::model::mps;
use carom::prelude::*;

use crate::less::Less;
use crate::progress::{self, Tell};
use crate::scene_answer::{SceneAnswer, Side};
use crate::scene_task::SceneTask;
use crate::{Reasons, code, search_options};

/// Where the first body is.
const PLANE: [usize; 2] = [0, 1];

/// Answers a task.
pub fn solve(task: &str, tell: &mut Tell<'_>) -> Result<SceneAnswer, String> {
    let task = SceneTask::read(task)?;
    answer(&task, tell).map_err(|error| error.to_string())
}

fn answer(task: &SceneTask, tell: &mut Tell<'_>) -> Result<SceneAnswer, Error> {
    let free = plan(&task.free()?, "free", task.max_steps(), tell)?;
    progress::found("free", free.refuted_steps.unwrap_or(0), &Side::of(task, &free), tell);
    let scene = task.tolerant()?;
    // The careful plan is a plan of this scene too, so that only shorter ones are looked for.
    let tolerant = match free.steps {
        Some(1) => None,
        Some(steps) => Some(plan(&scene, "tolerant", steps - 1, tell)?),
        None => Some(plan(&scene, "tolerant", task.max_steps(), tell)?),
    };
    let mut answer = SceneAnswer::new(task, &free, tolerant.as_ref());
    answer.code = code::of_scene(task);
    answer.less = less(&free, tolerant.as_ref())?;
    if task.files {
        let found = tolerant.as_ref().and_then(|found| found.steps.or(found.refuted_steps));
        let steps = found.or(free.steps).unwrap_or(1);
        answer.mps = Some(mps::write(scene.plain_program(steps)?.model())?);
    }
    Ok(answer)
}

fn plan(
    scene: &Scene,
    side: &str,
    max_steps: usize,
    tell: &mut Tell<'_>,
) -> Result<Shortest<ScenePlan>, Error> {
    let mut progress = progress::refuted(side, tell);
    let mut solver = BranchAndBound::default();
    scene.shortest_plan_with(&search_options(max_steps), &mut solver, &mut progress)
}

fn less(
    free: &Shortest<ScenePlan>,
    tolerant: Option<&Shortest<ScenePlan>>,
) -> Result<Option<Less>, Error> {
    let bold = tolerant.map(|found| Less::new("tolerant", found, PLANE)).transpose()?.flatten();
    match bold {
        Some(less) => Ok(Some(less)),
        None => Less::new("free", free, PLANE),
    }
}

/// Why plans with so many steps are impossible.
pub fn reasons(task: &str, free: usize, tolerant: usize) -> Result<Reasons, String> {
    let task = SceneTask::read(task)?;
    let why = |scene: Result<Scene, Error>, steps: usize| {
        let sets = (steps > 0).then(|| scene?.reach_sets());
        let reason = sets?.and_then(|mut sets| sets.explain(steps));
        reason.ok().flatten().map(|reason| reason.to_string())
    };
    Ok(Reasons { free: why(task.free(), free), tolerant: why(task.tolerant(), tolerant) })
}
