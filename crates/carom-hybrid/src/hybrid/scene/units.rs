//! The units in which a scene is computed: a power of two as the unit of length, another one as
//! that of time, and an origin among its bodies.
//!
//! Tolerances of contacts, rows and sets are absolute, and mean something for numbers of an
//! ordinary size. A scene of another size, or far from the origin of its map, is restated before
//! anything is computed; what is found is in the user's units again. Masses stay as they are.

use super::axes::AXES;
use super::body::{Body, Shape, Spin};
use super::rule::{DamageMeasure, DamageRule};
use super::solid::{Face, Solid};
use super::statement::Scene;
use crate::error::Error;
use crate::hybrid::contact::IMPACT_SPEED;
use crate::hybrid::system::{Coordinates, Measure, check_digits, power_of_two};
use crate::interval::Interval;
use crate::sum::Sum;

/// Ranges of accelerations for which the user's units are kept, by their width; 2^-14 and 2^20.
const ORDINARY_PUSH: [f64; 2] = [6.103515625e-5, 1048576.0];

/// Units of length and time, and an origin, in the user's units.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SceneUnits {
    origin: Vec<f64>,
    pub(super) length: f64,
    pub(super) time: f64,
}

impl SceneUnits {
    /// The user's own.
    pub(super) fn plain() -> Self {
        SceneUnits { origin: Vec::new(), length: 1.0, time: 1.0 }
    }

    /// The units of a scene, checked or not.
    pub(super) fn of(scene: &Scene) -> Self {
        let axes = scene.axes();
        let hull = |axis: usize| {
            let domains = scene.bodies.iter().filter_map(|body| body.domain.get(axis));
            domains.copied().reduce(|a, b| a.hull(b)).unwrap_or(Interval::point(0.0))
        };
        let hulls: Vec<Interval> = (0..axes).map(hull).collect();
        let speed = scene.bodies.iter().map(|body| 2.0 * body.max_speed).fold(0.0, f64::max);
        let push = |body: &Body| {
            let inputs = body.acceleration.iter().map(Interval::width);
            inputs.chain(body.gravity.iter().map(|g| g.abs())).fold(0.0, f64::max)
        };
        let push = scene.bodies.iter().map(push).fold(0.0, f64::max);
        let width = hulls.iter().map(Interval::width).fold(0.0, f64::max);
        if !hulls.iter().all(|hull| hull.is_bounded()) || !(width + speed + push).is_finite() {
            return SceneUnits::plain();
        }
        let length = Measure::of(Interval::new(0.0, width)).scale;
        let origin =
            hulls.iter().map(|hull| Measure::around(*hull, width, length).origin).collect();
        let is_ordinary = Measure::of(Interval::new(0.0, speed / length)).is_plain()
            && (push == 0.0 || (ORDINARY_PUSH[0]..=ORDINARY_PUSH[1]).contains(&(push / length)));
        let time = match (is_ordinary || speed == 0.0, push > 0.0) {
            (true, _) => 1.0,
            // In these units speeds and accelerations are of one size.
            (false, true) => power_of_two(speed / push),
            (false, false) => Measure::of(Interval::new(0.0, speed / length)).scale.recip(),
        };
        let own = SceneUnits { origin, length, time };
        if own.is_plain() { SceneUnits::plain() } else { own }
    }

    pub(super) fn is_plain(&self) -> bool {
        self.length == 1.0 && self.time == 1.0 && self.origin.iter().all(|at| *at == 0.0)
    }

    /// The units in which a scene that is stated in these is as the user stated it.
    pub(super) fn inverse(&self) -> Self {
        let origin = self.origin.iter().map(|at| 0.0 - at / self.length).collect();
        SceneUnits { origin, length: 1.0 / self.length, time: 1.0 / self.time }
    }

    pub(super) fn speed(&self) -> f64 {
        self.length / self.time
    }

    pub(super) fn acceleration(&self) -> f64 {
        self.length / self.time / self.time
    }

    pub(super) fn place(&self, axis: usize) -> Measure {
        Measure { origin: self.origin.get(axis).copied().unwrap_or(0.0), scale: self.length }
    }

    /// The unit of an effort, `Σ Δt |u|²`.
    pub(super) fn effort(&self) -> f64 {
        self.time * self.acceleration() * self.acceleration()
    }

    /// The unit of a measure of damage.
    pub(super) fn damage(&self, measure: &DamageMeasure) -> f64 {
        match measure {
            DamageMeasure::ImpactSpeed | DamageMeasure::NormalImpulse => self.speed(),
            DamageMeasure::DissipatedEnergy => self.speed() * self.speed(),
            DamageMeasure::Convex(_) => 1.0,
        }
    }

    /// The coordinates of a scene's system in these units.
    pub(super) fn coordinates(&self, scene: &Scene) -> Coordinates {
        if self.is_plain() {
            return Coordinates::default();
        }
        let (axes, spins) = (scene.axes(), scene.spins().count());
        let headings = scene.headings().count();
        let speed = Measure::unit(self.speed());
        let mut measures: Vec<Measure> = Vec::new();
        for _ in &scene.bodies {
            measures.extend((0..axes).map(|axis| self.place(axis)));
            measures.extend(vec![speed; axes]);
        }
        measures.extend(vec![Measure::unit(1.0 / self.time); spins]);
        measures.extend(vec![Measure::PLAIN; headings]);
        let states = measures.len();
        measures.extend(vec![Measure::unit(self.acceleration()); axes * scene.bodies.len()]);
        measures.extend(vec![Measure::unit(self.torque()); spins]);
        let outputs = vec![(IMPACT_SPEED.to_owned(), self.speed())];
        Coordinates { measures, states, outputs }
    }

