//! Scenes that the page asks about.

use carom::hybrid::scene::{Body, DamageMeasure, DamageRule, Scene, Shape, Solid, Surface};
use carom::hybrid::{Mission, Region, Restitution};
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
    pub obstacles: Vec<Place>,
    /// Of walls, obstacles and bodies.
    pub restitution: f64,
    /// By how much the restitution of the walls may be off, at each hit anew.
    #[serde(default)]
    pub spread: f64,
    /// Places that the mission names, which are in nobody's way.
    #[serde(default)]
    pub places: Vec<Place>,
    /// The mission of the first body, over `in` with the name of a place.
    #[serde(default)]
    pub mission: Option<String>,
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
    /// By how much each number of the goal may be missed.
    #[serde(default)]
    pub goal_half: [f64; 4],
    pub max_speed: f64,
    pub max_acceleration: f64,
    /// Whether these limits are on the lengths of velocity and acceleration, and not on each axis.
    #[serde(default)]
    pub is_round: bool,
    /// Gusts change the velocity along each axis by so much in a step at most, in m/s.
    #[serde(default)]
    pub gusts: f64,
}

/// A box with a name: an obstacle, or a place of a mission.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Place {
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
        let surface = Surface::bounce(Restitution::new(self.restitution)?);
        self.scene(if self.spread > 0.0 { surface.with_spread(self.spread) } else { surface })
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
        // A gust may turn the hit of a corner into a miss, so that no plan under gusts hits a box.
        let boxes = if self.is_robust() { Surface::avoid() } else { surface };
        for Place { name, sides } in &self.obstacles {
            let solid = Solid::cuboid(name, intervals(sides), boxes);
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

    /// Whether plans have to hold for every gust.
    pub fn is_robust(&self) -> bool {
        self.spread > 0.0 || self.bodies.iter().any(|body| body.gusts > 0.0)
    }

    /// The mission in a scene of this task.
    pub fn mission_in(&self, scene: &Scene) -> Result<Option<Mission>, Error> {
        let (Some(text), Some(body)) = (&self.mission, self.bodies.first()) else {
            return Ok(None);
        };
        let body = scene.body_named(&body.name)?;
        let [x, y] = [body.position(0), body.position(1)];
        let places =
            self.places.iter().map(|Place { name, sides: [[left, right], [low, high]] }| {
                Mission::holds(
                    format!("in {name}"),
                    [x.within(*left, *right), y.within(*low, *high)],
                )
            });
        Mission::parse(text, places).map(Some)
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
        if self.is_robust() {
            let mut rest = self.clone();
            rest.spread = 0.0;
            rest.bodies.iter_mut().for_each(|body| body.gusts = 0.0);
            parts.push(("every gust".into(), rest));
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
        let mut body = Body::new(&self.name, room, self.max_speed, self.max_acceleration)
            .with_mass(self.mass)
            .with_shape(shape)
            .with_start(self.start);
        if self.is_round {
            body =
                body.with_speed_ball(self.max_speed).with_acceleration_ball(self.max_acceleration);
        }
        if self.gusts > 0.0 {
            let gusts = -self.gusts..=self.gusts;
            body = body.with_pushes([gusts.clone(), gusts]);
        }
        let goal = match self.goal_ranges() {
            Some(goal) => Region::from(goal),
            None => Region::from([room, &[Interval::REALS; 2]].concat()),
        };
        body.with_goal(goal)
    }

    /// The numbers with which it may end, if it has a goal.
    pub fn goal_ranges(&self) -> Option<Vec<Interval>> {
        let ends = |(at, half): (f64, f64)| Interval::new(round(at - half), round(at + half));
        let exact = self.goal_half == [0.0; 4];
        let range = |(at, half)| if exact { Interval::point(at) } else { ends((at, half)) };
        Some(self.goal?.into_iter().zip(self.goal_half).map(range).collect())
    }
}

fn intervals(sides: &Sides) -> Vec<Interval> {
    sides.iter().map(|&[lower, upper]| Interval::new(lower, upper)).collect()
}
