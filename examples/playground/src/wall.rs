//! A vehicle beside a wall, as in the paper.

use carom::Error;
use carom::collision_tolerant::{Objective, Plan, Scenario};
use carom::hybrid::{ShortestHorizon, ShortestOptions};
use carom::model::mps;
use carom::reformulate::lower;

use crate::answer::{Answer, Side};
use crate::progress;
use crate::reasons::{Reason, Reasons, reason};
use crate::task::Task;
use crate::{REASON, code, search_options, solver, told_options};

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
    // The careful plan is a plan with collisions allowed, too: only shorter ones are looked for.
    if let Some(steps) = free.steps {
        options = search_options(steps - 1);
    }
    let tolerant = match free.steps {
        Some(1) => None,
        _ => Some(plan(&scenario, "tolerant", &options)?),
    };
    let mut answer = Answer::new(task, &free, tolerant.as_ref());
    answer.code = code::of_wall(task);
    answer.reason = reason(&free, tolerant.as_ref());
    if task.files {
        let found = tolerant.as_ref().and_then(|found| found.steps.or(found.refuted_steps));
        let steps = free.steps.filter(|_| found.is_none()).or(found).unwrap_or(1);
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
    let options = told_options(side, options);
    scenario.shortest_with(&options, &mut solver())
}

/// Why plans with so many steps are impossible.
pub fn reasons(task: &str, free: usize, tolerant: usize) -> Result<Reasons, String> {
    let scenario = Task::read(task)?.scenario().map_err(|error| error.to_string())?;
    let why = |scenario: &Scenario, steps: usize| {
        if steps == 0 {
            return None;
        }
        let reason = scenario.reach_sets().and_then(|mut sets| sets.explain_within(steps, REASON));
        reason.ok().flatten().map(|reason| Reason::from(&reason))
    };
    let tolerant = why(&scenario, tolerant);
    Ok(Reasons { free: why(&scenario.collision_free(), free), tolerant })
}
