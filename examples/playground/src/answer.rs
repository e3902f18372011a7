//! What the page shows.

use carom::collision_tolerant::{Plan, Trajectory};
use carom::hybrid::ShortestHorizon;
use carom::hybrid::reach::{ReachSet, Tube};
use serde::Serialize;

use crate::task::{LONGEST, Task};
use crate::words::{self, Finding, Nouns, PlanCheck};

/// Approximate number of samples whose reach sets are drawn.
const SAMPLES: usize = 32;

const NOUNS: Nouns = Nouns { hitting: "Hitting the wall", plan: "a plan that hits the wall" };

/// The answer to a task: an error, or the plans without and with collisions.
#[derive(Debug, Default, Serialize)]
pub struct Answer {
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

impl Answer {
    /// A task that cannot be planned.
    pub fn of_error(error: &str) -> Self {
        Answer { error: Some(words::sentence(error)), ..Answer::default() }
    }

    /// The answer to a task.
    ///
    /// # Arguments
    ///
    /// * `free`: the search without collisions.
    /// * `shorter`: the search with collisions for a shorter plan; `None` if there can be none.
    pub fn new(
        task: &Task,
        free: &ShortestHorizon<Plan>,
        shorter: Option<&ShortestHorizon<Plan>>,
    ) -> Self {
        let fast = match shorter {
            Some(shorter) => finding(task, free).after(finding(task, shorter)),
            None => finding(task, free),
        };
        let slow = finding(task, free).beside(&fast);
        let shown = shorter.filter(|found| found.plan.is_some()).unwrap_or(free);
        Answer {
            free: Some(Side::new(free, &slow)),
            tolerant: Some(Side::new(shown, &fast)),
            conclusion: words::conclusion(&slow, &fast, &NOUNS, LONGEST),
            ..Answer::default()
        }
    }
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
    curve: Option<Curve>,
    /// Reach sets of some samples.
    sets: Vec<Sets>,
}

/// A plan.
#[derive(Debug, Serialize)]
struct Curve {
    time: Vec<f64>,
    position: Vec<f64>,
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
    impacts: Vec<Hit>,
}

/// An impact: its time (s), and the speeds before and after it (m/s).
#[derive(Debug, Serialize)]
struct Hit {
    time: f64,
    before: f64,
    after: f64,
}

/// Outlines in the plane of position (m) and velocity (m/s).
#[derive(Debug, Serialize)]
struct Sets {
    time: f64,
    reached: Vec<[f64; 2]>,
    #[serde(rename = "toGo")]
    to_go: Vec<[f64; 2]>,
}

fn finding<'a>(task: &Task, found: &'a ShortestHorizon<Plan>) -> Finding<'a> {
    Finding::new(found, |plan: &Plan| PlanCheck::of(&plan.certificate), task.time_step)
}

impl Side {
    /// The answer of one search.
    pub fn of(task: &Task, found: &ShortestHorizon<Plan>) -> Self {
        Side::new(found, &finding(task, found))
    }

    fn new(plan: &ShortestHorizon<Plan>, finding: &Finding<'_>) -> Self {
        let trajectory = plan.plan.as_ref().map(|plan| &plan.trajectory);
        let sets = trajectory.zip(plan.tube.as_ref()).map(|(path, tube)| sets(tube, path));
        Side {
            found: finding.is_found(),
            none: finding.is_none(),
            least: finding.least(),
            steps: finding.steps,
            refuted: finding.refuted.unwrap_or(0),
            seconds: finding.seconds(),
            proof: words::proof(finding),
            curve: trajectory.map(Curve::new),
            sets: sets.unwrap_or_default(),
        }
    }
}

impl Curve {
    fn new(path: &Trajectory) -> Self {
        let hit = |impact: &carom::collision_tolerant::Impact| Hit {
            time: impact.time,
            before: impact.speed_before,
            after: impact.speed_after,
        };
        Curve {
            time: path.time.clone(),
            position: path.position.clone(),
            velocity: path.velocity.clone(),
            acceleration: path.acceleration.clone(),
            impacts: path.impacts.iter().map(hit).collect(),
        }
    }
}

/// The sets that hold the plan, at some samples.
fn sets(tube: &Tube, path: &Trajectory) -> Vec<Sets> {
    let every = (tube.steps() / SAMPLES).max(1);
    let of = |sample: usize| {
        let state = [path.position[sample], path.velocity[sample]];
        Sets {
            time: path.time[sample],
            reached: holding(tube.reached(sample), state),
            to_go: holding(tube.to_go(sample), state),
        }
    };
    (0..path.time.len()).step_by(every).map(of).collect()
}

/// The outline of the first set that contains a state. Sets are ordered by the number of impacts,
/// so this is the set of the plan's own number.
fn holding<'a>(mut sets: impl Iterator<Item = &'a ReachSet>, state: [f64; 2]) -> Vec<[f64; 2]> {
    let holds = |set: &&ReachSet| set.contains(&state).unwrap_or(false);
    let outline = sets.find(holds).and_then(|set| set.outline(0, 1).ok()).unwrap_or_default();
    let is_finite = outline.iter().flatten().all(|value| value.is_finite());
    if is_finite { outline } else { Vec::new() }
}
