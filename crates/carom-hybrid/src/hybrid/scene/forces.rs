//! Accelerations that are functions of the motion: drag, wind, thrust that turns with the body.
//!
//! Each is held over a step, as inputs are, so that a step of free flight stays a parabola and all
//! that is known of contacts holds. Forces are those of the start of a step; a thrust has the
//! heading of the step's middle, and is of second order.

use super::body::Body;
use crate::error::{Error, ErrorKind, SceneError};
use crate::hybrid::system::{Handles, Meaning, Measure, State};
use crate::interval::Interval;
use crate::model::{Nonlinear, Variable};

/// The forces on a body, by its mass, as functions of its positions and velocities in the user's
/// units.
#[derive(Debug, Clone, Default)]
pub(super) struct Forces {
    /// The positions and then the velocities along the axes.
    pub(super) handles: Handles,
    /// In m/s², by axis.
    pub(super) rows: Vec<Nonlinear>,
    /// How the scene of the body measures places, by axis, and velocities; empty for the user's
    /// units.
    places: Vec<Measure>,
    speed: Option<f64>,
}

impl PartialEq for Forces {
    fn eq(&self, other: &Self) -> bool {
        let text = |own: &Forces| -> Vec<String> {
            let name = |variable: Variable| format!("#{:?}", own.handles.meaning(variable));
            own.rows.iter().map(|row| row.text(&name)).collect()
        };
        text(self) == text(other) && self.places == other.places && self.speed == other.speed
    }
}

impl Forces {
    /// For a scene in other units, with these measures of places and this unit of velocities.
    pub(super) fn restate(&mut self, places: Vec<Measure>, speed: f64) {
        let before = |axis: usize| self.places.get(axis).copied().unwrap_or(Measure::PLAIN);
        let own = places.iter().enumerate().map(|(axis, place)| {
            let scale = before(axis).scale * place.scale;
            Measure { origin: before(axis).outward(place.origin), scale }
        });
        (self.places, self.speed) = (own.collect(), Some(speed * self.speed.unwrap_or(1.0)));
    }

    /// Their values at a place and a velocity, all in the scene's units.
    fn values(&self, x: &[f64], v: &[f64]) -> Vec<f64> {
        let place = |axis: usize| self.places.get(axis).copied().unwrap_or(Measure::PLAIN);
        let speed = self.speed.unwrap_or(1.0);
        let value = |variable: Variable| match self.handles.meaning(variable) {
            Some(Meaning::State(k)) if *k < x.len() => place(*k).outward(x[*k]),
            Some(Meaning::State(k)) => v.get(k - x.len()).map_or(f64::NAN, |v| v * speed),
            _ => f64::NAN,
        };
        let acceleration = speed * speed / place(0).scale;
        self.rows.iter().map(|row| row.evaluate(value) / acceleration).collect()
    }
}

impl Body {
    /// Adds forces by the mass of the body, in m/s², one for each axis: functions of its positions
    /// (m) and its velocities (m/s) along the axes, such as a wind that depends on the place. Those
    /// of the start of a step act until it ends.
    ///
    /// ```
    /// use carom::hybrid::scene::{Body, Scene};
    /// use carom::model::Nonlinear;
    /// use carom::prelude::*;
    ///
    /// // A drone in a jet of wind around y = 1 m, which drags it along x.
    /// let drone = Body::new("drone", [0.0..=4.0, 0.0..=2.0], 3.0, 2.0)
    ///     .with_forces(|x, _| [(-4.0 * (x[1] - 1.0).square()).exp(), Nonlinear::from(0.0)])
    ///     .with_start([0.5, 1.0, 0.0, 0.0])
    ///     .with_goal([3.5..=4.0, 0.0..=2.0, -3.0..=3.0, -3.0..=3.0]);
    /// let found = Scene::new(0.2).with_body(drone).shortest(&mut BranchAndBound::default())?;
    /// // 9 steps without the wind.
    /// assert_eq!(found.steps, Some(8));
    /// # Ok::<(), carom::Error>(())
    /// ```
    #[must_use]
    pub fn with_forces<R: IntoIterator<Item: Into<Nonlinear>>>(
        mut self,
        forces: impl FnOnce(&[State], &[State]) -> R,
    ) -> Self {
        let axes = self.axes();
        let own = self.forces.get_or_insert_default();
        let states: Vec<State> = (0..2 * axes).map(|k| own.handles.state(k)).collect();
        let (x, v) = states.split_at(axes);
        for (axis, force) in forces(x, v).into_iter().enumerate() {
            let force = force.into();
            match own.rows.get_mut(axis) {
                Some(row) => *row = &*row + force,
                None => own.rows.push(force),
            }
        }
        self
    }

