//! What the page shows of a scene.

use carom::hybrid::ShortestHorizon;
use serde::Serialize;

use crate::motion::Motion;
use crate::scene_task::SceneTask;
use crate::words::{self, Finding, Nouns};

const NOUNS: Nouns = Nouns { hitting: "Bouncing", plan: "a plan that bounces" };

/// The answer to a scene: an error, or the plans without and with collisions.
#[derive(Debug, Default, Serialize)]
pub struct SceneAnswer {
    error: Option<String>,
    free: Option<Side>,
    tolerant: Option<Side>,
    conclusion: String,
    /// Why there is no plan on one side or both, in a sentence; `None` if there is one.
    pub reason: Option<String>,
    /// The task as a Rust program.
    pub code: String,
    /// The last program as a file, if it was asked for.
    pub mps: Option<String>,
}

/// The shortest plan with or without collisions.
#[derive(Debug, Serialize)]
pub struct Side {
    /// Proved to be the shortest.
    found: bool,
    /// Proved that there is none.
    none: bool,
    /// What every plan takes at least, in s.
    least: f64,
    steps: Option<usize>,
    /// Every horizon up to this one is impossible, in steps.
    refuted: usize,
    seconds: Option<f64>,
    /// How that was proved.
    proof: String,
    plan: Option<Motion>,
}

impl SceneAnswer {
    /// A scene that cannot be planned.
    pub fn of_error(error: &str) -> Self {
        SceneAnswer { error: Some(words::sentence(error)), ..SceneAnswer::default() }
    }

    /// The answer to a scene.
    ///
    /// # Arguments
    ///
    /// * `free`: the search without collisions.
    /// * `shorter`: the search with collisions for a shorter plan; `None` if there can be none.
    pub fn new(
        task: &SceneTask,
        free: &ShortestHorizon<Motion>,
        shorter: Option<&ShortestHorizon<Motion>>,
    ) -> Self {
        let careful = finding(task, free);
        let bold = match shorter {
            Some(shorter) => finding(task, free).after(finding(task, shorter)),
            None => finding(task, free),
        };
        let careful = careful.beside(&bold);
        let plan = shorter.and_then(|found| found.plan.as_ref()).or(free.plan.as_ref());
        SceneAnswer {
            conclusion: words::conclusion(&careful, &bold, &NOUNS, task.longest),
            free: Some(Side::new(task, free.plan.as_ref(), &careful)),
            tolerant: Some(Side::new(task, plan, &bold)),
            ..SceneAnswer::default()
        }
    }
}

fn finding<'a>(task: &SceneTask, found: &'a ShortestHorizon<Motion>) -> Finding<'a> {
    Finding::new(found, |plan: &Motion| plan.check, task.time_step)
}

impl Side {
    /// The answer of one search.
    pub fn of(task: &SceneTask, found: &ShortestHorizon<Motion>) -> Self {
        Side::new(task, found.plan.as_ref(), &finding(task, found))
    }

    fn new(task: &SceneTask, plan: Option<&Motion>, finding: &Finding<'_>) -> Self {
        let mut proof = words::proof(finding);
        if task.is_robust() {
            proof += " Plans answer gusts by a linear-quadratic regulator; what is impossible is so with \
                      this feedback, and another one may need fewer steps.";
        }
        Side {
            found: finding.is_found(),
            none: finding.is_none(),
            least: finding.least(),
            steps: finding.steps,
            refuted: finding.refuted.unwrap_or(0),
            seconds: finding.seconds(),
            proof,
            plan: plan.cloned(),
        }
    }
}
