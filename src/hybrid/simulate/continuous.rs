//! The continuous replay: accelerations held over each step, impacts located inside it.
//!
//! The discrete law reflects a whole step at once, but real contact happens inside the step. For a
//! plan under the reflecting law with accelerations of at most `a_max` (m/s²):
//!
//! * between samples in flight, the plan's parabola enters the wall by at most `a_max Δt²/8` (m);
//! * over one step from a common state, speeds differ by at most `(1+e) a_max Δt` (m/s), because
//!   the law also reflects the acceleration after the impact.
//!
//! [`penetration_bound`] and [`speed_bound`] compute these bounds, which shrink with Δt.

use super::Samples;
use crate::error::Error;
use crate::hybrid::contact::{Contact, ContactLaw};
use crate::tolerance;

/// The result of a continuous replay.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ContinuousReplay {
    /// The largest depth of the plan's path inside the wall between samples, in m. Steps with a
    /// contact under the reflecting law count as 0, because their path is mirrored.
    pub max_penetration: f64,
    /// Largest position error at the end of a single step that starts at the plan's sample, in m.
    pub max_position_error: f64,
    /// Largest velocity error at the end of such a step, in m/s.
    pub max_speed_error: f64,
    /// Position error at the end of the whole plan, open loop from its first sample, in m.
    pub final_position_error: f64,
    /// Velocity error at the end of the whole plan, open loop from its first sample, in m/s.
    pub final_speed_error: f64,
    /// Number of impacts of the open-loop run; resting counts once per step.
    pub impacts: usize,
}

/// The state of a vehicle at a wall after some time, in gap and rate.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Advance {
    /// Distance to the wall, in m.
    pub gap: f64,
    /// Speed away from the wall, in m/s.
    pub rate: f64,
    /// Impacts on the way, as time from the start (s) and speed into the wall (m/s).
    pub impacts: Vec<(f64, f64)>,
    /// Whether it came to rest on the wall.
    pub rested: bool,
}

/// Largest depth inside the wall, in m, of a parabola with acceleration `max_acceleration` (m/s²)
/// between two samples outside the wall that are `time_step` (s) apart: `a_max Δt²/8`.
pub fn penetration_bound(max_acceleration: f64, time_step: f64) -> f64 {
    max_acceleration * time_step * time_step / 8.0
}

/// Largest difference of speeds between the reflecting law and continuous contact over one step:
/// `(1+e) a_max Δt`, in m/s.
pub fn speed_bound(max_acceleration: f64, time_step: f64, restitution: f64) -> f64 {
    (1.0 + restitution) * max_acceleration * time_step
}

/// Simulates a vehicle at a wall under a constant acceleration, through any number of bounces.
///
/// Impacts are the roots of the gap's parabola. A vehicle that is pressed against the wall and
/// rebounds at less than [`tolerance::REST_SPEED`], or has bounced [`tolerance::MAX_BOUNCES`]
/// times, rests there for the remaining time.
///
/// ```
/// use carom::internals::simulate::advance;
///
/// // Dropped from 5 m at 10 m/s²: hits at 1 s with 10 m/s, rebounds with half of it.
/// let ball = advance(5.0, 0.0, -10.0, 1.5, 0.5);
/// assert_eq!(ball.impacts, [(1.0, 10.0)]);
/// assert!((ball.gap - 1.25).abs() < 1e-12 && ball.rate.abs() < 1e-12);
/// ```
///
/// # Arguments
///
/// * `gap`: m; negative values are treated as 0. `rate`: m/s. `acceleration`: away from the wall,
///   m/s².
/// * `duration`: s, not negative. `restitution`: e, within `[0, 1]`.
pub fn advance(gap: f64, rate: f64, acceleration: f64, duration: f64, restitution: f64) -> Advance {
    let mut state = Advance { gap: gap.max(0.0), rate, impacts: Vec::new(), rested: false };
    let mut elapsed = 0.0;
    loop {
        let remaining = duration - elapsed;
        let pressed = acceleration < 0.0;
        if state.gap == 0.0 && state.rate == 0.0 && pressed {
            state.rested = true;
            return state;
        }
        let hit = next_impact(state.gap, state.rate, acceleration);
        let Some((after, speed)) = hit.filter(|&(after, _)| after <= remaining) else {
            let half_change = 0.5 * acceleration * remaining;
            let end = state.gap + remaining * (state.rate + half_change);
            state.gap = end.max(0.0); // rounding only: an impact would have been found
            state.rate += acceleration * remaining;
            return state;
        };
        elapsed += after;
        state.impacts.push((elapsed, speed));
        let rebound = restitution * speed;
        let worn_out =
            rebound <= tolerance::REST_SPEED || { state.impacts.len() >= tolerance::MAX_BOUNCES };
        state.gap = 0.0;
        state.rate = if worn_out && pressed { 0.0 } else { rebound };
    }
}

