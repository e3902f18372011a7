//! Answers in words.

use carom::collision_tolerant::{PlanComparison, Saving, ShortestPlan};
use carom::hybrid::{Refutation, ShortestStatus, Verdict};

use crate::task::{LONGEST, Task};

/// What comes out of the comparison.
pub fn conclusion(plans: &PlanComparison, task: &Task, saving: Option<Saving>) -> String {
    let time = |plan: &ShortestPlan| plan.steps.unwrap_or(0) as f64 * task.time_step;
    match (saving, plans.hitting_pays()) {
        (Some(saving), Some(true)) => format!(
            "Hitting the wall saves {:.3} s: {:.2} % of the careful plan's time, {:.2} % of its own.",
            time(&plans.free) - time(&plans.tolerant),
            saving.of_baseline,
            saving.of_faster
        ),
        (Some(_), _) => {
            "Hitting the wall does not pay here: no plan that hits it is any faster.".into()
        }
        (None, Some(true)) => {
            "Only a plan that hits the wall gets there: without an impact it cannot stop in time."
                .into()
        }
        _ if none(&plans.free) && none(&plans.tolerant) => {
            format!("There is no plan, with or without collisions, of {LONGEST} s or less.")
        }
        _ => "The search was stopped before everything was proved.".into(),
    }
}

fn none(plan: &ShortestPlan) -> bool {
    matches!(plan.status, ShortestStatus::NoneWithin { .. })
}

/// How the shortest horizon of a plan was proved.
pub fn proof(plan: &ShortestPlan, task: &Task) -> String {
    let refuted = plan.refuted_steps.unwrap_or(0);
    let impossible = match (refuted, plan.status) {
        (_, ShortestStatus::NoneWithin { max_steps }) => {
            return format!(
                "Every number of steps up to {max_steps} ({LONGEST} s) is impossible{}.",
                how(plan)
            );
        }
        (0, _) => String::new(),
        (1, _) => format!("1 step is impossible{}.", how(plan)),
        (n, _) => format!("{n} steps are impossible, and so is every smaller number{}.", how(plan)),
    };
    let possible = match (&plan.plan, plan.steps) {
        (Some(found), Some(steps)) => format!(
            " The plan of {steps} {} was replayed by a simulator, step by step, to within {:.0e} m.",
            if steps == 1 { "step" } else { "steps" },
            found.certificate.discrete.max_position_error.max(1e-15)
        ),
        _ => format!(" The search of {} steps and more was stopped.", refuted + 1),
    };
    let apart = match &plan.plan {
        Some(found) if task.time_step >= 0.05 => format!(
            " Between samples the discrete law is up to {:.2} m away from continuous motion: \
             smaller steps agree better.",
            found.certificate.continuous.max_position_error
        ),
        _ => String::new(),
    };
    format!("{impossible}{possible}{apart}").trim().to_owned()
}

/// By what the horizons were refuted.
fn how(plan: &ShortestPlan) -> String {
    let by = |way| {
        let refuted = Verdict::Refuted(way);
        plan.attempts.iter().filter(|attempt| attempt.verdict == refuted).count()
    };
    let (sets, solves) =
        (by(Refutation::Sets), by(Refutation::Propagation) + by(Refutation::Relaxation));
    match (sets, solves) {
        (0, 0) => String::new(),
        (_, 0) => ": reach sets exclude them all, without solving a program".into(),
        (0, _) => format!(": branch and bound refuted {solves} {}", programs(solves)),
        _ => format!(
            ": reach sets exclude {sets} of them, branch and bound refuted {solves} {}",
            programs(solves)
        ),
    }
}

fn programs(count: usize) -> &'static str {
    if count == 1 { "program" } else { "programs" }
}

/// A message as a sentence.
pub fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(|letter| letter.to_uppercase().to_string());
    let stop = if text.ends_with(['.', '!', '?']) { "" } else { "." };
    format!("{}{}{stop}", first.unwrap_or_default(), letters.as_str())
}
