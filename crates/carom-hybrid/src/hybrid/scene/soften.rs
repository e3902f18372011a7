//! Obstacles and rooms that bodies may enter or leave at a price.

use super::program::SceneProgram;
use super::solid::Solid;
use super::statement::check_name;
use super::surface::Surface;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::error::{Error, SceneError};
use crate::interval::Interval;
use crate::model::{Affine, Either, Model, Row};

impl SceneProgram {
    /// Adds an obstacle that bodies may enter, and returns the sum of their depths in it over all
    /// steps, in m, for an objective. The obstacle is not one of the scene's: nothing bounces off
    /// it, whatever its surface, and the certificate of a [plan](SceneProgram::solve) does not
    /// speak of it.
    ///
    /// The depth of a body in a step is by how far it is behind the face that it is nearest to
    /// being in front of, at both ends of the step and at the middle control point of its parabola.
    /// A price above what entering saves keeps plans outside wherever they can be; a program with
    /// soft obstacles only has a plan for every state, for
    /// [controllers](crate::hybrid::RecedingHorizon) that must always have one.
    ///
    /// ```
    /// use carom::hybrid::scene::{Body, Scene, Solid, Surface};
    /// use carom::prelude::*;
    ///
    /// // Noise has pushed the drone 2 cm into a pillar.
    /// let room = [0.0..=4.0, 0.0..=2.0];
    /// let drone = Body::new("drone", room, 2.0, 2.0)
    ///     .with_start([1.52, 0.5, 0.0, 0.0])
    ///     .with_goal([3.5, 0.5, 0.0, 0.0]);
    /// let mut program = Scene::new(0.25).with_body(drone).program(16)?;
    /// let sides = [1.5..=2.0, -0.1..=1.2];
    /// let pillar = Solid::cuboid("pillar", &sides, Surface::avoid());
    /// let depth = program.soften_obstacle(&pillar)?;
    /// let effort = program.effort()?;
    /// program.minimize(effort + 1000.0 * depth.clone())?;
    /// let solution = BranchAndBound::default().solve(program.model())?;
    /// assert!((solution.value(&depth)? - 0.02).abs() < 1e-4);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`SceneError`] for an obstacle without faces, of another dimension or with a course shorter
    /// than the horizon; [`ErrorKind::InvalidName`]; [`ErrorKind::DuplicateName`] for the name of a
    /// body or an obstacle of the scene, or of another soft one. The model then stays as it was.
    pub fn soften_obstacle(&mut self, obstacle: &Solid) -> Result<Affine, Error> {
        let (axes, steps) = (self.scene.axes(), self.steps());
        let checked = obstacle.checked(axes)?;
        let obstacle = match self.units.is_plain() {
            true => checked,
            false => self.units.solid(obstacle).checked(axes)?,
        };
        let last = obstacle.course.len().saturating_sub(1);
        if !obstacle.course.is_empty() && last < steps {
            let obstacle = obstacle.name.clone();
            return Err(SceneError::Course { obstacle, last, needed: steps }.into());
        }
        check_name(&obstacle.name, self.scene.names())?;
        let mut model = std::mem::replace(&mut self.program.model, Model::new(""));
        let added = model.all_or_nothing(|model| {
            let mut sum = Affine::zero();
            for body in 0..self.scene.bodies.len() {
                for step in 0..steps {
                    sum += self.depth(model, &obstacle, body, step)?;
                }
            }
            Ok(sum)
        });
        self.program.model = model;
        if !obstacle.course.is_empty() {
            self.program.model.note_by_step(format!("the course of `{}`", obstacle.name));
        }
        let sum = added?;
        Ok(if self.units.is_plain() { sum } else { self.units.length * sum })
    }

    /// Adds the walls of a room along the axes, in m, that bodies may leave, and returns the sum of
    /// their distances outside over all steps and walls, in m. The domains of the bodies hold
    /// without exception, so they must be wider than the room.
    ///
    /// # Errors
    ///
    /// As for [`soften_obstacle`](Self::soften_obstacle).
    pub fn soften_room(
        &mut self,
        name: &str,
        sides: impl IntoIterator<Item: Into<Interval>>,
    ) -> Result<Affine, Error> {
        let walls = Solid::room(name, sides, Surface::avoid()).into_iter();
        walls.map(|wall| self.soften_obstacle(&wall)).sum()
    }

    /// The depth of a body in an obstacle in a step, as a new variable.
    fn depth(
        &self,
        model: &mut Model,
        obstacle: &Solid,
        body: usize,
        step: usize,
    ) -> Result<Affine, Error> {
        let axes = self.scene.axes();
        let own = &self.scene.bodies[body];
        // By how much each of the three points is behind each face.
        let mut behind: Vec<[Affine; 3]> = Vec::new();
        for face in &obstacle.faces {
            let limit = |sample: usize| {
                let displacement = obstacle.displacement(sample, axes);
                let moved: f64 = face.normal.iter().zip(&displacement).map(|(n, d)| n * d).sum();
                face.offset + own.shape.reach(&face.normal) + moved
            };
            let along = |from: usize, sample: usize| -> Affine {
                let families = &self.program().variables().states()[2 * axes * body + from..];
                let terms = families.iter().zip(&face.normal).filter(|(_, n)| **n != 0.0);
                terms.map(|(family, n)| *n * family[sample]).sum()
            };
            let (now, next) = (limit(step), limit(step + 1));
            let middle = along(0, step) + 0.5 * self.scene.time_step * along(axes, step);
            behind.push([
                now - along(0, step),
                0.5 * (now + next) - middle,
                next - along(0, step + 1),
            ]);
        }
        // There is always a face that needs no more than this.
        let mut most = f64::INFINITY;
        for points in &behind {
            let mut own = 0.0_f64;
            for point in points {
                own = own.max(model.range(point)?.upper);
            }
            most = most.min(own);
        }
        let family = format!("{}_in_{}", own.name, obstacle.name).replace(char::is_whitespace, "_");
        if most <= 0.0 {
            return Ok(Affine::zero());
        }
        let depth = model.continuous((format!("depth_of_{family}"), step), 0.0, most)?;
        let rows = |points: [Affine; 3]| points.map(|point| point.le(depth)).to_vec();
        let mut faces: Vec<Vec<Row>> = behind.into_iter().map(rows).collect();
        if faces.len() == 1 {
            for (k, row) in faces.remove(0).into_iter().enumerate() {
                model.add((format!("{family}_{k}"), step), row)?;
            }
        } else {
            model.add((family, step), Either::of(faces))?;
        }
        Ok(depth.into())
    }
}
