//! What the page shows of a scene.

use carom::hybrid::ShortestHorizon;
use carom::hybrid::scene::{BodyPath, SceneHit, ScenePlan};
use serde::Serialize;

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

/// A plan.
#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
struct Motion {
    time_step: f64,
    bodies: Vec<Path>,
    hits: Vec<Hit>,
}

/// The samples of a body.
#[derive(Debug, Serialize)]
struct Path {
    name: String,
    position: Vec<Vec<f64>>,
    velocity: Vec<Vec<f64>>,
}

/// A hit: who, when (s), where (m), how fast (m/s), and the impulse on the body (N s). Time and
/// place are where the impact is located in its step; speed and impulse are those of the
/// time-stepped law, which counts the speed at the end of the step.
#[derive(Debug, Serialize)]
struct Hit {
    body: String,
    contact: String,
    step: usize,
    time: f64,
    place: Vec<f64>,
    speed: f64,
    impulse: Vec<f64>,
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
        free: &ShortestHorizon<ScenePlan>,
        shorter: Option<&ShortestHorizon<ScenePlan>>,
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
            free: Some(Side::new(free.plan.as_ref(), &careful)),
            tolerant: Some(Side::new(plan, &bold)),
            ..SceneAnswer::default()
        }
    }
}

fn finding<'a>(task: &SceneTask, found: &'a ShortestHorizon<ScenePlan>) -> Finding<'a> {
    Finding::new(found, |plan: &ScenePlan| &plan.certificate, task.time_step)
}

impl Side {
    /// The answer of one search.
    pub fn of(task: &SceneTask, found: &ShortestHorizon<ScenePlan>) -> Self {
        Side::new(found.plan.as_ref(), &finding(task, found))
    }

    fn new(plan: Option<&ScenePlan>, finding: &Finding<'_>) -> Self {
        Side {
            found: finding.is_found(),
            none: finding.is_none(),
            least: finding.least(),
            steps: finding.steps,
            refuted: finding.refuted.unwrap_or(0),
            seconds: finding.seconds(),
            proof: words::proof(finding),
            plan: plan.map(Motion::new),
        }
    }
}

impl Motion {
    fn new(plan: &ScenePlan) -> Self {
        let path = |body: &BodyPath| Path {
            name: body.name.clone(),
            position: body.position.clone(),
            velocity: body.velocity.clone(),
        };
        let hit = |hit: &SceneHit| Hit {
            body: hit.body.clone(),
            contact: hit.contact.clone(),
            step: hit.step,
            time: hit.time,
            place: hit.place.clone(),
            speed: hit.end_speed,
            impulse: hit.impulse.clone(),
        };
        Motion {
            time_step: plan.time_step,
            bodies: plan.bodies.iter().map(path).collect(),
            hits: plan.hits.iter().map(hit).collect(),
        }
    }
}
