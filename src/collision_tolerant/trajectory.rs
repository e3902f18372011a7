//! The samples of a plan and its impacts.

use std::fmt::Write as _;

/// Significant digits of numbers in tables: all that a solve can have right, without the noise
/// behind.
const SIGNIFICANT_DIGITS: i32 = 12;

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
    /// Without samples.
    pub(super) fn new(time_step: f64) -> Self {
        Trajectory {
            time_step,
            time: Vec::new(),
            position: Vec::new(),
            velocity: Vec::new(),
            acceleration: Vec::new(),
            contact: Vec::new(),
            damage: Vec::new(),
            impacts: Vec::new(),
        }
    }

    /// Adds a(τ), in m/s², and the times of the samples, none of which has an impact yet.
    pub(super) fn complete(&mut self, last: f64) {
        self.acceleration.push(last);
        let samples = self.acceleration.len();
        self.time = (0..samples).map(|t| t as f64 * self.time_step).collect();
        (self.contact, self.damage) = (vec![false; samples], vec![0.0; samples]);
    }

    /// Adds an impact of a step: its time (s), its speed, and the speed that counts as damage
    /// (m/s).
    pub(super) fn add_impact(&mut self, step: usize, time: f64, [speed, damage]: [f64; 2], e: f64) {
        (self.contact[step], self.damage[step]) = (true, damage);
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
        // Below the last digit of the largest number of a column is the noise of the solve.
        let noise = columns.map(|column| {
            let largest = column.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
            let digit = 10.0_f64.powi(-SIGNIFICANT_DIGITS);
            if largest < digit { digit } else { largest * digit }
        });
        for (t, (time, contact)) in self.time.iter().zip(&self.contact).enumerate() {
            let [position, velocity, acceleration, damage] =
                [0, 1, 2, 3].map(|k| rounded(columns[k][t], noise[k]));
            let (time, contact) = (rounded(*time, 0.0), u8::from(*contact));
            // Writing into a string cannot fail.
            let _ =
                writeln!(text, "{time},{position},{velocity},{acceleration},{contact},{damage}");
        }
        text
    }
}

/// A number with as many digits as a solve can have right; 0 if it is less than the noise.
fn rounded(value: f64, noise: f64) -> String {
    if value.abs() < noise || value == 0.0 {
        return "0".into();
    }
    let rounded = format!("{value:.*e}", SIGNIFICANT_DIGITS as usize - 1).parse().unwrap_or(value);
    match (1e-6..1e15).contains(&rounded.abs()) {
        true => rounded.to_string(),
        false => format!("{rounded:e}"),
    }
}
