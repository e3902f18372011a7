//! A scene: bodies, obstacles, pairs of bodies.

use super::body::{Body, Shape};
use super::geometry::{self, Side, dot, length};
use super::handles::BodyHandle;
use super::rule::DamageRule;
use super::solid::Solid;
use super::surface::Surface;
use crate::error::{Error, ErrorKind, SceneError, check_finite};
use crate::hybrid::damage::ImpactEstimate;
use crate::hybrid::horizon::Horizon;
use crate::interval::Interval;
use crate::model::{ModelTag, is_name};
use crate::setters::setters;

/// Number of normals of two bodies in the plane that meet, if one of them is a disc.
const NORMALS: usize = 8;

/// How far a start or a goal may be inside an obstacle, in m.
pub(super) const INSIDE: f64 = 1e-9;

/// Two bodies that avoid each other or hit.
#[derive(Debug, Clone)]
pub(super) struct Pair {
    bodies: [BodyHandle; 2],
    /// The numbers of the bodies, in a checked scene.
    pub(super) first: usize,
    pub(super) second: usize,
    pub(super) surface: Surface,
    /// Of length 1, from the second towards the first.
    pub(super) normals: Vec<Vec<f64>>,
}

/// Bodies and obstacles on a line, in the plane or in space.
///
/// [`body`](Scene::body) and [`obstacle`](Scene::obstacle) return the handles with which pairs,
/// rules and rows are stated; a scene that needs none is one expression, by
/// [`with_body`](Scene::with_body) and [`with_obstacle`](Scene::with_obstacle). A clone has the
/// same handles.
///
/// The scene is a [`HybridSystem`](crate::hybrid::HybridSystem) whose choices are its contacts:
/// each body and obstacle, and each pair of bodies, chooses in every step whether and at which face
/// it touches. See the [module](super) for the laws.
///
/// ```
/// use carom::hybrid::scene::{Body, Solid, Scene, Surface};
/// use carom::hybrid::{Restitution, ShortestOptions};
/// use carom::prelude::*;
///
/// // A puck that comes in fast and must stop near a cushion at x = 0: with the cushion's help.
/// let puck = Body::new("puck", [0.0..=2.0, 0.0..=1.0], 3.0, 3.0)
///     .with_start([1.5, 0.5, -2.0, 0.0])
///     .with_goal([0.2, 0.6, 0.0, 0.0]);
/// let cushion = Surface::bounce(Restitution::new(0.3)?);
/// let scene = Scene::new(0.1)
///     .with_body(puck)
///     .with_obstacle(Solid::halfspace("cushion", [1.0, 0.0], 0.0, cushion));
/// let (options, mut solver) = (ShortestOptions::default(), BranchAndBound::default());
/// let found = scene.shortest_with(&options, &mut solver)?;
/// let plan = found.plan.expect("there is one");
/// assert!(plan.certificate.largest_residual < 1e-6);
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Scene {
    /// Δt, in s.
    pub time_step: f64,
    /// The bodies.
    pub bodies: Vec<Body>,
    /// The obstacles.
    pub obstacles: Vec<Solid>,
    /// Rules about damage.
    pub rules: Vec<DamageRule>,
    /// How impacts within a step are counted; default [`ImpactEstimate::Sound`].
    pub estimate: ImpactEstimate,
    /// Whether a body may hit several faces in one step, as in a corner; default no.
    pub corners: bool,
    /// By how much every step of a plan is on one side of a surface to bounce off, in m: it ends at
    /// least this far in front of it, or hits at least this far behind it; default 0.
    pub margin: f64,
    pub(super) pairs: Vec<Pair>,
    /// Of its handles.
    pub(super) tag: ModelTag,
}

impl Scene {
    /// A scene without bodies and obstacles.
    ///
    /// # Arguments
    ///
    /// * `time_step`: Δt in s, finite and positive.
    pub fn new(time_step: f64) -> Self {
        Scene {
            time_step,
            bodies: Vec::new(),
            obstacles: Vec::new(),
            rules: Vec::new(),
            estimate: ImpactEstimate::Sound,
            corners: false,
            margin: 0.0,
            pairs: Vec::new(),
            tag: ModelTag::fresh(),
        }
    }

    setters! {
        /// Sets how impacts within a step are counted.
        with_estimate(estimate: ImpactEstimate) => estimate = estimate;
        /// Lets bodies hit several faces in one step. The effects add, which is the law of a corner
        /// whose faces are at right angles. Without it, a body that cannot but move into a corner
        /// has no plan, and the text of the search says so.
        with_corners(wanted: bool) => corners = wanted;
        /// Keeps every step of a plan away from ties, in m: a step that ends exactly at a surface
        /// to bounce off may hit it or fly, so that what really happens is left to chance. With a
        /// margin, free flight ends at least this far in front of every such surface, or at least
        /// this far behind the one that is hit. A body can then not lie at a surface.
        with_margin(margin: f64) => margin = margin;
    }

