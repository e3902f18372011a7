//! The discrete replay: the same law, open loop, with contacts decided by the replay.

use super::Samples;
use super::error::ReplayError;
use crate::error::Error;
use crate::hybrid::contact::{Contact, ContactLaw};
use crate::tolerance;

/// One contact of a replay. Impulse and energies are per unit of mass.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ReplayedImpact {
    /// The step t in which it happens.
    pub step: usize,
    /// Speed into the wall before, in m/s. The literal law also applies while moving away, where
    /// this is negative.
    pub speed_before: f64,
    /// Speed away from the wall after, in m/s.
    pub speed_after: f64,
    /// Change of velocity along the wall's normal, in m/s: `(1+e)` times the speed before.
    pub impulse: f64,
    /// Kinetic energy before, in J/kg.
    pub energy_before: f64,
    /// Kinetic energy after, in J/kg: `e²` times the energy before.
    pub energy_after: f64,
}

/// The result of a discrete replay.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DiscreteReplay {
    /// x(0), ..., as replayed, in m; shorter than the plan if `blocked`.
    pub position: Vec<f64>,
    /// v(0), ..., as replayed, in m/s.
    pub velocity: Vec<f64>,
    /// The contacts, in order.
    pub impacts: Vec<ReplayedImpact>,
    /// Steps in which the replay used the plan's ζ(t), because the vehicle was within
    /// [`tolerance::CONTACT_TIE`] of the wall.
    pub ties: usize,
    /// The first step in which the law has no successor, because the flight ends behind the wall
    /// while moving away. The replay stops there.
    pub blocked: Option<usize>,
    /// The first step in which the replay and the plan disagree about contact.
    pub contact_mismatch: Option<usize>,
    /// Largest distance between plan and replay over the samples, in m.
    pub max_position_error: f64,
    /// Largest difference of velocities over the samples, in m/s.
    pub max_velocity_error: f64,
}

impl DiscreteReplay {
    /// Refuses a plan that disagrees with its replay.
    ///
    /// # Arguments
    ///
    /// * `allowed`: the largest disagreement at a sample, in m and m/s; see
    ///   [`tolerance::REPLAY`].
    ///
    /// # Errors
    ///
    /// The first disagreement.
    pub fn check(&self, plan: &Samples<'_>, allowed: f64) -> Result<(), ReplayError> {
        if let Some(step) = self.blocked.or(self.contact_mismatch) {
            return Err(ReplayError::Contact { step });
        }
        let groups = [
            ("position", &self.position, plan.position),
            ("velocity", &self.velocity, plan.velocity),
        ];
        for (what, replayed, planned) in groups {
            let errors = replayed.iter().zip(planned).map(|(a, b)| (a - b).abs());
            // NaN fails as well.
            if let Some((step, residual)) =
                errors.enumerate().find(|(_, e)| e.is_nan() || *e > allowed)
            {
                return Err(ReplayError::Sample { what, step, residual, allowed });
            }
        }
        Ok(())
    }
}

/// The outcome of a step of the discrete law.
enum Outcome {
    Flight,
    Contact,
    /// No mode of the law applies.
    Blocked,
}

/// Replays a plan through its discrete law, from its first sample and its accelerations alone.
///
/// The plan's ζ(t) is used only within [`tolerance::CONTACT_TIE`] of the wall.
///
/// # Errors
///
/// As for [`Samples::check`].
pub fn replay_discrete(contact: &Contact, plan: &Samples<'_>) -> Result<DiscreteReplay, Error> {
    plan.check()?;
    let (wall, e, dt) = (contact.wall, contact.restitution.value(), plan.time_step);
    let mut replay = DiscreteReplay {
        position: vec![plan.position[0]],
        velocity: vec![plan.velocity[0]],
        impacts: Vec::new(),
        ties: 0,
        blocked: None,
        contact_mismatch: None,
        max_position_error: 0.0,
        max_velocity_error: 0.0,
    };
    let (mut x, mut v) = (plan.position[0], plan.velocity[0]);
    for (t, (&a, &planned)) in plan.acceleration.iter().zip(plan.contact).enumerate() {
        let p = x + dt * v + 0.5 * dt * dt * a;
        let w = v + dt * a;
        let outcome = match contact.law {
            ContactLaw::Reflecting => {
                // This law depends on where the step would end.
                decide(wall.gap(p), planned, wall.rate(w), &mut replay.ties)
            }
            // This law depends on where the step begins, at any velocity.
            ContactLaw::Literal => decide(wall.gap(x), planned, -1.0, &mut replay.ties),
        };
        let before = match contact.law {
            ContactLaw::Reflecting => -wall.rate(w),
            ContactLaw::Literal => -wall.rate(v),
        };
        let touched = match outcome {
            Outcome::Flight => {
                (x, v) = (p, w);
                false
            }
            Outcome::Contact => {
                replay.impacts.push(impact(t, before, e));
                (x, v) = match contact.law {
                    ContactLaw::Reflecting => (wall.at_gap(-e * wall.gap(p)), -e * w),
                    // The acceleration that changes v to -e v within the step.
                    ContactLaw::Literal => (x + 0.5 * dt * (1.0 - e) * v, -e * v),
                };
                true
            }
            Outcome::Blocked => {
                replay.blocked = Some(t);
                break;
            }
        };
        if touched != planned {
            replay.contact_mismatch.get_or_insert(t);
        }
        replay.position.push(x);
        replay.velocity.push(v);
        let worst = |so_far: f64, error: f64| if error <= so_far { so_far } else { error };
        let error = (x - plan.position[t + 1]).abs();
        replay.max_position_error = worst(replay.max_position_error, error);
        let error = (v - plan.velocity[t + 1]).abs();
        replay.max_velocity_error = worst(replay.max_velocity_error, error);
    }
    Ok(replay)
}

/// Flight, contact or neither, from the deciding gap (m) and the rate (m/s) at that moment.
fn decide(gap: f64, planned: bool, rate: f64, ties: &mut usize) -> Outcome {
    let inward = rate <= tolerance::CONTACT_TIE;
    if gap.abs() <= tolerance::CONTACT_TIE {
        *ties += 1;
        return if planned && inward { Outcome::Contact } else { Outcome::Flight };
    }
    match (gap > 0.0, inward) {
        (true, _) => Outcome::Flight,
        (false, true) => Outcome::Contact,
        (false, false) => Outcome::Blocked,
    }
}

fn impact(step: usize, speed_before: f64, e: f64) -> ReplayedImpact {
    let speed_after = e * speed_before;
    ReplayedImpact {
        step,
        speed_before,
        speed_after,
        impulse: speed_before + speed_after,
        energy_before: 0.5 * speed_before * speed_before,
        energy_after: 0.5 * speed_after * speed_after,
    }
}
