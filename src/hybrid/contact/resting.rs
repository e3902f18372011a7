//! A contact that comes to rest: the time-stepping law of Moreau.
//!
//! With gap and rate at the start of a step, `g` and `s`, and the free-flight prediction, `p` and `w`:
//!
//! * flight: `p >= 0`, `g⁺ = p`, `s⁺ = w`;
//! * impact: `p <= 0`, `w <= 0`, `s <= 0`; `g⁺ = 0`, `s⁺ = -e s`;
//! * settling: `p <= 0`, `w <= 0`, `s >= 0`; `g⁺ = 0`, `s⁺ = 0`;
//! * rest, which is no event: the same from `g = 0`, `s = 0`.
//!
//! A step in contact ends at the wall, and rebounds with the speed at its start: nothing that the
//! acceleration adds within the step is reflected, so that bounces die out under the reflecting law's
//! height of a step.

use crate::error::Error;
use crate::hybrid::linear::LinearSystem;
use crate::hybrid::system::{Halfspace, Transition};
use crate::hybrid::wall::Wall;

/// The law as transitions of `[x, v]` under `[a]`: flight, impact, settling, rest. `output` is the
/// name of the impact speed.
pub(super) fn transitions(
    wall: Wall,
    restitution: f64,
    time_step: f64,
    max_speed: Option<f64>,
    output: &str,
) -> Result<[Transition; 4], Error> {
    let (n, dt) = (wall.normal(), time_step);
    let at = n * wall.position();
    let flow = LinearSystem::double_integrator(time_step)?;
    let outside = Halfspace::new("the flight ends outside the wall", [-n, 0.0], -at);
    let flight = Transition::new("flight", flow).with_prediction_guard(outside);
    // The prediction's position and velocity, of the state and the input.
    let (place, speed) = ([n, n * dt, 0.5 * n * dt * dt], [0.0, n, n * dt]);
    let held = |rebound: f64| {
        LinearSystem::new([[0.0, 0.0], [0.0, -rebound]], [[0.0], [0.0]], [wall.position(), 0.0])
    };
    let contact = |transition: Transition| {
        transition
            .with_guard(Halfspace::new("the flight ends behind the wall", place, at))
            .with_guard(Halfspace::new("it moves towards the wall", speed, 0.0))
    };
    let towards = |name: &str| Halfspace::new(name, [0.0, n], 0.0);
    let away = |name: &str| Halfspace::new(name, [0.0, -n], 0.0);
    let event = |name: &str, rebound: f64| -> Result<Transition, Error> {
        let mut event = contact(Transition::event(name, held(rebound)?));
        if let Some(limit) = max_speed {
            let back = speed.map(|s| -s);
            event =
                event.with_guard(Halfspace::limit("the limit on the impact speed", back, limit));
        }
        Ok(event.with_start_output(output, speed.map(|s| -s), 0.0))
    };
    let impact = event("impact", restitution)?;
    let impact = impact.with_guard(towards("it starts towards the wall"));
    let settle = event("settle", 0.0)?;
    let settle = settle.with_guard(away("it does not start towards the wall"));
    let rest = contact(Transition::new("rest", held(0.0)?))
        .with_guard(Halfspace::new("it starts at the wall", [n, 0.0], at))
        .with_guard(towards("it starts at rest"))
        .with_guard(away("it starts at rest"));
    Ok([flight, impact, settle, rest])
}
