//! The samples of a plan and its impacts.

use std::fmt::Write as _;

use super::program::PlanningProgram;
use crate::error::Error;
use crate::model::Affine;
use crate::number::{DIGITS, TableColumn, rounded};
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
    /// Reads the samples of a solution of a program, without its impacts.
    pub(super) fn read(program: &PlanningProgram, solution: &Solution) -> Result<Self, Error> {
        let values = |family: &[Affine]| {
            family.iter().map(|value| solution.value(value)).collect::<Result<Vec<_>, _>>()
        };
        let (steps, time_step) = (program.steps(), program.scenario.time_step);
        let mut contact = vec![false; steps + 1];
        for (hits, zeta) in contact.iter_mut().zip(program.contact.iter().flatten()) {
            *hits = solution.value(zeta)? > 0.5;
        }
        Ok(Trajectory {
            time_step,
            time: (0..=steps).map(|t| t as f64 * time_step).collect(),
            position: values(&program.position)?,
            velocity: values(&program.velocity)?,
            acceleration: values(&program.acceleration)?,
            contact,
            damage: vec![0.0; steps + 1],
            impacts: Vec::new(),
        })
    }

    /// Adds an impact of a step: its time (s), its speed, and the speed that counts as damage
    /// (m/s).
    pub(super) fn add_impact(&mut self, step: usize, time: f64, [speed, damage]: [f64; 2], e: f64) {
        self.damage[step] = damage;
        let speed_after = e * speed;
        self.impacts.push(Impact {
            step,
            time,
            speed_before: speed,
            speed_after,
            impulse: speed + speed_after,
            energy_lost: 0.5 * (speed * speed - speed_after * speed_after),
        });
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

    /// The samples as comma-separated text: a header
    /// `time,position,velocity,acceleration, contact,damage` (s, m, m/s, m/s², 0 or 1, m/s) and one
    /// line per sample.
    pub fn to_csv(&self) -> String {
        let mut text = String::from("time,position,velocity,acceleration,contact,damage\n");
        let columns = [&self.position, &self.velocity, &self.acceleration, &self.damage];
        let [position, velocity, acceleration, damage] = columns.map(TableColumn::new);
        for t in 0..self.time.len() {
            // Writing into a string cannot fail.
            let _ = writeln!(
                text,
                "{},{},{},{},{},{}",
                rounded(self.time[t], DIGITS),
                position.text(self.position[t]),
                velocity.text(self.velocity[t]),
                acceleration.text(self.acceleration[t]),
                u8::from(self.contact[t]),
                damage.text(self.damage[t])
            );
        }
        text
    }
}
