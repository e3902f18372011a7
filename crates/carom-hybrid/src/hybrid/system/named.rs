//! Systems with a name, as examples and for tests.

use super::HybridSystem;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::error::{Error, FINITE_POSITIVE, check_finite};
use crate::hybrid::contact::Restitution;
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
        let mut ball = HybridSystem::new(time_step);
        let h = ball.state("height", 0.0, ceiling)?;
        let v = ball.state("speed", -top_speed, top_speed)?;
        let impact = ball.output("impact speed")?;
        ball.rates([h.is(v), v.is(-GRAVITY)])?;
        ball.mode("fall")?.guard(h.predicted().ge(0.0))?;
        ball.event("bounce")?
            .guard(h.predicted().le(0.0))?
            .guard(v.predicted().le(0.0))?
            .reset([h.is(-e * h.predicted()), v.is(-e * v.predicted())])?
            .output(impact, -v.predicted())?;
        ball.check()?;
        Ok(ball)
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
            return Err(Error::out_of_range(what, time_constant, FINITE_POSITIVE));
        }
        check_finite("the thermostat", "a temperature", [cold, hot])?;
        band.check("the band of the thermostat")?;
        let rate = 1.0 / time_constant;
        let mut room = HybridSystem::new(time_step);
        let t = room.state("temperature", cold, hot)?;
        let [off, on] = room.modes("heater", ["off", "on"])?;
        let towards = |end: f64| [(t, rate * (end - t))];
        room.stay(off)?.named("idle")?.rates(towards(cold))?.guard(t.ge(band.lower))?;
        room.stay(on)?.named("heat")?.rates(towards(hot))?.guard(t.le(band.upper))?;
        room.switch(off, on)?.named("start")?.guard(t.le(band.lower))?;
        room.switch(on, off)?.named("stop")?.guard(t.ge(band.upper))?;
        room.check()?;
        Ok(room)
    }
}
