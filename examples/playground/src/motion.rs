//! Plans of scenes as the page draws them.

use carom::Error;
use carom::hybrid::HybridRun;
use carom::hybrid::scene::{BodyPath, SceneHit, ScenePlan};
use serde::Serialize;

use crate::scene_task::{SceneTask, Sides, WALLS};
use crate::words::PlanCheck;

/// A plan.
#[derive(Debug, Clone, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Motion {
    time_step: f64,
    pub bodies: Vec<Path>,
    pub hits: Vec<Hit>,
    /// Under gusts, places of the first body in some flights.
    pub flights: Vec<Vec<[f64; 2]>>,
    /// Under gusts, boxes that hold the first body in every flight, by sample: the ends of x and of y.
    pub tube: Vec<Sides>,
    #[serde(skip)]
    pub check: PlanCheck,
}

/// The samples of a body.
#[derive(Debug, Clone, Serialize)]
pub struct Path {
    name: String,
    pub position: Vec<Vec<f64>>,
    velocity: Vec<Vec<f64>>,
}

/// A hit: who, when (s), where (m), how fast (m/s), and the impulse on the body (N s). Time and
/// place are where the impact is located in its step; speed and impulse are those of the
/// time-stepped law, which counts the speed at the end of the step.
#[derive(Debug, Clone, Serialize)]
pub struct Hit {
    body: String,
    contact: String,
    pub step: usize,
    time: f64,
    pub place: Vec<f64>,
    speed: f64,
    impulse: Vec<f64>,
}

impl From<ScenePlan> for Motion {
    fn from(plan: ScenePlan) -> Self {
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
            flights: Vec::new(),
            tube: Vec::new(),
            check: PlanCheck::of(&plan.certificate),
        }
    }
}

impl Motion {
    /// A run of the scene's system, with the hits of its walls.
    pub fn of_run(task: &SceneTask, run: &HybridRun, check: PlanCheck) -> Result<Self, Error> {
        let (mut bodies, mut hits) = (Vec::new(), Vec::new());
        for body in &task.bodies {
            let state = |quantity| run.state(&format!("{} {quantity}", body.name));
            let input = |quantity| run.input(&format!("{} {quantity}", body.name));
            let position = pairs(state("x")?, state("y")?);
            let velocity = pairs(state("vx")?, state("vy")?);
            let acceleration = pairs(input("ax")?, input("ay")?);
            for (wall, normal, end) in WALLS {
                let Ok(taken) = run.transitions(&format!("{} at {wall}", body.name)) else {
                    continue;
                };
                let axis = usize::from(normal[0] == 0.0);
                let at = task.range(body)[axis][end];
                for (step, _) in taken.iter().enumerate().filter(|(_, taken)| *taken == "hit") {
                    let (x, v, a) = (&position[step], &velocity[step], &acceleration[step]);
                    let after = crossing(x[axis] - at, v[axis], a[axis], task.time_step);
                    let mut place: Vec<f64> =
                        (0..2).map(|k| x[k] + after * (v[k] + 0.5 * after * a[k])).collect();
                    place[axis] = at;
                    let speed = -normal[axis] * (v[axis] + task.time_step * a[axis]);
                    let size = (1.0 + task.restitution) * body.mass * speed;
                    hits.push(Hit {
                        body: body.name.clone(),
                        contact: wall.to_owned(),
                        step,
                        time: step as f64 * task.time_step + after,
                        place,
                        speed,
                        impulse: normal.iter().map(|part| part * size).collect(),
                    });
                }
            }
            bodies.push(Path { name: body.name.clone(), position, velocity });
        }
        hits.sort_by(|a: &Hit, b| a.time.total_cmp(&b.time));
        let (flights, tube) = (Vec::new(), Vec::new());
        Ok(Motion { time_step: run.time_step, bodies, hits, flights, tube, check })
    }
}

fn pairs(x: &[f64], y: &[f64]) -> Vec<Vec<f64>> {
    x.iter().zip(y).map(|(x, y)| vec![*x, *y]).collect()
}

/// The first time up to `longest` at which `distance + v t + a t² / 2` is 0; `longest` if there is
/// none.
fn crossing(distance: f64, v: f64, a: f64, longest: f64) -> f64 {
    // The half sum that does not cancel: its quotients with both ends are the two roots.
    let sum = -0.5 * (v + (v * v - 2.0 * a * distance).max(0.0).sqrt().copysign(v));
    let times = [distance / sum, 2.0 * sum / a];
    times.into_iter().filter(|time| *time >= 0.0).fold(longest, f64::min)
}
