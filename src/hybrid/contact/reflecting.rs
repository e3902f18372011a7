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
//! If these four equalities were switched directly, each big-M would be as large as the range of a
//! position or velocity. Instead, two variables describe what the wall does in a step: the
//! penetration `h >= 0` (m) by which free flight would end behind the wall, and the impact speed
//! `f >= 0` (m/s). Then `g⁺ = p + (1+e) h` and `s⁺ = w + (1+e) f` hold in both modes, and only `h`
//! and `f` are switched: ζ = 0 makes them 0, ζ = 1 makes them `-p` and `-w`. Their bounds come from
//! the ranges of `p` and `w`, so `h` is at most about the distance travelled in one step. In the
//! relaxation, a small fraction of an impact cannot carry the vehicle through the wall.

use faer::Mat;

use super::{ContactStep, ImpactSpeed, Restitution};
use crate::error::Error;
use crate::hybrid::linear::LinearSystem;
use crate::hybrid::system::{Halfspace, Transition};
use crate::hybrid::wall::Wall;
use crate::model::{Affine, Model, Variable};

/// Adds the variables `penetration[t]` and `impact_speed[t]` and the statements of one step.
///
/// | statement | meaning | in flight | in contact |
/// | --- | --- | --- | --- |
/// | `position[t]` | g⁺ = p + (1+e) h | g⁺ = p | g⁺ = -e p |
/// | `velocity[t]` | s⁺ = w + (1+e) f | s⁺ = w | s⁺ = -e w |
/// | `outside[t]` | h >= -p | p >= 0 | |
/// | `free_position[t]` | ζ = 0 implies h <= 0 | h = 0 | |
/// | `free_velocity[t]` | ζ = 0 implies f <= 0 | f = 0 | |
/// | `impact_position[t]` | ζ = 1 implies h <= -p | | h = -p, p <= 0 |
/// | `impact_velocity[t]` | ζ = 1 implies f = -w | | f = -w, w <= 0 |
pub(super) fn add_step(
    model: &mut Model,
    wall: Wall,
    restitution: Restitution,
    step: &ContactStep,
) -> Result<ImpactSpeed, Error> {
    let t = step.step;
    let hit = step.contact;
    let e = restitution.value();
    let reversal = 1.0 + e;
    let gap = wall.gap_of(&step.predicted_position);
    let rate = wall.rate_of(&step.predicted_velocity);
    let next_gap = wall.gap_of(&step.next_position);
    let next_rate = wall.rate_of(&step.next_velocity);

    let penetration = add_shortfall(model, "penetration", t, &gap)?;
    let speed = add_shortfall(model, "impact_speed", t, &rate)?;
    model.add(("position", t), next_gap.equals(&gap + reversal * penetration))?;
    model.add(("velocity", t), next_rate.equals(&rate + reversal * speed))?;
    model.add(("outside", t), (penetration + &gap).ge(0.0))?;
    model.add(("free_position", t), hit.off().implies(penetration.le(0.0)))?;
    model.add(("free_velocity", t), hit.off().implies(speed.le(0.0)))?;
    model.add(("impact_position", t), hit.on().implies(next_gap.le(-e * &gap)))?;
    model.add(("impact_velocity", t), hit.on().implies(next_rate.equals(-e * &rate)))?;
    let law = ["position", "velocity", "outside", "free_position", "free_velocity"];
    let law = law.iter().chain(&["impact_position", "impact_velocity"]);
    law.into_iter().try_for_each(|family| model.set_background(family))?;

    Ok(ImpactSpeed { speed: speed.into(), zero_in_flight: true })
}

/// A variable for how far an expression is below 0, bounded by the expression's range.
fn add_shortfall(
    model: &mut Model,
    family: &str,
    step: usize,
    expression: &Affine,
) -> Result<Variable, Error> {
    let largest = (-model.range(expression)?.lower).max(0.0);
    model.continuous((family, step), 0.0, largest)
}

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
