//! The paper's own contact law, equations (8)-(13), with its errata corrected.
//!
//! In gap g (m) and rate s (m/s):
//!
//! * (8) ζ(t) = 0 implies `g(t) >= 0`;
//! * (9) ζ(t) = 1 implies `g(t) <= 0`. As printed, `-x(t) - M(1-ζ(t)) >= x_w`, the row is
//!   infeasible whenever ζ(t) = 0, and its right side has the wrong sign if `x_w != 0`. It should
//!   be `x(t) <= x_w + M(1-ζ(t))` (erratum 1);
//! * (10), (11) ζ(t) = 0 implies `a_min <= a(t) <= a_max`;
//! * (12), (13) ζ(t) = 1 implies `a(t) = F_col = -(1+e) v(t)/Δt`;
//! * (3), (4) the double integrator's dynamics, always.
//!
//! The strict inequalities of the paper's other rows are closed here, without an ε, because a
//! solver cannot tell them apart (erratum 2).

use super::{ContactStep, ImpactSpeed, Restitution};
use crate::error::Error;
use crate::hybrid::linear::LinearSystem;
use crate::hybrid::system::{Halfspace, Transition};
use crate::hybrid::wall::Wall;
use crate::model::Model;

/// Adds the statements of one step: `free_gap[t]` (8), `contact_gap[t]` (9),
/// `free_acceleration[t]` (10)-(11), `contact_acceleration[t]` (12)-(13), and the rows
/// `dynamics_x[t]`, `dynamics_v[t]` (3)-(4).
///
/// The bounds of the acceleration must extend to `(1+e) v_max/Δt` and those of the position into
/// the wall, or the law never applies.
pub(super) fn add_step(
    model: &mut Model,
    wall: Wall,
    restitution: Restitution,
    step: &ContactStep,
) -> Result<ImpactSpeed, Error> {
    let t = step.step;
    let hit = step.contact;
    let gap = wall.gap_of(&step.position);
    let limits = step.acceleration_limits;
    let rebound = -(1.0 + restitution.value()) / step.time_step * &step.velocity;

    model.add(("free_gap", t), hit.off().implies(gap.ge(0.0)))?;
    model.add(("contact_gap", t), hit.on().implies(gap.le(0.0)))?;
    let limited = step.acceleration.within(limits.lower, limits.upper);
    model.add(("free_acceleration", t), hit.off().implies(limited))?;
    let forced = step.acceleration.equals(rebound);
    model.add(("contact_acceleration", t), hit.on().implies(forced))?;
    model.add(("dynamics_x", t), step.next_position.equals(&step.predicted_position))?;
    model.add(("dynamics_v", t), step.next_velocity.equals(&step.predicted_velocity))?;

    // The wall acts in contact; in flight the vehicle's own limits apply.
    let law = ["free_gap", "contact_gap", "contact_acceleration", "dynamics_x", "dynamics_v"];
    law.iter().try_for_each(|family| model.set_background(family))?;

    Ok(ImpactSpeed { speed: -wall.rate_of(&step.velocity), zero_in_flight: false })
}

/// The law as transitions of `[x, v]` under `[a]`, the flight and the contact.
pub(super) fn transitions(
    wall: Wall,
    restitution: Restitution,
    time_step: f64,
    max_speed: Option<f64>,
) -> Result<[Transition; 2], Error> {
    let (n, at, e) = (wall.normal(), wall.normal() * wall.position(), restitution.value());
    let outside = Halfspace::new("the step begins outside the wall", [-n, 0.0], -at);
    let flow = LinearSystem::double_integrator(time_step)?;
    let flight = Transition::new("flight", flow.clone()).with_guard(outside);
    let inside = Halfspace::new("the step begins inside the wall", [n, 0.0], at);
    // Δt a = -(1+e) v, without a division by Δt.
    let name = "the wall's acceleration";
    let forced = Halfspace::equality(name, [0.0, 1.0 + e, time_step], 0.0);
    let mut contact = Transition::event("contact", flow).with_guard(inside).with_guards(forced);
    if let Some(limit) = max_speed {
        let limit = Halfspace::limit("the limit on the impact speed", [0.0, -n], limit);
        contact = contact.with_guard(limit);
    }
    Ok([flight, contact])
}
