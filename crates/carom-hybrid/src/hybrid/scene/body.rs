//! Bodies: shape, mass and linear dynamics.

use faer::Mat;

use super::axes::region_where;
use super::forces::Forces;
use super::geometry::length;
use crate::activity;
use crate::error::{Error, ErrorKind, FINITE_POSITIVE, SceneError, check_finite};
use crate::hybrid::linear::LinearSystem;
use crate::hybrid::matrix::{Matrix, faer};
use crate::hybrid::system::{Region, State, SystemRow};
use crate::interval::Interval;
use crate::setters::setters;
use crate::tolerance::largest_magnitude;

/// The shape of a body, around its position. Only a disc may turn, by [`Body::with_spin`].
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Shape {
    /// A point.
    #[default]
    Point,
    /// A disc in the plane, a ball in space, with a radius in m.
    Ball(f64),
    /// A box along the axes, with half its width along each axis, in m.
    Box(Vec<f64>),
}

impl Shape {
    /// How far it reaches in a direction of length 1, in m.
    pub(super) fn reach(&self, direction: &[f64]) -> f64 {
        match self {
            Shape::Point => 0.0,
            Shape::Ball(radius) => *radius,
            Shape::Box(half) => half.iter().zip(direction).map(|(h, n)| h * n.abs()).sum(),
        }
    }
}

/// How a body spins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spin {
    /// In kg m².
    pub(super) inertia: f64,
    /// At a sample, in rad/s.
    pub(super) max_rate: f64,
    /// In N m.
    pub(super) max_torque: f64,
}

impl Spin {
    pub(super) fn rates(&self) -> Interval {
        Interval::new(-self.max_rate, self.max_rate)
    }

    pub(super) fn torques(&self) -> Interval {
        Interval::new(-self.max_torque, self.max_torque)
    }
}

/// A body: `dv/dt = K x + D v + u + g` along 1 to 3 axes, with the input u (m/s²) held over each
/// step. By default K, D and g are 0.
///
/// ```
/// use carom::hybrid::scene::{Body, Shape};
///
/// // A puck on a table of 2 m by 1 m, at most 3 m/s and 4 m/s² along each axis.
/// let puck = Body::new("puck", [0.0..=2.0, 0.0..=1.0], 3.0, 4.0)
///     .with_shape(Shape::Ball(0.05))
///     .with_mass(0.2)
///     .with_start([0.2, 0.5, 0.0, 0.0]);
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Body {
    /// Its name.
    pub name: String,
    /// Where its position may be along each axis, in m.
    pub domain: Vec<Interval>,
    /// The largest speed along each axis at a sample, in m/s.
    pub max_speed: f64,
    /// Whether it is the largest length of the velocity.
    pub(super) is_speed_ball: bool,
    /// The range of the input along each axis, in m/s².
    pub acceleration: Vec<Interval>,
    /// The largest length of the input, in m/s², if it is limited.
    pub(super) acceleration_ball: Option<f64>,
    /// By how much pushes may change its velocity in a step, along each axis, in m/s; empty if none
    /// do.
    pub(super) pushes: Vec<Interval>,
    /// Its mass, in kg; default 1.
    pub mass: f64,
    /// Its shape; default a point.
    pub shape: Shape,
    /// K, in 1/s², and D, in 1/s.
    pub(super) dynamics: Option<(Mat<f64>, Mat<f64>)>,
    /// g, in m/s².
    pub(super) gravity: Vec<f64>,
    /// Where it starts: positions (m), then velocities (m/s).
    pub start: Option<Region>,
    /// Where it ends, in the same order.
    pub goal: Option<Region>,
    pub(super) first: Option<Vec<f64>>,
    pub(super) spin: Option<Spin>,
    /// The range of its heading, in rad.
    pub(super) heading: Option<Interval>,
    pub(super) forces: Option<Forces>,
}

