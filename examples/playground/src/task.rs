//! What the page asks.

use carom::collision_tolerant::{Endpoint, Scenario};
use carom::hybrid::scene::DamageRule;
use carom::prelude::*;
use serde::Deserialize;

/// The longest plan that is looked for, in s.
pub const LONGEST: f64 = 30.0;

/// A task, in SI units.
#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Task {
    pub start: f64,
    pub velocity: f64,
    pub goal: f64,
    pub restitution: f64,
    pub impact_limit: Option<f64>,
    pub max_speed: f64,
    pub max_acceleration: f64,
    /// Δt.
    pub time_step: f64,
    /// Twice the step, for a quick look.
    #[serde(default)]
    coarse: bool,
    /// Whether the program is asked for as a file.
    #[serde(default)]
    pub files: bool,
}

impl Task {
    /// Reads a task.
    pub fn read(text: &str) -> Result<Self, String> {
        let mut task: Task = serde_json::from_str(text).map_err(|error| error.to_string())?;
        if task.coarse {
            task.time_step *= 2.0;
        }
        check_time_step(task.time_step).map(|()| task)
    }

    /// The task as a scenario. As in the paper, plans begin and end without acceleration.
    pub fn scenario(&self) -> Result<Scenario, Error> {
        let at = |position| Endpoint::at_rest(position).with_acceleration(0.0);
        let mut damage = DamageRule::default();
        damage.per_hit = self.impact_limit;
        Scenario::paper()
            .with_start(at(self.start).with_velocity(self.velocity))
            .with_goal(at(self.goal))
            .with_acceleration(-self.max_acceleration..=self.max_acceleration)
            .with_max_speed(self.max_speed)
            .with_time_step(self.time_step)
            .with_damage(damage)
            .with_restitution(self.restitution)
    }

    /// The largest horizon that is tried, in steps.
    pub fn max_steps(&self) -> usize {
        ((LONGEST / self.time_step).ceil() as usize).max(1)
    }
}

/// Refuses time steps (s) that would take a visitor's patience.
pub fn check_time_step(time_step: f64) -> Result<(), String> {
    if time_step.is_finite() && time_step >= 1e-3 {
        Ok(())
    } else {
        Err("the time step must be at least 1 ms".into())
    }
}

/// A number without the digits that nobody sees.
pub fn round(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}