/// Time to the next impact (s) and the speed into the wall at that time (m/s), if there is one.
fn next_impact(gap: f64, rate: f64, acceleration: f64) -> Option<(f64, f64)> {
    if gap == 0.0 {
        if rate < 0.0 {
            return Some((0.0, -rate));
        }
        // Away and back again, if the acceleration pulls back.
        return (acceleration < 0.0 && rate > 0.0).then(|| (-2.0 * rate / acceleration, rate));
    }
    // The first positive root of gap + rate t + acceleration t²/2, without cancellation.
    let discriminant = rate * rate - 2.0 * acceleration * gap;
    if discriminant <= 0.0 {
        return None; // it turns before the wall, or touches it at no speed
    }
    let speed = discriminant.sqrt();
    let time = if rate < 0.0 {
        2.0 * gap / (speed - rate)
    } else if acceleration < 0.0 {
        -(rate + speed) / acceleration
    } else {
        return None;
    };
    Some((time, speed))
}

/// Replays a plan in continuous time; see [`simulate`](crate::hybrid::simulate).
///
/// In the step-by-step comparison, impacts within [`tolerance::CONTACT_TIE`] of the wall happen in
/// the step in which the plan has them.
///
/// Under the literal law, the accelerations of contact steps represent the force of the wall, which
/// the replay computes itself, so the vehicle's own acceleration is 0 there.
///
/// # Errors
///
/// As for [`Samples::check`].
pub fn replay_continuous(contact: &Contact, plan: &Samples<'_>) -> Result<ContinuousReplay, Error> {
    plan.check()?;
    let (wall, e, dt) = (contact.wall, contact.restitution.value(), plan.time_step);
    let literal = contact.law == ContactLaw::Literal;
    let mut replay = ContinuousReplay::default();
    let state = |t: usize| (wall.gap(plan.position[t]), wall.rate(plan.velocity[t]));
    let (mut open_gap, mut open_rate) = state(0);
    for (t, (&a, &touched)) in plan.acceleration.iter().zip(plan.contact).enumerate() {
        let acceleration = if literal && touched { 0.0 } else { wall.rate(a) };
        let ((gap, rate), (next_gap, next_rate)) = (state(t), state(t + 1));

        // The plan decides whether an impact at the end of a step belongs to it or to the next one.
        let tie = if touched { -tolerance::CONTACT_TIE } else { tolerance::CONTACT_TIE };
        let start = (gap + tie).max(0.0);
        let mut end = advance(start, rate, acceleration, dt, e);
        end.gap -= start - gap;
        replay.max_position_error = replay.max_position_error.max((end.gap - next_gap).abs());
        replay.max_speed_error = replay.max_speed_error.max((end.rate - next_rate).abs());
        if literal || !touched {
            let depth = -lowest(gap, rate, wall.rate(a), dt);
            replay.max_penetration = replay.max_penetration.max(depth);
        }

        let open = advance(open_gap, open_rate, acceleration, dt, e);
        (open_gap, open_rate) = (open.gap, open.rate);
        replay.impacts += open.impacts.len().max(usize::from(open.rested));
    }
    let (gap, rate) = state(plan.steps());
    replay.final_position_error = (open_gap - gap).abs();
    replay.final_speed_error = (open_rate - rate).abs();
    Ok(replay)
}

/// The smallest gap along a parabola over one step, ends included, in m.
fn lowest(gap: f64, rate: f64, acceleration: f64, duration: f64) -> f64 {
    let at = |time: f64| gap + time * (rate + 0.5 * acceleration * time);
    let ends = gap.min(at(duration));
    let turn = -rate / acceleration;
    if acceleration > 0.0 && turn > 0.0 && turn < duration { ends.min(at(turn)) } else { ends }
}