    pub(super) fn torque(&self) -> f64 {
        self.speed() * self.speed()
    }

    /// A scene in these units.
    pub(super) fn scene(&self, stated: &Scene) -> Scene {
        let mut scene = stated.clone();
        scene.time_step /= self.time;
        scene.margin /= self.length;
        scene.bodies.iter_mut().for_each(|body| self.restate_body(body));
        for obstacle in &mut scene.obstacles {
            *obstacle = self.solid(obstacle);
        }
        scene.rules.iter_mut().for_each(|rule| self.restate_rule(rule));
        scene
    }

    fn restate_body(&self, body: &mut Body) {
        let (axes, speed, acceleration) = (body.axes(), self.speed(), self.acceleration());
        let over = |values: &mut dyn Iterator<Item = &mut f64>, unit: f64| {
            values.for_each(|value| *value /= unit);
        };
        let ranges = |ranges: &mut Vec<Interval>, unit: f64| {
            ranges.iter_mut().for_each(|own| *own = Measure::unit(unit).inward_range(*own));
        };
        if let Some((k, damping)) = &mut body.dynamics {
            let is_square = k.nrows() == axes && k.ncols() == axes;
            for (i, gravity) in body.gravity.iter_mut().enumerate().filter(|_| is_square) {
                let mut sum = Sum::new(*gravity);
                (0..axes).for_each(|j| sum.add_product(k[(i, j)], self.place(j).origin));
                *gravity = sum.value();
            }
            *k = &*k * faer::Scale(self.time * self.time);
            *damping = &*damping * faer::Scale(self.time);
        }
        for (axis, range) in body.domain.iter_mut().enumerate() {
            *range = self.place(axis).inward_range(*range);
        }
        body.max_speed /= speed;
        ranges(&mut body.acceleration, acceleration);
        ranges(&mut body.pushes, speed);
        over(&mut body.acceleration_ball.iter_mut(), acceleration);
        over(&mut body.gravity.iter_mut(), acceleration);
        over(&mut body.first.iter_mut().flatten(), acceleration);
        match &mut body.shape {
            Shape::Point => {}
            Shape::Ball(radius) => *radius /= self.length,
            Shape::Box(half) => over(&mut half.iter_mut(), self.length),
        }
        body.spin = body.spin.map(|spin| Spin {
            inertia: spin.inertia / (self.length * self.length),
            max_rate: spin.max_rate * self.time,
            max_torque: spin.max_torque / self.torque(),
        });
        if let Some(forces) = &mut body.forces {
            forces.restate((0..axes).map(|axis| self.place(axis)).collect(), speed);
        }
        let places = (0..axes).map(|axis| self.place(axis));
        let speeds = (0..axes).map(|_| Measure::unit(speed));
        let spin = Measure::unit(1.0 / self.time);
        let measures: Vec<Measure> = places.chain(speeds).chain([spin, Measure::PLAIN]).collect();
        let own = Coordinates { states: measures.len(), measures, outputs: Vec::new() };
        for region in body.start.iter_mut().chain(&mut body.goal) {
            *region = own.region(region);
        }
    }

    /// An obstacle in these units.
    pub(super) fn solid(&self, stated: &Solid) -> Solid {
        let mut solid = stated.clone();
        for Face { normal, offset, .. } in &mut solid.faces {
            let mut sum = Sum::new(*offset);
            for (axis, n) in normal.iter().enumerate() {
                sum.add_product(-n, self.place(axis).origin);
            }
            *offset = sum.value() / self.length;
        }
        solid.course.iter_mut().flatten().for_each(|by| *by /= self.length);
        solid
    }

    fn restate_rule(&self, rule: &mut DamageRule) {
        let unit = self.damage(&rule.measure);
        for limit in rule.per_hit.iter_mut().chain(&mut rule.total) {
            *limit /= unit;
        }
        rule.price *= unit;
        if let DamageMeasure::Convex(pieces) = &mut rule.measure {
            pieces.iter_mut().for_each(|(slope, _)| *slope *= self.speed());
        }
    }
}

impl Scene {
    /// Refuses scenes that contradict themselves; returns the scene with normals of length 1.
    pub(super) fn checked(&self) -> Result<Scene, Error> {
        let (scene, units) = self.in_units()?;
        Ok(if units.is_plain() { scene } else { units.inverse().scene(&scene) })
    }

    /// The checked scene in units of its own.
    pub(super) fn in_units(&self) -> Result<(Scene, SceneUnits), Error> {
        let units = SceneUnits::of(self);
        if units.is_plain() {
            return Ok((self.checked_as_stated()?, units));
        }
        for body in &self.bodies {
            for (axis, range) in AXES.iter().zip(&body.domain) {
                check_digits(&format!("{} {axis}", body.name), *range)?;
            }
        }
        match units.scene(self).checked_as_stated() {
            Ok(scene) => Ok((scene, units)),
            // Said in the user's units where it is wrong there too.
            Err(error) => self.checked_as_stated().and(Err(error)),
        }
    }
}
