//! The reflecting law: a step that would end behind the wall is reflected at it.
//!
//! With the free-flight prediction in gap and rate, `p` (m) and `w` (m/s), and the next gap and
//! rate `g⁺`, `s⁺`:
//!
//! * ζ = 0 (flight): `p >= 0`, `g⁺ = p`, `s⁺ = w`;
//! * ζ = 1 (impact): `p <= 0`, `w <= 0`, `g⁺ = -e p`, `s⁺ = -e w`.
//!
//! `w <= 0` excludes impacts while moving away. The gap is never negative at a sample.
//!
//! # Formulation
//!
//! Flight and impact share the flow and differ by what the wall adds to it: in gap and rate,
//! `-(1+e) p` and `-(1+e) w` in an impact, and nothing in flight. The rows of a program switch only
//! these two (see [`HybridSystem::write`](crate::hybrid::HybridSystem::write)). The first one is
//! bounded by about the distance travelled in one step, so that in the relaxation a small fraction
//! of an impact cannot carry the vehicle through the wall.

use faer::Mat;

use super::Restitution;
use crate::hybrid::linear::LinearSystem;
use crate::hybrid::system::{Halfspace, Transition};
use crate::hybrid::wall::Wall;

/// The law as transitions of `[x, v]` under `[a]`, the flight and the impact.
pub(super) fn transitions(
    wall: Wall,
    restitution: Restitution,
    flow: &LinearSystem,
    max_speed: Option<f64>,
) -> [Transition; 2] {
    let (n, at, e) = (wall.normal(), wall.normal() * wall.position(), restitution.value());
    let outside = Halfspace::new("the flight ends outside the wall", [-n, 0.0], -at);
    let flight = Transition::new("flight", flow.clone()).with_prediction_guard(outside);
    let mut impact = Transition::event("impact", flow.clone())
        .with_prediction_guard(Halfspace::new("the flight ends behind the wall", [n, 0.0], at))
        .with_prediction_guard(Halfspace::new("it moves towards the wall", [0.0, n], 0.0));
    if let Some(limit) = max_speed {
        let limit = Halfspace::limit("the limit on the impact speed", [0.0, -n], limit);
        impact = impact.with_prediction_guard(limit);
    }
    let rebound = Mat::from_fn(2, 2, |i, j| if i == j { -e } else { 0.0 });
    let impact = impact.with_reset(rebound, [(1.0 + e) * wall.position(), 0.0]).with_output(
        super::IMPACT_SPEED,
        [0.0, -n],
        0.0,
    );
    [flight, impact]
}