    /// As [`body`](Scene::body), in one expression; names are checked when the scene is used.
    #[must_use]
    pub fn with_body(mut self, body: Body) -> Self {
        self.bodies.push(body);
        self
    }

    /// As [`obstacle`](Scene::obstacle), in one expression; names are checked when the scene is
    /// used.
    #[must_use]
    pub fn with_obstacle(mut self, obstacle: Solid) -> Self {
        self.obstacles.push(obstacle);
        self
    }

    /// Adds the walls of a room along the axes, in m: the half-spaces `name 0`, `name 1`, ... at
    /// the lower and the upper side of each axis.
    #[must_use]
    pub fn with_room(
        mut self,
        name: &str,
        sides: impl IntoIterator<Item: Into<Interval>>,
        surface: Surface,
    ) -> Self {
        self.obstacles.extend(Solid::room(name, sides, surface));
        self
    }

    /// Adds a rule about damage.
    #[must_use]
    pub fn with_rule(mut self, rule: DamageRule) -> Self {
        self.rules.push(rule);
        self
    }

    /// Lets two bodies avoid each other, or hit. Bodies without such a statement pass through each
    /// other.
    ///
    /// The direction of a hit is one of a few normals: in the plane, if one of the two is a disc, 8
    /// around the circle; otherwise two along each axis, so that points and boxes in the plane
    /// have 4.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`]; [`ErrorKind::DuplicateName`] for bodies that are a pair
    /// already, and for a body with itself.
    pub fn pair(
        &mut self,
        first: BodyHandle,
        second: BodyHandle,
        surface: Surface,
    ) -> Result<(), Error> {
        let normals: &[[f64; 0]] = &[];
        self.pair_along(first, second, surface, normals.iter().copied())
    }

    /// As [`pair`](Scene::pair), with the normals along which they hit, from the second body
    /// towards the first. They must surround the second body.
    ///
    /// # Errors
    ///
    /// Those of [`pair`](Scene::pair).
    pub fn pair_along<N: Into<Vec<f64>>>(
        &mut self,
        first: BodyHandle,
        second: BodyHandle,
        surface: Surface,
        normals: impl IntoIterator<Item = N>,
    ) -> Result<(), Error> {
        let normals = normals.into_iter().map(Into::into).collect();
        let bodies = [first, second];
        let pair = Pair { bodies, first: 0, second: 0, surface, normals };
        self.numbered(&pair, &self.pairs)?;
        self.pairs.push(pair);
        Ok(())
    }

    /// The numbers of the bodies of a pair that is not yet among others, and its name.
    fn numbered(&self, pair: &Pair, others: &[Pair]) -> Result<([usize; 2], String), Error> {
        let [first, second] = pair.bodies;
        let numbers = [self.body_number(first, "a pair")?, self.body_number(second, "a pair")?];
        let [a, b] = numbers.map(|number| &self.bodies[number].name);
        let name = format!("{a} and {b}");
        let is_same = |other: &Pair| other.bodies == pair.bodies || other.bodies == [second, first];
        if first == second || others.iter().any(is_same) {
            return Err(ErrorKind::DuplicateName { name, kind: "pair of bodies" }.into());
        }
        Ok((numbers, name))
    }

    /// The scene as it is from a step on: courses are those of that step at step 0, and end where
    /// they end. For the programs of a [moving horizon](crate::hybrid::RecedingHorizon::moving).
    #[must_use]
    pub fn from_step(&self, step: usize) -> Self {
        let mut scene = self.clone();
        scene.obstacles.iter_mut().for_each(|obstacle| *obstacle = obstacle.from_step(step));
        scene
    }

    /// The number of axes.
    pub fn axes(&self) -> usize {
        self.bodies.first().map_or(0, Body::axes)
    }