    /// Adds the drag `-c |v| v` of air or water, as a [force](Body::with_forces).
    ///
    /// # Arguments
    ///
    /// * `factor`: c, in 1/m: `ρ C A / (2 m)` for a density ρ, a drag coefficient C and a cross
    ///   section A.
    #[must_use]
    pub fn with_drag(self, factor: f64) -> Self {
        self.with_forces(|_, v| {
            let along = |own: &State| -factor * Nonlinear::from(*own) * speed(v);
            v.iter().map(along).collect::<Vec<Nonlinear>>()
        })
    }

    /// Gives a disc that [spins](Body::with_spin) a heading, in rad counter-clockwise from the
    /// x-axis, which its thrust turns with: the input along x acts forward and that along y to the
    /// left, with the heading of the middle of a step. A start has the heading after the spin, and
    /// a goal may.
    ///
    /// ```
    /// use carom::hybrid::scene::{Body, Scene, Shape};
    /// use carom::prelude::*;
    ///
    /// // It can only push forward, so that it has to turn around to stop.
    /// let craft = Body::new("craft", [0.0..=3.0, -1.0..=1.0], 2.0, 2.0)
    ///     .with_acceleration([0.0..=2.0, 0.0..=0.0])
    ///     .with_shape(Shape::Ball(0.1))
    ///     .with_spin(0.01, 4.0, 0.1)
    ///     .with_heading(-4.0..=4.0)
    ///     .with_start([0.5, 0.0, 0.0, 0.0, 0.0, 0.0])
    ///     .with_goal([2.0..=2.5, -0.2..=0.2, -0.1..=0.1, -0.1..=0.1, -4.0..=4.0]);
    /// let found = Scene::new(0.25).with_body(craft).shortest(&mut BranchAndBound::default())?;
    /// let plan = found.plan.expect("there is one");
    /// let last = plan.bodies[0].heading[plan.steps()];
    /// assert!(last.abs() > 1.5);
    /// # Ok::<(), carom::Error>(())
    /// ```
    #[must_use]
    pub fn with_heading(mut self, range: impl Into<Interval>) -> Self {
        self.heading = Some(range.into());
        self
    }

    /// Whether something but linear dynamics moves it.
    pub(super) fn is_nonlinear(&self) -> bool {
        self.forces.is_some() || self.heading.is_some()
    }

    /// Refuses forces and headings that nothing can have.
    pub(super) fn check_forces(&self) -> Result<(), Error> {
        let refused = |reason| Err(SceneError::Forces { body: self.name.clone(), reason }.into());
        if let Some(forces) = &self.forces {
            let (name, found) = (format!("the forces on {}", self.name), forces.rows.len());
            if found != self.axes() {
                return Err(SceneError::Axes { name, found, expected: self.axes() }.into());
            }
            for row in &forces.rows {
                row.visit(&mut |own| {
                    let foreign =
                        |(own, _): &(Variable, f64)| forces.handles.meaning(*own).is_none();
                    let Some((variable, _)) = own.terms().into_iter().find(foreign) else {
                        return Ok(());
                    };
                    let (kind, index) = ("state", variable.index());
                    let (place, name) = (name.clone(), None);
                    Err(ErrorKind::ForeignHandle { kind, index, place, name }.into())
                })?;
            }
        }
        if self.is_nonlinear() && self.dynamics.is_some() {
            return refused(
                "forces and headings stand beside a free flight without springs; state these as forces, too",
            );
        }
        match self.heading {
            Some(_) if self.spin.is_none() => {
                refused("a heading is turned by a spin; state one, by `with_spin`")
            }
            Some(range) => range.check(&self.name),
            None => Ok(()),
        }
    }

    /// The accelerations that are held over a step from a state, along the axes of the world: the
    /// inputs and forces, in the scene's units.
    ///
    /// # Arguments
    ///
    /// * `turned`: the heading in the middle of the step, in rad.
    pub(super) fn held(&self, x: &[f64], v: &[f64], turned: f64, u: &[f64]) -> Vec<f64> {
        let mut held = u.to_vec();
        if let (true, [forward, left]) = (self.heading.is_some(), u) {
            let (sin, cos) = turned.sin_cos();
            held = vec![cos * forward - sin * left, sin * forward + cos * left];
        }
        let forces = self.forces.iter().flat_map(|forces| forces.values(x, v));
        held.iter_mut().zip(forces).for_each(|(own, force)| *own += force);
        held
    }
}

/// The length of a velocity.
fn speed(v: &[State]) -> Nonlinear {
    match v {
        [v] => v.abs(),
        [x, y] => x.hypot(*y),
        all => {
            let squares = all.iter().map(|v| Nonlinear::from(v.square()));
            squares.fold(Nonlinear::from(0.0), |sum, square| sum + square).sqrt()
        }
    }
}