impl Body {
    /// A point of 1 kg.
    ///
    /// # Arguments
    ///
    /// * `domain`: where it may be along each axis, in m; its length is the number of axes.
    /// * `max_speed`: along each axis, in m/s; `max_acceleration`: along each axis, in m/s².
    pub fn new(
        name: impl Into<String>,
        domain: impl IntoIterator<Item: Into<Interval>>,
        max_speed: f64,
        max_acceleration: f64,
    ) -> Self {
        let domain: Vec<Interval> = domain.into_iter().map(Into::into).collect();
        let range = Interval::new(-max_acceleration, max_acceleration);
        Body {
            name: name.into(),
            max_speed,
            is_speed_ball: false,
            acceleration_ball: None,
            acceleration: vec![range; domain.len()],
            gravity: vec![0.0; domain.len()],
            domain,
            pushes: Vec::new(),
            mass: 1.0,
            shape: Shape::Point,
            dynamics: None,
            start: None,
            goal: None,
            first: None,
            spin: None,
            heading: None,
            forces: None,
        }
    }

    setters! {
        /// Sets the mass, in kg.
        with_mass(mass: f64) => mass = mass;
        /// Sets the shape.
        with_shape(shape: Shape) => shape = shape;
    }

    /// Says by how much pushes, such as gusts, may change its velocity in each step, along each
    /// axis, in m/s. [Robust programs](crate::hybrid::HybridProgram::robust) plan for all of them,
    /// and others for none.
    #[must_use]
    pub fn with_pushes(mut self, pushes: impl IntoIterator<Item: Into<Interval>>) -> Self {
        self.pushes = pushes.into_iter().map(Into::into).collect();
        self
    }

    /// Sets where it starts: positions (m), then velocities (m/s), and last the spin (rad/s) of a
    /// body that has one and its heading (rad) likewise, as a point or as a range for each.
    #[must_use]
    pub fn with_start(mut self, region: impl Into<Region>) -> Self {
        self.start = Some(region.into());
        self
    }

    /// Sets where it ends: positions (m), then velocities (m/s), as a point or as a range for each;
    /// and last, if they matter, the spin (rad/s) and the heading (rad).
    #[must_use]
    pub fn with_goal(mut self, region: impl Into<Region>) -> Self {
        self.goal = Some(region.into());
        self
    }

    /// Lets it end wherever rows of its positions (m) and velocities (m/s) along the axes hold.
    ///
    /// ```
    /// use carom::hybrid::scene::Body;
    /// use carom::prelude::*;
    ///
    /// // Beside the line x = y, and slower along x than along y.
    /// let puck = Body::new("puck", [0.0..=2.0, 0.0..=1.0], 3.0, 4.0)
    ///     .with_goal_where(|x, v| [x[0].le(x[1]), v[0].le(v[1])])?;
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Those of [`HybridSystem::region`](crate::hybrid::HybridSystem::region).
    pub fn with_goal_where<R: IntoIterator<Item: Into<SystemRow>>>(
        self,
        rows: impl FnOnce(&[State], &[State]) -> R,
    ) -> Result<Self, Error> {
        let region = region_where(self.axes(), rows)?;
        Ok(self.with_goal(region))
    }

    /// Limits the length of the velocity at a sample, in m/s, instead of its entry along each axis:
    /// the body is as fast in one direction as in any other.
    ///
    /// ```
    /// use carom::hybrid::scene::{Body, Scene};
    /// use carom::prelude::*;
    ///
    /// // 3 m/s and 4 m/s² in any direction; the least fuel to a point at rest.
    /// let at_rest = |x: f64, y: f64| [x, y, 0.0, 0.0];
    /// let puck = Body::new("puck", [0.0..=9.0, 0.0..=9.0], 3.0, 4.0)
    ///     .with_speed_ball(3.0)
    ///     .with_acceleration_ball(4.0)
    ///     .with_start(at_rest(1.0, 1.0))
    ///     .with_goal(at_rest(4.0, 5.0));
    /// let mut program = Scene::new(0.25).with_body(puck).program(12)?;
    /// let fuel = program.fuel()?;
    /// program.minimize(fuel)?;
    /// let plan = program.solve(&mut BranchAndBound::default())?;
    /// let speed = |v: &Vec<f64>| v[0].hypot(v[1]);
    /// assert!(plan.bodies[0].velocity.iter().all(|v| speed(v) < 3.0 + 2e-6));
    /// # Ok::<(), carom::Error>(())
    /// ```
    #[must_use]
    pub fn with_speed_ball(mut self, max_speed: f64) -> Self {
        (self.max_speed, self.is_speed_ball) = (max_speed, true);
        self
    }

