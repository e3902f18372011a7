//! Systems with a name, as examples and for tests.

use super::{Choice, Halfspace, HybridSystem, Transition};
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::error::{Error, check_finite};
use crate::hybrid::contact::Restitution;
use crate::hybrid::linear::LinearSystem;
use crate::interval::Interval;

/// Gravitational acceleration on earth, in m/s².
const GRAVITY: f64 = 9.81;

impl HybridSystem {
    /// A ball above a floor at 0 m: the states `height` (m) and `speed` (m/s, upward), no inputs,
    /// gravity 9.81 m/s², and the transitions `fall` and `bounce`. A step that would end below the
    /// floor is reflected at it, scaled by the restitution.
    ///
    /// # Arguments
    ///
    /// * `time_step`: Δt, in s, finite and positive.
    /// * `restitution`: rebound speed over impact speed (no unit).
    /// * `ceiling`: the largest height, in m; `top_speed`: the largest speed either way, in m/s.
    ///
    /// ```
    /// use carom::hybrid::{HybridSystem, Restitution};
    ///
    /// let ball = HybridSystem::bouncing_ball(0.01, Restitution::new(0.7)?, 3.0, 10.0)?;
    /// // Dropped from 2 m, for a second: the first impact is after 0.64 s.
    /// let run = ball.simulate(&[2.0, 0.0], &[[]; 100])?;
    /// assert_eq!((run.events(), run.steps[63].taken[0].as_str()), (1, "bounce"));
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`] for a time step that is not finite and positive, the errors of
    /// [`HybridSystem::check`] for a ceiling or a top speed that is not.
    pub fn bouncing_ball(
        time_step: f64,
        restitution: Restitution,
        ceiling: f64,
        top_speed: f64,
    ) -> Result<Self, Error> {
        let e = restitution.value();
        let rates = [[0.0, 1.0], [0.0, 0.0]];
        let fall = LinearSystem::zero_order_hold(rates, [[]; 2], [0.0, -GRAVITY], time_step)?;
        let above = Halfspace::new("it ends above the floor", [-1.0, 0.0], 0.0);
        let below = Halfspace::new("it ends below the floor", [1.0, 0.0], 0.0);
        let down = Halfspace::new("it moves down", [0.0, 1.0], 0.0);
        let bounce = Transition::event("bounce", fall.clone())
            .with_prediction_guard(below)
            .with_prediction_guard(down)
            .with_reset([[-e, 0.0], [0.0, -e]], [0.0, 0.0])
            .with_output("impact speed", [0.0, -1.0], 0.0);
        let system = HybridSystem::new()
            .with_state("height", Interval::new(0.0, ceiling))
            .with_state("speed", Interval::new(-top_speed, top_speed))
            .with_transition(Transition::new("fall", fall).with_prediction_guard(above))
            .with_transition(bounce);
        system.check()?;
        Ok(system)
    }

    /// A room with a heater that a thermostat switches: the state `temperature` (°C), no inputs,
    /// and the choice `heater` with the modes `off` and `on`. The heater starts in the steps that
    /// begin at or below the band, stops in those that begin at or above it, and otherwise stays as
    /// it is.
    ///
    /// # Arguments
    ///
    /// * `time_step`, `time_constant`: Δt and the time in which a difference of temperatures falls
    ///   to 37 %, in s, finite and positive.
    /// * `cold`, `hot`: the temperatures (°C) that the room approaches with the heater off and on;
    ///   `cold < hot`.
    /// * `band`: the temperatures (°C) at which the heater starts and stops.
    ///
    /// ```
    /// use carom::hybrid::{HybridSystem, SimulationOptions};
    /// use carom::interval::Interval;
    ///
    /// let room = HybridSystem::thermostat(60.0, 1800.0, 5.0, 40.0, Interval::new(19.0, 21.0))?;
    /// let off = SimulationOptions::default().with_mode("heater", "off");
    /// let day = room.simulate_with(&[20.0], &[[]; 1440], &off)?;
    /// let temperature = day.state("temperature").unwrap();
    /// assert!(day.is_complete() && temperature.iter().all(|t| (18.0..22.0).contains(t)));
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`] for times that are not finite and positive,
    /// [`ErrorKind::NotFinite`] and [`ErrorKind::CrossedBounds`] for temperatures.
    pub fn thermostat(
        time_step: f64,
        time_constant: f64,
        cold: f64,
        hot: f64,
        band: Interval,
    ) -> Result<Self, Error> {
        if !(time_constant.is_finite() && time_constant > 0.0) {
            let what = "the time constant (s)";
            return Err(Error::out_of_range(what, time_constant, "finite and positive"));
        }
        check_finite("the thermostat", "a temperature", [cold, hot])?;
        band.check("the band of the thermostat")?;
        let rate = 1.0 / time_constant;
        let towards =
            |end: f64| LinearSystem::zero_order_hold([[-rate]], [[]; 1], [rate * end], time_step);
        let at_most = |limit: f64| Halfspace::new("at most", [1.0], limit);
        let at_least = |limit: f64| Halfspace::new("at least", [-1.0], -limit);
        let idle = Transition::new("idle", towards(cold)?).within("off");
        let start = Transition::event("start", towards(hot)?).between("off", "on");
        let heat = Transition::new("heat", towards(hot)?).within("on");
        let stop = Transition::event("stop", towards(cold)?).between("on", "off");
        let heater = Choice::new("heater")
            .with_transition(idle.with_guard(at_least(band.lower)))
            .with_transition(start.with_guard(at_most(band.lower)))
            .with_transition(heat.with_guard(at_most(band.upper)))
            .with_transition(stop.with_guard(at_least(band.upper)));
        let system = HybridSystem::new()
            .with_state("temperature", Interval::new(cold, hot))
            .with_choice(heater);
        system.check()?;
        Ok(system)
    }
}
