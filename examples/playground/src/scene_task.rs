//! Scenes that the page asks about.

use carom::hybrid::scene::{Body, DamageMeasure, DamageRule, Scene, Shape, Solid, Surface};
use carom::hybrid::{Region, Restitution};
use carom::interval::Interval;
use carom::prelude::*;
use serde::Deserialize;

use crate::task::check_time_step;

/// Bodies in a room with obstacles, in SI units.
#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct SceneTask {
    /// Δt.
    pub time_step: f64,
    /// The longest plan that is looked for, in s.
    pub longest: f64,
    /// Where bodies may be.
    room: Sides,
    /// Whether the room has walls, to bounce off.
    walls: bool,
    bodies: Vec<BodyTask>,
    /// To be avoided.
    obstacles: Vec<Obstacle>,
    /// Of walls and bodies.
    restitution: f64,
    /// On each body and hit, in N s.
    impulse_limit: Option<f64>,
}

/// The ranges of a box.
type Sides = [[f64; 2]; 2];

/// A body. Its shape is a box if it has `half`, otherwise a disc.
#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
struct BodyTask {
    name: String,
    mass: f64,
    half: Option<[f64; 2]>,
    #[serde(default)]
    radius: f64,
    start: [f64; 4],
    /// None for a body that may end anywhere.
    goal: Option<[f64; 4]>,
    max_speed: f64,
    max_acceleration: f64,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Obstacle {
    name: String,
    sides: Sides,
}

impl SceneTask {
    /// Reads a task.
    pub fn read(text: &str) -> Result<Self, String> {
        let task: SceneTask = serde_json::from_str(text).map_err(|error| error.to_string())?;
        check_time_step(task.time_step).map(|()| task)
    }

    /// The scene with collisions.
    pub fn tolerant(&self) -> Result<Scene, Error> {
        self.scene(Surface::bounce(Restitution::new(self.restitution)?))
    }

    /// The scene without collisions.
    pub fn free(&self) -> Result<Scene, Error> {
        self.scene(Surface::avoid())
    }

    fn scene(&self, surface: Surface) -> Result<Scene, Error> {
        let room = intervals(&self.room);
        let mut scene = Scene::new(self.time_step);
        let mut bodies = Vec::new();
        for body in &self.bodies {
            bodies.push(scene.body(body.stated(&room))?);
        }
        if self.walls {
            scene = scene.with_room("wall", &room, surface);
        }
        for (k, first) in bodies.iter().enumerate() {
            for second in &bodies[k + 1..] {
                scene.pair(*first, *second, surface)?;
            }
        }
        for Obstacle { name, sides } in &self.obstacles {
            let solid = Solid::cuboid(name, &intervals(sides), Surface::avoid());
            scene.obstacle(solid)?;
        }
        Ok(match self.impulse_limit {
            Some(limit) if surface.restitution().is_some() => {
                let rule = DamageRule::new("impulse", DamageMeasure::NormalImpulse);
                scene.with_rule(rule.with_per_hit(limit))
            }
            _ => scene,
        })
    }

    /// The largest horizon that is tried, in steps.
    pub fn max_steps(&self) -> usize {
        ((self.longest / self.time_step).ceil() as usize).max(1)
    }
}

impl BodyTask {
    fn stated(&self, room: &[Interval]) -> Body {
        let shape = match self.half {
            Some(half) => Shape::Box(half.to_vec()),
            None if self.radius > 0.0 => Shape::Ball(self.radius),
            None => Shape::Point,
        };
        let body = Body::new(&self.name, room, self.max_speed, self.max_acceleration)
            .with_mass(self.mass)
            .with_shape(shape)
            .with_start(self.start);
        let goal = match self.goal {
            Some(goal) => Region::point(goal),
            None => Region::from([room, &[Interval::REALS; 2]].concat()),
        };
        body.with_goal(goal)
    }
}

fn intervals(sides: &Sides) -> Vec<Interval> {
    sides.iter().map(|&[lower, upper]| Interval::new(lower, upper)).collect()
}