    /// Limits the length of the input, in m/s², instead of its entry along each axis: a thrust that
    /// can be turned in any direction.
    #[must_use]
    pub fn with_acceleration_ball(mut self, max_acceleration: f64) -> Self {
        self.acceleration = vec![Interval::new(-max_acceleration, max_acceleration); self.axes()];
        self.acceleration_ball = Some(max_acceleration);
        self
    }

    /// Sets the range of the input along each axis, in m/s², without a limit of its length.
    #[must_use]
    pub fn with_acceleration(mut self, ranges: impl IntoIterator<Item: Into<Interval>>) -> Self {
        self.acceleration = ranges.into_iter().map(Into::into).collect();
        self.acceleration_ball = None;
        self
    }

    /// Sets the input of the first step, in m/s², one entry per axis.
    #[must_use]
    pub fn with_first_acceleration(mut self, first: impl Into<Vec<f64>>) -> Self {
        self.first = Some(first.into());
        self
    }

    /// Sets g, in m/s², one entry per axis.
    #[must_use]
    pub fn with_gravity(mut self, gravity: impl Into<Vec<f64>>) -> Self {
        self.gravity = gravity.into();
        self
    }

    /// Sets K (1/s²) and D (1/s), each with a row and a column per axis: springs, drag, the motion
    /// relative to an orbit.
    #[must_use]
    pub fn with_dynamics(mut self, k: impl Into<Matrix>, d: impl Into<Matrix>) -> Self {
        self.dynamics = Some((faer(k), faer(d)));
        self
    }

    /// Whether a length of its velocity or its input is limited.
    pub(super) fn has_ball(&self) -> bool {
        self.is_speed_ball || self.acceleration_ball.is_some()
    }

    /// Number of axes.
    pub fn axes(&self) -> usize {
        self.domain.len()
    }

    /// Whether free flight moves each axis by itself.
    pub(super) fn is_apart(&self) -> bool {
        let is_diagonal = |m: &Mat<f64>| {
            let mut pairs = (0..m.nrows()).flat_map(|i| (0..m.ncols()).map(move |j| (i, j)));
            pairs.all(|(i, j)| i == j || m[(i, j)] == 0.0)
        };
        !self.is_nonlinear()
            && self.dynamics.iter().all(|(k, damping)| is_diagonal(k) && is_diagonal(damping))
    }

    /// A step of `[x, v]` under u.
    pub(super) fn flow(&self, time_step: f64) -> Result<LinearSystem, Error> {
        let (d, dt) = (self.axes(), time_step);
        let on = |i: usize, j: usize, value: f64| if i == j { value } else { 0.0 };
        let Some((k, damping)) = &self.dynamics else {
            let a = Mat::from_fn(2 * d, 2 * d, |i, j| on(i, j, 1.0) + on(i + d, j, dt));
            let b = |i: usize, j: usize| on(i, j, 0.5 * dt * dt) + on(i, j + d, dt);
            let c = (0..2 * d).map(|i| {
                let part = if i < d { 0.5 * dt * dt } else { dt };
                part * self.gravity[i % d]
            });
            return LinearSystem::new(a, Mat::from_fn(2 * d, d, b), c.collect::<Vec<_>>());
        };
        let a = Mat::from_fn(2 * d, 2 * d, |i, j| match (i < d, j < d) {
            (true, _) => on(i + d, j, 1.0),
            (false, true) => k[(i - d, j)],
            (false, false) => damping[(i - d, j - d)],
        });
        let c = [vec![0.0; d], self.gravity.clone()].concat();
        LinearSystem::zero_order_hold(a, Mat::from_fn(2 * d, d, |i, j| on(i, j + d, 1.0)), c, dt)
    }

