//! Obstacles: half-spaces and convex polytopes, still or on a course.

use super::geometry::length;
use super::surface::Surface;
use crate::error::{Error, SceneError, check_finite};
use crate::interval::Interval;

/// Entries of a normal of length 1 below this are rounding (no unit).
const NOISE: f64 = 1e-14;

/// A face: solid where `normal . x <= offset`.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Face {
    /// Out of the obstacle.
    pub(super) normal: Vec<f64>,
    pub(super) offset: f64,
    pub(super) surface: Surface,
}

/// A convex obstacle: the points behind all of its faces.
///
/// ```
/// use carom::hybrid::Restitution;
/// use carom::hybrid::scene::{Solid, Surface};
///
/// let cushion = Surface::bounce(Restitution::new(0.8)?);
/// // Solid where x <= 0.
/// let wall = Solid::halfspace("wall", [1.0, 0.0], 0.0, cushion);
/// let pillar = Solid::cuboid("pillar", [1.0..=2.0, 0.0..=0.5], Surface::avoid());
/// assert_eq!((wall.faces(), pillar.faces()), (1, 4));
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Solid {
    /// Its name.
    pub name: String,
    pub(super) faces: Vec<Face>,
    /// Its displacement at each sample, in m; empty if it does not move.
    pub(super) course: Vec<Vec<f64>>,
    /// A face of which a surface was set and that does not exist, for the check.
    missing: Option<usize>,
}

impl Solid {
    /// A half-space, solid where `normal . x <= offset`. The normal may have any length; the
    /// offset is in m times that length.
    pub fn halfspace(
        name: impl Into<String>,
        normal: impl Into<Vec<f64>>,
        offset: f64,
        surface: Surface,
    ) -> Self {
        Solid::polytope(name, [(normal.into(), offset)], surface)
    }

    /// The walls of a room along the axes, in m: the half-spaces `name 0`, `name 1`, ... at the
    /// lower and the upper side of each axis.
    pub(super) fn room(
        name: &str,
        sides: impl IntoIterator<Item: Into<Interval>>,
        surface: Surface,
    ) -> Vec<Solid> {
        let sides: Vec<Interval> = sides.into_iter().map(Into::into).collect();
        let wall = |number: usize| {
            let (axis, side) = (number / 2, sides[number / 2]);
            let (sign, at) =
                if number.is_multiple_of(2) { (1.0, side.lower) } else { (-1.0, -side.upper) };
            let normal: Vec<f64> =
                (0..sides.len()).map(|j| if j == axis { sign } else { 0.0 }).collect();
            Solid::halfspace(format!("{name} {number}"), normal, at, surface)
        };
        (0..2 * sides.len()).map(wall).collect()
    }

    /// A convex polytope, solid where `normal . x <= offset` for all of its faces; normals point
    /// out of it. Faces are numbered from 0.
    pub fn polytope<N: Into<Vec<f64>>>(
        name: impl Into<String>,
        faces: impl IntoIterator<Item = (N, f64)>,
        surface: Surface,
    ) -> Self {
        let faces = faces.into_iter();
        let faces = faces.map(|(normal, offset)| Face { normal: normal.into(), offset, surface });
        Solid { name: name.into(), faces: faces.collect(), course: Vec::new(), missing: None }
    }

    /// A box along the axes, in m. Faces 2 i and 2 i + 1 are the lower and the upper one along axis
    /// i.
    pub fn cuboid(
        name: impl Into<String>,
        sides: impl IntoIterator<Item: Into<Interval>>,
        surface: Surface,
    ) -> Self {
        let sides: Vec<Interval> = sides.into_iter().map(Into::into).collect();
        let axes = sides.len();
        let faces = sides.iter().enumerate().flat_map(|(i, side)| {
            let along = |sign: f64| -> Vec<f64> {
                (0..axes).map(|j| if i == j { sign } else { 0.0 }).collect()
            };
            [(along(-1.0), -side.lower), (along(1.0), side.upper)]
        });
        Solid::polytope(name, faces, surface)
    }

    /// Sets the surface of one face, by its number. Scenes refuse a number that no face has.
    #[must_use]
    pub fn with_surface_of(mut self, face: usize, surface: Surface) -> Self {
        match self.faces.get_mut(face) {
            Some(face) => face.surface = surface,
            None => self.missing = Some(face),
        }
        self
    }

    /// Lets it move: its displacement from where it was stated at the samples 0, 1, ..., in m, one
    /// entry per axis. Between samples it moves straight and evenly, without turning. A course
    /// must be as long as the plan.
    #[must_use]
    pub fn with_course<P: Into<Vec<f64>>>(mut self, places: impl IntoIterator<Item = P>) -> Self {
        self.course = places.into_iter().map(Into::into).collect();
        self
    }

    /// The obstacle with its course from a step on, which ends where it ends.
    #[must_use]
    pub fn from_step(&self, step: usize) -> Self {
        let mut later = self.clone();
        let last = later.course.len().saturating_sub(1);
        later.course.drain(..step.min(last));
        later
    }

    /// Number of faces.
    pub fn faces(&self) -> usize {
        self.faces.len()
    }

    /// Its displacement at a sample, in m.
    pub(super) fn displacement(&self, sample: usize, axes: usize) -> Vec<f64> {
        self.course.get(sample).or(self.course.last()).cloned().unwrap_or_else(|| vec![0.0; axes])
    }

    /// Refuses wrong numbers of axes, normals without direction and numbers that are not finite;
    /// returns the obstacle with normals of length 1.
    pub(super) fn checked(&self, axes: usize) -> Result<Solid, Error> {
        let mut own = self.clone();
        let name = || self.name.clone();
        if own.faces.is_empty() {
            let what = format!("the number of faces of `{}`", self.name);
            return Err(Error::out_of_range(what, 0.0, 1.0..));
        }
        if let Some(face) = self.missing {
            let what = format!("the face of `{}` whose surface is set", self.name);
            return Err(Error::out_of_range(what, face as f64, ..self.faces.len() as f64));
        }
        let lengths = self.faces.iter().map(|face| face.normal.len());
        let mut lengths = lengths.chain(self.course.iter().map(Vec::len));
        if let Some(found) = lengths.find(|&length| length != axes) {
            return Err(SceneError::Axes { name: name(), found, expected: axes }.into());
        }
        check_finite(&self.name, "a place of the course", self.course.iter().flatten().copied())?;
        for (k, face) in own.faces.iter_mut().enumerate() {
            let numbers = face.normal.iter().copied().chain([face.offset]);
            check_finite(&self.name, "a number of a face", numbers)?;
            let length = length(&face.normal);
            if !(length > 1e-9 && length.is_finite()) {
                return Err(SceneError::Normal { obstacle: name(), face: k }.into());
            }
            face.surface.check(&self.name, axes)?;
            let scaled = |n: &f64| if (n / length).abs() < NOISE { 0.0 } else { n / length };
            face.normal = face.normal.iter().map(scaled).collect();
            face.offset /= length;
        }
        Ok(own)
    }
}
