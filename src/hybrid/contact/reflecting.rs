//! The reflecting law: a step that would end behind the wall is mirrored at it.
//!
//! With the free-flight prediction in gap and rate, `p` (m) and `w` (m/s), and the next gap and
//! rate `g⁺`, `s⁺`:
//!
//! * ζ = 0 (flight): `p >= 0`, `g⁺ = p`, `s⁺ = w`;
//! * ζ = 1 (impact): `p <= 0`, `w <= 0`, `g⁺ = -e p`, `s⁺ = -e w`.
//!
//! `w <= 0` rules out an impact on the way out. The impact speed is `-w >= 0`. The gap is never
//! negative at a sample.
//!
//! Three inequalities hold in both modes: `g⁺ >= p`, `g⁺ >= -e p` and `s⁺ >= w`. They are rows,
//! not indicators, because interval arithmetic over bounds cannot see them and would give their
//! sides a big-M that they do not need. Of the equalities `g⁺ = p`, `g⁺ = -e p` and `s⁺ = w` only
//! the other sides are left to be switched.

use super::{ContactStep, ImpactSpeed, Restitution};
use crate::error::Error;
use crate::hybrid::wall::Wall;
use crate::model::Model;

/// Adds the statements of one step.
///
/// | statement | says |
/// | --- | --- |
/// | `free_gap[t]` | ζ = 0 implies p >= 0 |
/// | `impact_gap[t]` | ζ = 1 implies p <= 0 |
/// | `impact_rate[t]` | ζ = 1 implies w <= 0 |
/// | `hull_position[t]` | g⁺ >= p |
/// | `free_position[t]` | ζ = 0 implies g⁺ <= p |
/// | `hull_rebound[t]` | g⁺ >= -e p |
/// | `impact_position[t]` | ζ = 1 implies g⁺ <= -e p |
/// | `hull_velocity[t]` | s⁺ >= w |
/// | `free_velocity[t]` | ζ = 0 implies s⁺ <= w |
/// | `impact_velocity[t]` | ζ = 1 implies s⁺ = -e w |
pub(super) fn add_step(
    model: &mut Model,
    wall: Wall,
    restitution: Restitution,
    step: &ContactStep,
) -> Result<ImpactSpeed, Error> {
    let t = step.step;
    let (hit, e) = (step.contact, restitution.value());
    let gap = wall.gap_of(&step.predicted_position);
    let rate = wall.rate_of(&step.predicted_velocity);
    let next_gap = wall.gap_of(&step.next_position);
    let next_rate = wall.rate_of(&step.next_velocity);

    model.add(("free_gap", t), hit.off().implies(gap.ge(0.0)))?;
    model.add(("impact_gap", t), hit.on().implies(gap.le(0.0)))?;
    model.add(("impact_rate", t), hit.on().implies(rate.le(0.0)))?;

    model.add(("hull_position", t), next_gap.ge(&gap))?;
    model.add(("free_position", t), hit.off().implies(next_gap.le(&gap)))?;
    model.add(("hull_rebound", t), next_gap.ge(-e * &gap))?;
    model.add(("impact_position", t), hit.on().implies(next_gap.le(-e * &gap)))?;

    model.add(("hull_velocity", t), next_rate.ge(&rate))?;
    model.add(("free_velocity", t), hit.off().implies(next_rate.le(&rate)))?;
    model.add(("impact_velocity", t), hit.on().implies(next_rate.equals(-e * &rate)))?;

    Ok(ImpactSpeed { speed: -rate, never_negative: true })
}
