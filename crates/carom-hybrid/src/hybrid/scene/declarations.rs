//! Bodies and obstacles are declared, and found again by their handles and names.

use super::body::Body;
use super::handles::{BodyHandle, ObstacleHandle};
use super::solid::Solid;
use super::statement::{Scene, check_name};
use crate::error::{Error, ErrorKind};
use crate::hybrid::system::{Handles, Meaning};

impl Scene {
    /// Adds a body.
    ///
    /// ```
    /// use carom::hybrid::scene::{Body, Scene, Solid, Surface};
    /// use carom::prelude::*;
    ///
    /// let mut scene = Scene::new(0.1); // s
    /// let puck = Body::new("puck", [0.0..=2.0, 0.0..=1.0], 3.0, 3.0);
    /// let puck = scene.body(puck.with_start([1.5, 0.5, 0.0, 0.0]))?;
    /// scene.obstacle(Solid::cuboid("pillar", [0.9..=1.1, 0.0..=0.7], Surface::avoid()))?;
    ///
    /// let mut program = scene.program(16)?;
    /// program.require("past the pillar", [puck.position(0).le(0.5)], When::OnceIn(0..=16))?;
    /// // As far to the right as it can be again in the end.
    /// program.maximize(program.end(puck.position(0))?)?;
    /// let plan = program.solve(&mut BranchAndBound::default())?;
    /// assert!(plan.bodies[0].position.iter().any(|x| x[0] <= 0.5 + 1e-6));
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ErrorKind::InvalidName`], [`ErrorKind::DuplicateName`]. What else may be wrong with it is
    /// said when the scene is used.
    pub fn body(&mut self, body: Body) -> Result<BodyHandle, Error> {
        check_name(&body.name, self.names())?;
        self.bodies.push(body);
        Ok(self.body_handle(self.bodies.len() - 1))
    }

    /// Adds an obstacle.
    ///
    /// # Errors
    ///
    /// As for [`body`](Scene::body).
    pub fn obstacle(&mut self, obstacle: Solid) -> Result<ObstacleHandle, Error> {
        check_name(&obstacle.name, self.names())?;
        self.obstacles.push(obstacle);
        Ok(ObstacleHandle { tag: self.tag, number: self.obstacles.len() - 1 })
    }

    /// The handle of a body, by its name: for a scene that is stated in one expression.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`].
    pub fn body_named(&self, name: &str) -> Result<BodyHandle, Error> {
        let found = self.bodies.iter().position(|body| body.name == name);
        found
            .map(|number| self.body_handle(number))
            .ok_or_else(|| unknown(name, "body of the scene"))
    }

    /// The handle of an obstacle, by its name.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::UnknownName`].
    pub fn obstacle_named(&self, name: &str) -> Result<ObstacleHandle, Error> {
        let found = self.obstacles.iter().position(|obstacle| obstacle.name == name);
        let number = found.ok_or_else(|| unknown(name, "obstacle of the scene"))?;
        Ok(ObstacleHandle { tag: self.tag, number })
    }

    /// The handles of its system.
    pub(super) fn declared(&self) -> Handles {
        let (axes, bodies) = (self.axes(), self.bodies.len());
        let mut handles = Handles::with_tag(self.tag);
        for body in 0..bodies {
            for state in 0..2 * axes {
                handles.state(2 * axes * body + state);
            }
            for input in 0..axes {
                handles.of(Meaning::Input(axes * body + input));
            }
            match self.spins().position(|(own, _)| own == body) {
                Some(spin) => {
                    handles.state(2 * axes * bodies + spin);
                    handles.of(Meaning::Input(axes * bodies + spin));
                }
                // The same number of handles for every body, whatever is said about it later.
                None => handles.skip(3),
            }
            match self.heading_state(body) {
                Some(heading) => _ = handles.state(heading),
                None => handles.skip(2),
            }
        }
        handles
    }

    fn body_handle(&self, number: usize) -> BodyHandle {
        BodyHandle { tag: self.tag, number, axes: self.bodies[number].axes() }
    }

    /// The number of a body of the scene.
    pub(super) fn body_number(&self, body: BodyHandle, place: &str) -> Result<usize, Error> {
        let is_own = body.tag == self.tag && body.number < self.bodies.len();
        is_own.then_some(body.number).ok_or_else(|| foreign("body", body.number, place))
    }

    /// The number of an obstacle of the scene.
    pub(super) fn obstacle_number(
        &self,
        obstacle: ObstacleHandle,
        place: &str,
    ) -> Result<usize, Error> {
        let is_own = obstacle.tag == self.tag && obstacle.number < self.obstacles.len();
        is_own.then_some(obstacle.number).ok_or_else(|| foreign("obstacle", obstacle.number, place))
    }
}

fn unknown(name: &str, kind: &'static str) -> Error {
    ErrorKind::UnknownName { name: name.to_owned(), kind }.into()
}

fn foreign(kind: &'static str, index: usize, place: &str) -> Error {
    ErrorKind::ForeignHandle { kind, index, place: place.to_owned(), name: None }.into()
}
