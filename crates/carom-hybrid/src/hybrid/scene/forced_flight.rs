//! Free flight with forces and headings: linear in states, inputs and the functions of a step.

use faer::Mat;

use super::axes::AXES;
use super::body::Body;
use super::handles::BodyHandle;
use super::statement::Scene;
use crate::error::Error;
use crate::hybrid::linear::LinearSystem;
use crate::hybrid::system::{Coordinates, HybridSystem, Meaning, Measure, State};
use crate::interval::Interval;
use crate::model::{Affine, Nonlinear, Variable};

impl BodyHandle {
    /// The heading, in rad. Of a body without one, the handle is one that programs refuse.
    pub fn heading(self) -> State {
        State::of(self.handle(0, 5 * self.axes + 3))
    }
}

/// Free flight with functions of the motion.
pub(super) struct ForcedFlight {
    /// In the scene's units, with an input more for each function.
    pub(super) flow: LinearSystem,
    /// The scene's states and inputs, in the user's units, with those of the functions.
    pub(super) user: HybridSystem,
}

impl Scene {
    /// The bodies with a heading by their numbers, in the order of the states.
    pub(super) fn headings(&self) -> impl Iterator<Item = (usize, Interval)> {
        self.bodies.iter().enumerate().filter_map(|(b, body)| Some((b, body.heading?)))
    }

    /// The number of the state of a body's heading.
    pub(super) fn heading_state(&self, body: usize) -> Option<usize> {
        let place = self.headings().position(|(own, _)| own == body)?;
        Some(2 * self.axes() * self.bodies.len() + self.spins().count() + place)
    }

    /// Free flight with the functions of its bodies; `None` if there are none.
    ///
    /// # Arguments
    ///
    /// * `user`: the states and inputs of the scene as the user stated it.
    /// * `coordinates`, `flow`: the scene's own.
    pub(super) fn forced_flight(
        &self,
        mut user: HybridSystem,
        coordinates: &Coordinates,
        flow: &LinearSystem,
    ) -> Result<Option<ForcedFlight>, Error> {
        if !self.bodies.iter().any(Body::is_nonlinear) {
            return Ok(None);
        }
        let (axes, states, inputs) = (self.axes(), flow.states(), flow.inputs());
        let mut held = Vec::with_capacity(axes * self.bodies.len());
        for (b, body) in self.bodies.iter().enumerate() {
            held.extend(self.held_rows(&mut user, b, body)?);
        }
        let count = user.inputs.len();
        // What is held, by state, input and the constant, in the scene's units.
        let acceleration = coordinates.input(0).scale;
        let mut rows = Mat::<f64>::zeros(held.len(), states + count + 1);
        for (k, own) in held.iter().enumerate() {
            let mut constant = own.offset();
            for (variable, factor) in own.terms() {
                let (place, measure) = match user.handles.meaning(variable) {
                    Some(Meaning::State(i)) => (*i, coordinates.state(*i)),
                    // Functions have the user's numbers.
                    Some(Meaning::Input(u)) if *u >= inputs => (states + u, Measure::PLAIN),
                    Some(Meaning::Input(u)) => (states + u, coordinates.input(*u)),
                    _ => continue,
                };
                rows[(k, place)] += factor * measure.scale / acceleration;
                constant += factor * measure.origin;
            }
            rows[(k, states + count)] = constant / acceleration;
        }
        let pushed = |i: usize, place: usize| -> f64 {
            (0..held.len()).map(|k| flow.b()[(i, k)] * rows[(k, place)]).sum()
        };
        let a = Mat::from_fn(states, states, |i, j| flow.a()[(i, j)] + pushed(i, j));
        // Torques stay as they are.
        let turned = |i: usize, u: usize| match (held.len()..inputs).contains(&u) {
            true => flow.b()[(i, u)],
            false => 0.0,
        };
        let b = Mat::from_fn(states, count, |i, u| turned(i, u) + pushed(i, states + u));
        let c = (0..states).map(|i| flow.c()[i] + pushed(i, states + count));
        let flow = LinearSystem::new(a, b, c.collect::<Vec<f64>>())?;
        Ok(Some(ForcedFlight { flow, user }))
    }

    /// The accelerations that are held over a step along each axis of a body, over the handles of
    /// the user's system.
    fn held_rows(
        &self,
        user: &mut HybridSystem,
        b: usize,
        body: &Body,
    ) -> Result<Vec<Affine>, Error> {
        let axes = self.axes();
        let input =
            |user: &mut HybridSystem, number: usize| user.handles.of(Meaning::Input(number));
        let own: Vec<Variable> = (0..axes).map(|i| input(user, axes * b + i)).collect();
        let mut rows: Vec<Nonlinear> = own.iter().map(|u| Nonlinear::from(*u)).collect();
        let spin = self.spins().position(|(own, _)| own == b);
        if let (Some(heading), Some(place), Some(spin), [forward, left]) =
            (self.heading_state(b), spin, body.spin, &own[..])
        {
            let count = self.bodies.len();
            let rate = user.handles.state(2 * axes * count + place);
            let torque = input(user, axes * count + place);
            let (h, heading) = (user.time_step, user.handles.state(heading));
            // The user's scene, so that the inertia is the user's as well.
            let middle = heading + 0.5 * h * rate + 0.125 * h * h / spin.inertia * torque;
            let turned = |along: Nonlinear, across: Nonlinear, sign: f64| {
                let part = |u: &Variable, k: usize, by: Nonlinear| match body.acceleration[k] {
                    range if range.magnitude() == 0.0 => Nonlinear::from(0.0),
                    _ => by * Nonlinear::from(*u),
                };
                part(forward, 0, along) + sign * part(left, 1, across)
            };
            rows = vec![
                turned(middle.cos(), middle.sin(), -1.0),
                turned(middle.sin(), middle.cos(), 1.0),
            ];
        }
        let forces =
            body.forces.iter().flat_map(|forces| forces.rows.iter().map(move |row| (forces, row)));
        for (own, (forces, force)) in rows.iter_mut().zip(forces) {
            let force = force.try_map(&mut |part: &Affine| {
                let mut sum = Affine::constant(part.offset());
                for (variable, factor) in part.terms() {
                    if let Some(Meaning::State(k)) = forces.handles.meaning(variable) {
                        sum += factor * user.handles.state(2 * axes * b + k);
                    }
                }
                Ok(sum)
            })?;
            *own = &*own + force;
        }
        let place = format!("the forces on {}", body.name);
        let rows = rows.iter().zip(AXES);
        rows.map(|(row, axis)| {
            user.affine_named(row, &format!("{} push {axis}", body.name), &place)
        })
        .collect()
    }
}
