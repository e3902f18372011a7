//! Scenes in the plane.

use std::time::Duration;

use carom::Error;
use carom::hybrid::reach::ReachSets;
use carom::hybrid::scene::Scene;
use carom::hybrid::{Feedback, HybridProgram, Mission, ShortestHorizon};
use carom::model::mps;
use carom::prelude::*;
use carom::reformulate;

use crate::motion::Motion;
use crate::progress;
use crate::reasons::{Reason, Reasons, reason};
use crate::scene_answer::{SceneAnswer, Side};
use crate::scene_task::SceneTask;
use crate::{PATIENCE_OF_DRAGS, REASON, code, gusts, search_options, solver, told_options, words};

/// For the search for what is in the way.
const WITHOUT: Duration = Duration::from_millis(800);
/// The name of the mission in programs.
const MISSION: &str = "mission";

/// Answers a task.
pub fn solve(task: &str) -> Result<SceneAnswer, String> {
    let task = SceneTask::read(task)?;
    answer(&task).map_err(|error| error.to_string())
}

fn answer(task: &SceneTask) -> Result<SceneAnswer, Error> {
    let options = told_options("free", &search_options(task.max_steps()));
    let free = plan(task, &task.free()?, &options)?;
    progress::found("free", free.refuted_steps.unwrap_or(0), &Side::of(task, &free));
    let scene = task.tolerant()?;
    // The careful plan is a plan of this scene too, so that only shorter ones are looked for.
    let mut options = search_options(free.steps.map_or(task.max_steps(), |steps| steps - 1));
    if task.hurried {
        options = options.with_time_limit(PATIENCE_OF_DRAGS);
    }
    let tolerant = match free.steps {
        Some(1) => None,
        _ => Some(plan(task, &scene, &told_options("tolerant", &options))?),
    };
    let mut answer = SceneAnswer::new(task, &free, tolerant.as_ref());
    answer.code = code::of_scene(task);
    answer.reason = reason(&free, tolerant.as_ref());
    if task.files {
        let found = tolerant.as_ref().and_then(|found| found.steps.or(found.refuted_steps));
        answer.mps = Some(program(task, &scene, found.or(free.steps).unwrap_or(1))?);
    }
    Ok(answer)
}

/// The shortest plan of a scene, under its mission and for every gust if the task has them.
fn plan(
    task: &SceneTask,
    scene: &Scene,
    options: &ShortestOptions,
) -> Result<ShortestHorizon<Motion>, Error> {
    let options = match task.mission_in(scene)? {
        Some(mission) => &options.clone().with_mission(MISSION, &mission),
        None => options,
    };
    if task.is_robust() {
        return gusts::plan(task, scene, options);
    }
    scene.shortest_with(options, &mut solver())?.try_map(|plan| Ok(Motion::from(plan)))
}

/// The program of so many steps, as a file.
fn program(task: &SceneTask, scene: &Scene, steps: usize) -> Result<String, Error> {
    let mut program = HybridProgram::from(scene.plain_program(steps)?);
    if let Some(mission) = task.mission_in(scene)? {
        program.require_mission(MISSION, &mission)?;
    }
    if task.is_robust() {
        let feedback = Feedback::regulator(&scene.hybrid_system()?)?;
        program = program.robust(&feedback)?.into();
    }
    mps::write(reformulate::lower(program.model())?.model())
}

/// Why plans with so many steps are impossible.
pub fn reasons(task: &str, free: usize, tolerant: usize) -> Result<Reasons, String> {
    let task = SceneTask::read(task)?;
    let why = |stated: fn(&SceneTask) -> Result<Scene, Error>, steps: usize| {
        if steps == 0 {
            return None;
        }
        let scene = stated(&task).ok()?;
        let known = sets(&scene, steps)?.explain_within(steps, REASON);
        let known = known.ok().flatten().map(|reason| Reason::from(&reason));
        known
            .or_else(|| contradiction(&task, &scene, steps).map(Reason::from))
            .or_else(|| in_the_way(&task, stated, steps).map(Reason::from))
    };
    let free = why(SceneTask::free, free);
    Ok(Reasons { free, tolerant: why(SceneTask::tolerant, tolerant) })
}

/// The sets of a scene that a search uses.
fn sets(scene: &Scene, steps: usize) -> Option<ReachSets> {
    let options = search_options(steps).with_time_limit(Duration::ZERO);
    scene.shortest_with(&options, &mut solver()).ok()?.sets
}

/// Parts of the mission that no plan of so many steps keeps together.
fn contradiction(task: &SceneTask, scene: &Scene, steps: usize) -> Option<String> {
    let mission = task.mission_in(scene).ok()??;
    let program = scene.plain_program(steps).ok()?;
    let solver = &mut BranchAndBound::new(Options::default().with_time_limit(WITHOUT));
    let parts = program.program().mission_conflict(&mission, solver).ok()??;
    let steps = words::steps(steps);
    // A window without ends says nothing.
    let words = |part: &Mission| part.to_string().replace("[0,]", "");
    let parts: Vec<String> = parts.iter().map(words).collect();
    Some(match &parts[..] {
        [part] => format!("no plan of {steps} keeps this part of its mission: `{part}`"),
        _ => format!(
            "no plan of {steps} keeps these parts of its mission together: `{}`",
            parts.join("`, `")
        ),
    })
}

/// Says without which part there is a plan of so many steps.
fn in_the_way(
    task: &SceneTask,
    stated: fn(&SceneTask) -> Result<Scene, Error>,
    steps: usize,
) -> Option<String> {
    let parts = task.parts();
    let limit = WITHOUT / (parts.len().max(1) as u32);
    let enough = parts.into_iter().find_map(|(name, rest)| {
        let options = search_options(steps).with_time_limit(limit);
        let found = plan(&rest, &stated(&rest).ok()?, &options);
        found.ok()?.steps.map(|found| (name, found))
    });
    enough.map(|(name, found)| {
        let seconds = words::number(found as f64 * task.time_step);
        let steps = words::steps(steps);
        format!("`{name}` is in the way of plans of {steps}: without it {seconds} s are enough")
    })
}