    /// The largest rate of change of the acceleration in a direction during a step of free flight
    /// from a sample, in m/s³: 0 without K and D.
    pub(super) fn largest_jerk(&self, direction: &[f64], time_step: f64) -> f64 {
        let Some((k, damping)) = &self.dynamics else { return 0.0 };
        let (d, dt) = (self.axes(), time_step);
        let largest = |intervals: &[Interval]| {
            intervals.iter().map(|i| i.magnitude()).fold(0.0_f64, f64::max)
        };
        let norm = |m: &Mat<f64>| {
            let rows = (0..d).map(|i| (0..d).map(|j| m[(i, j)].abs()).sum::<f64>());
            rows.fold(0.0_f64, f64::max)
        };
        // Gronwall's inequality for the largest speed along an axis: the body starts within its
        // domain and its limit of speed, and may leave both before the step ends.
        let pull = largest(&self.acceleration)
            + largest_magnitude(&self.gravity)
            + norm(k) * largest(&self.domain);
        let growth = (norm(damping) + norm(k) * dt) * dt;
        let top = (self.max_speed + pull * dt) * growth.exp();
        let speed = Interval::new(-top, top);
        let sum = |m: &Mat<f64>, i: usize, of: &dyn Fn(usize) -> Interval| {
            activity::range(0.0, (0..d).map(|j| (m[(i, j)], of(j))))
        };
        let accelerations: Vec<Interval> = (0..d)
            .map(|i| {
                let own = self.acceleration[i] + Interval::point(self.gravity[i]);
                let spring = sum(k, i, &|j| self.domain[j] + speed * dt);
                own + spring + sum(damping, i, &|_| speed)
            })
            .collect();
        let jerk = |i: usize| sum(k, i, &|_| speed) + sum(damping, i, &|j| accelerations[j]);
        activity::range(0.0, (0..d).map(|i| (direction[i], jerk(i)))).magnitude()
    }

    pub(super) fn check(&self, axes: usize) -> Result<(), Error> {
        let name = &self.name;
        let lengths = [
            self.axes(),
            self.acceleration.len(),
            self.gravity.len(),
            self.first.as_ref().map_or(axes, Vec::len),
            if self.pushes.is_empty() { axes } else { self.pushes.len() },
            match &self.shape {
                Shape::Box(half) => half.len(),
                _ => axes,
            },
        ];
        if let Some(&found) = lengths.iter().find(|&&length| length != axes) {
            return Err(SceneError::Axes { name: name.clone(), found, expected: axes }.into());
        }
        for range in self.domain.iter().chain(&self.acceleration).chain(&self.pushes) {
            range.check(name)?;
        }
        check_finite(name, "the gravity", self.gravity.iter().copied())?;
        check_finite(name, "the first acceleration", self.first.iter().flatten().copied())?;
        for (value, range) in self.first.iter().flatten().zip(&self.acceleration) {
            if !(range.lower <= *value && *value <= range.upper) {
                let what = format!("the first acceleration of `{name}`");
                let limits = format!("within {} and {}", range.lower, range.upper);
                let range = range.lower..=range.upper;
                return Err(Error::out_of_range_in_words(what, *value, range, limits));
            }
        }
        if let (Some(most), Some(first)) = (self.acceleration_ball, &self.first) {
            let length = length(first);
            if length > most * (1.0 + 1e-12) {
                let what = format!("the length of the first acceleration of `{name}`");
                return Err(Error::out_of_range(what, length, ..=most));
            }
        }
        let sizes = match &self.shape {
            Shape::Point => Vec::new(),
            Shape::Ball(radius) => vec![*radius],
            Shape::Box(half) => half.clone(),
        };
        let positive = |value: &f64| value.is_finite() && *value > 0.0;
        for (what, value, fits) in [
            ("mass (kg)", self.mass, positive(&self.mass)),
            ("largest speed (m/s)", self.max_speed, positive(&self.max_speed)),
            ("size (m)", sizes.iter().copied().fold(0.0, f64::min), sizes.iter().all(positive)),
        ] {
            if !fits {
                let what = format!("the {what} of `{name}`");
                return Err(Error::out_of_range(what, value, FINITE_POSITIVE));
            }
        }
        self.check_spin()?;
        self.check_forces()?;
        for matrix in self.dynamics.iter().flat_map(|(k, d)| [k, d]) {
            let (rows, columns) = (matrix.nrows(), matrix.ncols());
            if rows != axes || columns != axes {
                let expected = format!("{axes}x{axes}");
                let what = "a matrix of the dynamics of a body";
                return Err(ErrorKind::Shape { what, rows, columns, expected }.into());
            }
            let entries = (0..axes).flat_map(|i| (0..axes).map(move |j| matrix[(i, j)]));
            check_finite(name, "an entry of the dynamics", entries)?;
        }
        Ok(())
    }
}
