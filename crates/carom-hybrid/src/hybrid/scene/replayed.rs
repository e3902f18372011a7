//! The replay of a scene in its own units, with what it finds in the user's.

use super::plan::{BodyPath, SceneHit};
use super::replay::{self, SceneCertificate};
use super::statement::Scene;
use super::units::SceneUnits;
use crate::error::SceneError;

impl SceneUnits {
    /// A path in these units.
    pub(super) fn path(&self, stated: &BodyPath) -> BodyPath {
        let mut path = stated.clone();
        for place in &mut path.position {
            for (axis, x) in place.iter_mut().enumerate() {
                *x = self.place(axis).inward(*x);
            }
        }
        let over = |values: &mut dyn Iterator<Item = &mut f64>, unit: f64| {
            values.for_each(|value| *value /= unit);
        };
        over(&mut path.velocity.iter_mut().flatten(), self.speed());
        over(&mut path.acceleration.iter_mut().flatten(), self.acceleration());
        over(&mut path.spin.iter_mut(), 1.0 / self.time);
        over(&mut path.torque.iter_mut(), self.torque());
        path
    }

    /// A hit that was found in these units, in the user's.
    fn stated_hit(&self, own: &mut SceneHit) {
        let speed = self.speed();
        for value in [&mut own.start_speed, &mut own.end_speed, &mut own.damage, &mut own.speed] {
            *value *= speed;
        }
        own.time *= self.time;
        for (axis, x) in own.place.iter_mut().enumerate() {
            *x = self.place(axis).outward(*x);
        }
        own.impulse.iter_mut().for_each(|impulse| *impulse *= speed);
        own.energy *= speed * speed;
    }

    /// The units of places, speeds, spins and headings.
    fn kinds(&self) -> [f64; 4] {
        [self.length, self.speed(), 1.0 / self.time, 1.0]
    }

    /// Replays paths in these units through a scene in these units. The hits and the certificate
    /// are then in the user's.
    pub(super) fn replayed(
        &self,
        scene: &Scene,
        paths: &[BodyPath],
        hits: &mut Vec<SceneHit>,
    ) -> Result<SceneCertificate, SceneError> {
        if self.is_plain() {
            return replay::certify(scene, paths, hits, [1.0; 4]);
        }
        let replayed = replay::certify(scene, paths, hits, self.kinds());
        hits.iter_mut().for_each(|hit| self.stated_hit(hit));
        match replayed {
            Ok(own) => Ok(self.stated_certificate(own)),
            Err(refusal) => Err(self.stated_refusal(refusal)),
        }
    }

    /// A certificate that was found in these units, in the user's; see
    /// [`kinds`](SceneUnits::kinds).
    fn stated_certificate(&self, own: SceneCertificate) -> SceneCertificate {
        let (length, speed) = (self.length, self.speed());
        let energy = speed * speed;
        SceneCertificate {
            time_step: own.time_step * self.time,
            largest_residual: own.largest_residual,
            drift: own.drift,
            penetration: own.penetration * length,
            dip: own.dip * length,
            unreported: own.unreported * speed,
            missed: own.missed,
            momentum_error: own.momentum_error * speed,
            angular_momentum_error: own.angular_momentum_error * length * speed,
            energy_gain: own.energy_gain * energy,
            stepped_gain: own.stepped_gain * energy,
            cone_excess: own.cone_excess * speed,
            step_error: own.step_error * length,
            step_speed_error: own.step_speed_error * speed,
            continuous_drift: own.continuous_drift * length,
        }
    }

    /// The refusal of a replay in these units, in the user's.
    pub(super) fn stated_refusal(&self, own: SceneError) -> SceneError {
        let SceneError::Replay { step, what, by, allowed } = own else { return own };
        let unit = match &what[..] {
            text if text.ends_with("(m)") => self.length,
            text if text.ends_with("(m/s)") => self.speed(),
            // Of several kinds: at most this.
            text if text.ends_with("rad/s)") => self.kinds().into_iter().fold(0.0, f64::max),
            _ => 1.0,
        };
        SceneError::Replay { step, what, by: by * unit, allowed: allowed * unit }
    }
}
