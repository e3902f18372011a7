//! Scenes that the page asks about.

use carom::hybrid::scene::{Body, DamageMeasure, DamageRule, Scene, Shape, Solid, Surface};
use carom::hybrid::{Region, Restitution};
use carom::interval::Interval;
use carom::prelude::*;
use serde::Deserialize;

use crate::task::{check_time_step, round};

/// Bodies in a room with obstacles, in SI units.
#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct SceneTask {
    /// Δt.
    pub time_step: f64,
    /// The longest plan that is looked for, in s.
    pub longest: f64,
    /// Where bodies may be.
    pub room: Sides,
    /// Whether the room has walls, to bounce off.
    pub walls: bool,
    pub bodies: Vec<BodyTask>,
    pub obstacles: Vec<Obstacle>,
    /// Of walls, obstacles and bodies.
    pub restitution: f64,
    /// On each body and hit, in N s.
    pub impulse_limit: Option<f64>,
    /// Twice the step, for a quick look.
    #[serde(default)]
    coarse: bool,
    /// Whether it is being dragged, so that little time is spent on the search with collisions.
    #[serde(default)]
    pub hurried: bool,
    /// Whether the program is asked for as a file.
    #[serde(default)]
    pub files: bool,
}

/// The ranges of a box.
pub type Sides = [[f64; 2]; 2];

/// The walls of a room: the name, the normal into the room, and the number of its side's limit.
pub const WALLS: [(&str, [f64; 2], usize); 4] = [
    ("left wall", [1.0, 0.0], 0),
    ("right wall", [-1.0, 0.0], 1),
    ("lower wall", [0.0, 1.0], 0),
    ("upper wall", [0.0, -1.0], 1),
];

/// A body. Its shape is a box if it has `half`, otherwise a disc.
#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct BodyTask {
    pub name: String,
    pub mass: f64,
    pub half: Option<[f64; 2]>,
    #[serde(default)]
    pub radius: f64,
    pub start: [f64; 4],
    /// None for a body that may end anywhere.
    pub goal: Option<[f64; 4]>,
    pub max_speed: f64,
    pub max_acceleration: f64,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Obstacle {
    pub name: String,
    pub sides: Sides,
}

impl SceneTask {
    /// Reads a task.
    pub fn read(text: &str) -> Result<Self, String> {
        let mut task: SceneTask = serde_json::from_str(text).map_err(|error| error.to_string())?;
        if task.coarse {
            task.time_step *= 2.0;
        }
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
        let mut scene = Scene::new(self.time_step);
        let mut bodies = Vec::new();
        for body in &self.bodies {
            bodies.push(scene.body(body.stated(&intervals(&self.range(body))))?);
        }
        if self.walls {
            for (name, normal, end) in WALLS {
                let along = usize::from(normal[0] == 0.0);
                let at = self.room[along][end] * normal[along];
                scene.obstacle(Solid::halfspace(name, normal, at, surface))?;
            }
        }
        for (k, first) in bodies.iter().enumerate() {
            for second in &bodies[k + 1..] {
                scene.pair(*first, *second, surface)?;
            }
        }
        for Obstacle { name, sides } in &self.obstacles {
            let solid = Solid::cuboid(name, &intervals(sides), surface);
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

    /// Where the middle of a body may be. Walls keep all of it in the room; without walls, this does.
    pub fn range(&self, body: &BodyTask) -> Sides {
        let half = body.half.filter(|_| !self.walls).unwrap_or_default();
        let within = |axis: usize| {
            let [lower, upper] = self.room[axis];
            [round(lower + half[axis]), round(upper - half[axis])]
        };
        [within(0), within(1)]
    }

    /// What may be in the way: its name, and the task without it.
    pub fn parts(&self) -> Vec<(String, SceneTask)> {
        let mut parts = Vec::new();
        for k in 0..self.obstacles.len() {
            let mut rest = self.clone();
            parts.push((rest.obstacles.remove(k).name, rest));
        }
        for k in 1..self.bodies.len() {
            let mut rest = self.clone();
            parts.push((rest.bodies.remove(k).name, rest));
        }
        parts
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
