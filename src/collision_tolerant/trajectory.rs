//! The samples of a plan and its impacts.

use std::fmt::Write as _;

use super::program::PlanningProgram;
use super::scenario::Scenario;
use crate::error::Error;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::hybrid::simulate::continuous::advance;
use crate::hybrid::{ContactLaw, Samples};
use crate::number::{DIGITS, rounded};
use crate::solution::Solution;

/// One contact of a plan. Impulse and energy are per unit of mass.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Impact {
    /// The step t with ζ(t) = 1.
    pub step: usize,
    /// Time of the impact, in s: when the flight from the step's first sample meets the wall, or
    /// the end of the step if it does not.
    pub time: f64,
    /// Speed into the wall before the impact, in m/s.
    pub speed_before: f64,
    /// Speed away from the wall after the impact, in m/s.
    pub speed_after: f64,
    /// Change of velocity, in m/s (impulse per unit of mass).
    pub impulse: f64,
    /// Kinetic energy lost, in J/kg.
    pub energy_lost: f64,
}

/// A plan's samples t = 0, ..., τ; all vectors have τ + 1 entries.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Trajectory {
    /// Δt, in s.
    pub time_step: f64,
    /// Times, in s.
    pub time: Vec<f64>,
    /// x(t), in m.
    pub position: Vec<f64>,
    /// v(t), in m/s.
    pub velocity: Vec<f64>,
    /// a(t), in m/s²; the last one is never applied.
    pub acceleration: Vec<f64>,
    /// ζ(t); the last one is always false.
    pub contact: Vec<bool>,
    /// D(t), in m/s: the impact speed if there is a contact, otherwise 0.
    pub damage: Vec<f64>,
    /// The contacts, in order.
    pub impacts: Vec<Impact>,
}

impl Trajectory {
    /// Reads a trajectory from a solution of a program. Use
    /// [`Plan::certify`](super::Plan::certify) for a plan that is carried out.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::NoPoint`] if the solution has no point, [`ErrorKind::ForeignHandle`] if it is of
    /// another model.
    pub fn read(
        scenario: &Scenario,
        program: &PlanningProgram,
        solution: &Solution,
    ) -> Result<Self, Error> {
        let values = |family: &crate::model::Family| {
            family.iter().map(|variable| solution.value(variable)).collect::<Result<Vec<_>, _>>()
        };
        let (steps, time_step) = (program.horizon.steps(), program.horizon.time_step());
        let mut trajectory = Trajectory {
            time_step,
            time: (0..=steps).map(|t| t as f64 * time_step).collect(),
            position: values(&program.position)?,
            velocity: values(&program.velocity)?,
            acceleration: values(&program.acceleration)?,
            contact: vec![false; steps + 1],
            damage: vec![0.0; steps + 1],
            impacts: Vec::new(),
        };
        let contacts = program.contact.iter().flatten().zip(&program.impact_speed).enumerate();
        for (t, (zeta, speed)) in contacts {
            if solution.value(zeta)? > 0.5 {
                let speed = solution.value(speed)?;
                trajectory.contact[t] = true;
                let start = -scenario.contact.wall.rate(trajectory.velocity[t]);
                trajectory.damage[t] = if scenario.is_sound() { speed.max(start) } else { speed };
                let impact = trajectory.impact(scenario, t, speed);
                trajectory.impacts.push(impact);
            }
        }
        Ok(trajectory)
    }

    fn impact(&self, scenario: &Scenario, step: usize, speed_before: f64) -> Impact {
        let (wall, e) = (scenario.contact.wall, scenario.contact.restitution.value());
        let (gap, rate) = (wall.gap(self.position[step]), wall.rate(self.velocity[step]));
        let delay = match scenario.contact.law {
            // The vehicle is at or inside the wall when the step begins.
            ContactLaw::Literal => 0.0,
            _ => {
                let acceleration = wall.rate(self.acceleration[step]);
                let flight = advance(gap, rate, acceleration, self.time_step, e);
                flight.impacts.first().map_or(self.time_step, |&(time, _)| time)
            }
        };
        let speed_after = e * speed_before;
        Impact {
            step,
            time: self.time[step] + delay,
            speed_before,
            speed_after,
            impulse: speed_before + speed_after,
            energy_lost: 0.5 * (speed_before * speed_before - speed_after * speed_after),
        }
    }

    /// Number of steps, τ.
    pub fn steps(&self) -> usize {
        self.time.len() - 1
    }

    /// Duration τ Δt, in s.
    pub fn duration(&self) -> f64 {
        self.steps() as f64 * self.time_step
    }

    /// Sum of the damage over all contacts, in m/s.
    pub fn total_damage(&self) -> f64 {
        self.damage.iter().sum()
    }

    /// Largest damage of one contact, in m/s; 0 without contacts.
    pub fn largest_damage(&self) -> f64 {
        self.damage.iter().copied().fold(0.0, f64::max)
    }

    /// Effort `Σ Δt a(t)²` over t = 0, ..., τ-1, in m²/s³.
    pub fn effort(&self) -> f64 {
        let applied = &self.acceleration[..self.steps()];
        applied.iter().map(|a| self.time_step * a * a).sum()
    }

    /// The samples, for a replay.
    pub fn samples(&self) -> Samples<'_> {
        let steps = self.steps();
        Samples {
            time_step: self.time_step,
            position: &self.position,
            velocity: &self.velocity,
            acceleration: &self.acceleration[..steps],
            contact: &self.contact[..steps],
        }
    }

    /// The samples as comma-separated text: a header
    /// `time,position,velocity,acceleration, contact,damage` (s, m, m/s, m/s², 0 or 1, m/s) and one
    /// line per sample.
    pub fn to_csv(&self) -> String {
        let mut text = String::from("time,position,velocity,acceleration,contact,damage\n");
        for t in 0..self.time.len() {
            // Writing into a string cannot fail.
            let _ = writeln!(
                text,
                "{},{},{},{},{},{}",
                rounded(self.time[t], DIGITS),
                rounded(self.position[t], DIGITS),
                rounded(self.velocity[t], DIGITS),
                rounded(self.acceleration[t], DIGITS),
                u8::from(self.contact[t]),
                rounded(self.damage[t], DIGITS)
            );
        }
        text
    }
}
