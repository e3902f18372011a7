//! Spin of discs in the plane: a rate and an inertia more, which hits with friction change.
//!
//! States and inputs of spins come after those of all bodies, so that scenes without spin have
//! none.

use std::ops::{Bound, RangeBounds};

use super::body::{Body, Shape, Spin};
use super::contact::ContactSpin;
use super::handles::BodyHandle;
use super::statement::Scene;
use crate::error::{Error, FINITE_POSITIVE, SceneError};
use crate::hybrid::system::State;
use crate::model::Variable;

impl Body {
    /// Lets a disc in the plane spin: `dω/dt = torque / inertia`, with the torque held over each
    /// step. Hits with friction or a [linear map](super::Surface::with_linear_map) change the spin,
    /// and the spin changes them; without friction it stays as it is. Counter-clockwise is
    /// positive. A start has the spin (rad/s) after the velocities, and a goal may.
    ///
    /// ```
    /// use carom::hybrid::Restitution;
    /// use carom::hybrid::scene::{Body, Scene, Shape, Solid, Surface};
    /// use carom::prelude::*;
    ///
    /// // A solid disc of 1 kg that spins at 20 rad/s, dropped onto a floor where it sticks.
    /// let disc = Body::new("disc", [-1.0..=1.0, 0.0..=1.0], 5.0, 0.0)
    ///     .with_shape(Shape::Ball(0.1))
    ///     .with_spin(0.005, 20.0, 0.0)
    ///     .with_start([0.0, 0.2, 0.0, -1.5, 20.0]);
    /// let floor = Surface::bounce(Restitution::new(0.5)?).with_linear_map(0.0, 0.0);
    /// let scene = Scene::new(0.1)
    ///     .with_body(disc)
    ///     .with_obstacle(Solid::halfspace("floor", [0.0, 1.0], 0.0, floor));
    /// let plan = scene.program(2)?.solve(&mut BranchAndBound::default())?;
    /// // It leaves to the left and rolls: a third of the speed of its surface before, 2 m/s.
    /// let (v, spin) = (&plan.bodies[0].velocity[2], plan.bodies[0].spin[2]);
    /// assert!((v[0] + 2.0 / 3.0).abs() < 1e-6 && (v[0] + 0.1 * spin).abs() < 1e-6);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Arguments
    ///
    /// * `inertia`: around the centre, in kg m²; `m r²/2` for a solid disc, `2/5 m r²` for a solid
    ///   ball that moves in the plane.
    /// * `max_rate`: at a sample, either way, in rad/s; `max_torque`: either way, in N m.
    #[must_use]
    pub fn with_spin(mut self, inertia: f64, max_rate: f64, max_torque: f64) -> Self {
        self.spin = Some(Spin { inertia, max_rate, max_torque });
        self
    }

    /// Refuses spins that nothing can have.
    pub(super) fn check_spin(&self) -> Result<(), Error> {
        let Some(spin) = &self.spin else { return Ok(()) };
        let refused = |reason| Err(SceneError::Spin { body: self.name.clone(), reason }.into());
        match (self.axes(), &self.shape) {
            (2, Shape::Ball(_)) => {}
            (2, _) => return refused("only discs turn; give it the shape of a ball"),
            (1, _) => return refused("nothing turns on a line; state the scene in the plane"),
            _ => {
                return refused(
                    "in space a spin has three entries, which hits turn into each other; state the scene in \
                     the plane, or leave the spin out",
                );
            }
        }
        let not_negative = (Bound::Included(0.0), Bound::Excluded(f64::INFINITY));
        for (what, value, range) in [
            ("inertia (kg m²)", spin.inertia, FINITE_POSITIVE),
            ("largest spin (rad/s)", spin.max_rate, FINITE_POSITIVE),
            ("largest torque (N m)", spin.max_torque, not_negative),
        ] {
            if !range.contains(&value) {
                let what = format!("the {what} of `{}`", self.name);
                return Err(Error::out_of_range(what, value, range));
            }
        }
        Ok(())
    }
}

impl BodyHandle {
    /// The spin, in rad/s. Of a body without one, the handle is one that programs refuse.
    pub fn spin(self) -> State {
        State::of(self.handle(0, 5 * self.axes))
    }

    /// The torque, in N m, likewise.
    pub fn torque(self) -> Variable {
        self.handle(0, 5 * self.axes + 2)
    }
}

impl Scene {
    /// The bodies with spin by their numbers, in the order of the states and inputs of spins.
    pub(super) fn spins(&self) -> impl Iterator<Item = (usize, Spin)> {
        self.bodies.iter().enumerate().filter_map(|(b, body)| Some((b, body.spin?)))
    }

    /// The number of the state of a body's spin.
    pub(super) fn spin_state(&self, body: usize) -> Option<usize> {
        let place = self.spins().position(|(own, _)| own == body)?;
        Some(2 * self.axes() * self.bodies.len() + place)
    }

    /// The spins in a contact of some bodies.
    pub(super) fn contact_spins(&self, bodies: &[usize]) -> Vec<ContactSpin> {
        let of = |&b: &usize| {
            let (state, body) = (self.spin_state(b)?, &self.bodies[b]);
            let (lever, inertia) = (body.shape.reach(&[1.0, 0.0]), body.spin?.inertia);
            Some(ContactSpin { state, lever, inertia })
        };
        bodies.iter().filter_map(of).collect()
    }
}
