//! A vehicle beside a wall, as in the paper.

use carom::Error;
use carom::collision_tolerant::{Objective, Plan, Scenario};
use carom::hybrid::ShortestHorizon;
use carom::model::mps;
use carom::prelude::*;
use carom::reformulate::lower;

use crate::answer::{Answer, Side};
use crate::progress;
use crate::task::Task;
use crate::{REASON, Reasons, code, refuted, search_options};

/// Answers a task.
pub fn solve(task: &str) -> Result<Answer, String> {
    let task = Task::read(task)?;
    answer(&task).map_err(|error| error.to_string())
}

fn answer(task: &Task) -> Result<Answer, Error> {
    let scenario = task.scenario()?;
    let careful = scenario.clone().collision_free();
    let mut options = search_options(task.max_steps());
    let free = plan(&careful, "free", &options)?;
    progress::found("free", free.refuted_steps.unwrap_or(0), &Side::of(task, &free));
    options.upper_hint = free.steps;
    let tolerant = plan(&scenario, "tolerant", &options)?;
    let mut answer = Answer::new(task, &free, &tolerant);
    answer.code = code::of_wall(task);
    answer.reason = refuted(&free).or_else(|| refuted(&tolerant));
    if task.files {
        let steps = tolerant.steps.or(tolerant.refuted_steps).unwrap_or(1);
        let program = scenario.program(steps, Objective::Feasibility)?;
        answer.mps = Some(mps::write(lower(program.model())?.model())?);
    }
    Ok(answer)
}

fn plan(
    scenario: &Scenario,
    side: &'static str,
    options: &ShortestOptions,
) -> Result<ShortestHorizon<Plan>, Error> {
    let options = options.clone().with_progress(progress::refuted(side));
    scenario.shortest_with(&options, &mut BranchAndBound::default())
}

/// Why plans with so many steps are impossible.
pub fn reasons(task: &str, free: usize, tolerant: usize) -> Result<Reasons, String> {
    let scenario = Task::read(task)?.scenario().map_err(|error| error.to_string())?;
    let why = |scenario: &Scenario, steps: usize| {
        if steps == 0 {
            return None;
        }
        let reason = scenario.reach_sets().and_then(|mut sets| sets.explain_within(steps, REASON));
        reason.ok().flatten().map(|reason| reason.to_string())
    };
    let tolerant = why(&scenario, tolerant);
    Ok(Reasons { free: why(&scenario.collision_free(), free), tolerant })
}
