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

use super::Restitution;
use crate::error::Error;
use crate::hybrid::linear::LinearSystem;
use crate::hybrid::system::{Halfspace, Transition};
use crate::hybrid::wall::Wall;

/// The law as transitions of `[x, v]` under `[a]`, the flight and the contact.
///
/// The contact's range of the acceleration must extend to `(1+e) v_max/Δt` and the domain of the
/// position into the wall, or the law never applies.
pub(crate) fn transitions(
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