    /// The names of bodies and obstacles.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        let obstacles = self.obstacles.iter().map(|obstacle| &obstacle.name);
        self.bodies.iter().map(|body| &body.name).chain(obstacles).map(String::as_str)
    }

    /// The longest plan that courses allow, in steps; `None` if nothing moves.
    pub(super) fn longest(&self) -> Option<(&Solid, usize)> {
        let moving = self.obstacles.iter().filter(|obstacle| !obstacle.course.is_empty());
        moving.map(|o| (o, o.course.len() - 1)).min_by_key(|(_, steps)| *steps)
    }

    /// Refuses scenes that contradict themselves; returns the scene with normals of length 1.
    pub(super) fn checked_as_stated(&self) -> Result<Scene, Error> {
        Horizon::new(1, self.time_step)?;
        if !(self.margin >= 0.0 && self.margin.is_finite()) {
            let (what, range) = ("the margin of the scene", 0.0..f64::INFINITY);
            return Err(Error::out_of_range_with(what, self.margin, range, " m"));
        }
        let axes = self.axes();
        if !(1..=3).contains(&axes) {
            let what = "the number of axes of the scene's first body";
            return Err(Error::out_of_range_in_words(what, axes as f64, 1.0..=3.0, "from 1 to 3"));
        }
        for (k, name) in self.names().enumerate() {
            check_name(name, self.names().take(k))?;
        }
        for body in &self.bodies {
            body.check(axes)?;
            body.check_regions()?;
        }
        let mut own = self.clone();
        for obstacle in &mut own.obstacles {
            *obstacle = obstacle.checked(axes)?;
            check_faces(obstacle, axes)?;
        }
        for k in 0..own.pairs.len() {
            own.pairs[k] = own.checked_pair(k)?;
        }
        own.check_energy()?;
        own.check_ends()?;
        own.rules.iter().try_for_each(|rule| rule.check(&own))?;
        Ok(own)
    }

    /// A pair with the numbers of its bodies and with normals of length 1.
    fn checked_pair(&self, k: usize) -> Result<Pair, Error> {
        let mut pair = self.pairs[k].clone();
        let (numbers, name) = self.numbered(&pair, &self.pairs[..k])?;
        [pair.first, pair.second] = numbers;
        let axes = self.axes();
        pair.surface.check(&name, axes)?;
        if pair.normals.is_empty() {
            pair.normals = default_normals(&self.bodies[pair.first], &self.bodies[pair.second]);
        }
        for (face, normal) in pair.normals.iter_mut().enumerate() {
            let found = normal.len();
            if found != axes {
                return Err(SceneError::Axes { name, found, expected: axes }.into());
            }
            check_finite(&name, "a normal", normal.iter().copied())?;
            let length = length(normal);
            if !(length > 1e-9 && length.is_finite()) {
                return Err(SceneError::Normal { obstacle: name, face }.into());
            }
            normal.iter_mut().for_each(|n| *n /= length);
        }
        Ok(pair)
    }
}

/// Refuses a name that is none, or that another body or obstacle has.
pub(super) fn check_name<'a>(
    name: &str,
    mut others: impl Iterator<Item = &'a str>,
) -> Result<(), Error> {
    if !is_name(name) {
        return Err(ErrorKind::InvalidName { name: name.to_owned() }.into());
    }
    if others.any(|own| own == name) {
        let kind = "body or obstacle";
        return Err(ErrorKind::DuplicateName { name: name.to_owned(), kind }.into());
    }
    Ok(())
}

/// Refuses obstacles without inside and faces without extent.
fn check_faces(obstacle: &Solid, axes: usize) -> Result<(), SceneError> {
    let mut sides: Vec<Side> =
        obstacle.faces.iter().map(|face| (face.normal.clone(), face.offset)).collect();
    let count = sides.len();
    sides.extend(geometry::frame(&sides, axes));
    let corners = geometry::corners(&sides, axes);
    let name = || obstacle.name.clone();
    let middle: Vec<f64> = (0..axes)
        .map(|i| corners.iter().map(|(x, _)| x[i]).sum::<f64>() / corners.len() as f64)
        .collect();
    let is_inside = |(n, b): &Side| dot(n, &middle) < b - INSIDE;
    if corners.is_empty() || !sides.iter().all(is_inside) {
        return Err(SceneError::Crossed { obstacle: name() });
    }
    for face in 0..count {
        let on = corners.iter().filter(|(_, sides)| sides.contains(&face));
        let on: Vec<&Vec<f64>> = on.map(|(x, _)| x).collect();
        if !geometry::spans(&on, axes) {
            return Err(SceneError::NoExtent { obstacle: name(), face });
        }
    }
    Ok(())
}

/// The normals along which two bodies hit.
fn default_normals(first: &Body, second: &Body) -> Vec<Vec<f64>> {
    let axes = first.axes();
    let round = |shape: &Shape| matches!(shape, Shape::Ball(_));
    if axes == 2 && (round(&first.shape) || round(&second.shape)) {
        let angle = |k: usize| std::f64::consts::TAU * k as f64 / NORMALS as f64;
        let tidy = |x: f64| if x.abs() < 1e-14 { 0.0 } else { x };
        return (0..NORMALS).map(|k| vec![tidy(angle(k).cos()), tidy(angle(k).sin())]).collect();
    }
    let along = |(i, sign): (usize, f64)| -> Vec<f64> {
        (0..axes).map(|j| if i == j { sign } else { 0.0 }).collect()
    };
    (0..axes).flat_map(|i| [(i, 1.0), (i, -1.0)]).map(along).collect()
}
