//! Where a body is, at any time of its plan.

use crate::hybrid::scene::body::{Body, Shape};
use crate::hybrid::scene::geometry::length;
use crate::hybrid::scene::plan::{BodyPath, SceneHit, ScenePlan};
use crate::interval::Interval;
use crate::picture::{COLOURS, Mover, Outline};

/// How many pieces a parabola of a step is drawn by.
const PIECES: usize = 8;

/// The radius of a point that moves, in pixels.
const DOT: f64 = 7.0;

/// Where a body should end.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Goal {
    /// In one place, whatever its velocity is, or in a region that is no rectangle.
    Place,
    /// Within ranges along the axes, in m.
    Extended(Vec<Interval>),
}

/// A body in a plan.
#[derive(Debug, Clone, Copy)]
pub(super) struct Motion<'a> {
    pub(super) plan: &'a ScenePlan,
    pub(super) body: &'a Body,
    pub(super) path: &'a BodyPath,
}

impl<'a> Motion<'a> {
    /// Its hits, by time.
    pub(super) fn hits(&self) -> impl Iterator<Item = &'a SceneHit> {
        let name = &self.path.name;
        let axes = self.path.position[0].len();
        self.plan.hits.iter().filter(move |hit| hit.body == *name && hit.place.len() == axes)
    }

    /// Its goal, without what that says of velocities.
    pub(super) fn goal(&self) -> Option<Goal> {
        let region = self.body.goal.as_ref()?;
        let ranges: Vec<Interval> =
            region.ranges.iter().take(self.path.position[0].len()).copied().collect();
        let is_rectangle = region.halfspaces.is_empty() && region.norms.is_empty();
        let is_wide = ranges.iter().any(|range| range.lower < range.upper);
        let is_limited = ranges.iter().any(|range| range.width().is_finite());
        let is_drawn = is_rectangle && is_wide && is_limited;
        Some(if is_drawn { Goal::Extended(ranges) } else { Goal::Place })
    }

    /// The samples, hits, and the parabolas between them.
    pub(super) fn places(&self) -> Vec<(f64, Vec<f64>)> {
        let dt = self.plan.time_step;
        let mut places = vec![(0.0, self.path.position[0].clone())];
        for step in 0..self.plan.steps() {
            let time = step as f64 * dt;
            match self.struck(step) {
                Some((at, place)) => {
                    let at = at.clamp(time + 1e-6 * dt, time + dt - 1e-6 * dt);
                    places.push((at, place));
                }
                None => {
                    for k in 1..PIECES {
                        let part = k as f64 / PIECES as f64;
                        places.push((time + part * dt, self.parabola(step, part)));
                    }
                }
            }
            places.push((time + dt, self.path.position[step + 1].clone()));
        }
        places
    }

    /// When and where it hits something, or is hit, in a step.
    fn struck(&self, step: usize) -> Option<(f64, Vec<f64>)> {
        if let Some(hit) = self.hits().find(|hit| hit.step == step) {
            return Some((hit.time, hit.place.clone()));
        }
        let second = format!(" and {}", self.path.name);
        let hit = |hit: &&SceneHit| hit.step == step && hit.contact.ends_with(&second);
        let time = self.plan.hits.iter().find(hit)?.time;
        let passed = time - step as f64 * self.plan.time_step;
        let push = self.path.acceleration.get(step);
        let state = self.path.position[step].iter().zip(&self.path.velocity[step]).enumerate();
        let place = state.map(|(i, (x, v))| {
            let a = push.and_then(|push| push.get(i)).copied().unwrap_or(0.0);
            x + passed * (v + 0.5 * passed * a)
        });
        Some((time, place.collect()))
    }

    /// Part of the way through a step without a hit.
    fn parabola(&self, step: usize, part: f64) -> Vec<f64> {
        let (from, to, v) =
            (&self.path.position[step], &self.path.position[step + 1], &self.path.velocity[step]);
        let axis = |i: usize| {
            let middle = from[i] + 0.5 * self.plan.time_step * v[i];
            let (s, r) = (part, 1.0 - part);
            r * r * from[i] + 2.0 * r * s * middle + s * s * to[i]
        };
        (0..from.len()).map(axis).collect()
    }

    /// Where it is at a time, in m.
    pub(super) fn at(&self, time: f64) -> Vec<f64> {
        let places = self.places();
        let after = places.partition_point(|(own, _)| *own < time);
        let Some((end, to)) = places.get(after) else { return places[places.len() - 1].1.clone() };
        let Some((begin, from)) = after.checked_sub(1).map(|k| &places[k]) else {
            return to.clone();
        };
        let share = (time - begin) / (end - begin);
        from.iter().zip(to).map(|(a, b)| a + share * (b - a)).collect()
    }

    /// Its heading at a time, or by how much it has turned, in rad; `None` if it does not spin.
    pub(super) fn turned(&self, time: f64) -> Option<f64> {
        let dt = self.plan.time_step;
        let turn = |(step, rates): (usize, &[f64])| {
            let passed = (time - step as f64 * dt).clamp(0.0, dt);
            match self.struck(step) {
                Some((at, _)) => {
                    let before = passed.min(at - step as f64 * dt);
                    before * rates[0] + (passed - before) * rates[1]
                }
                None => passed * (rates[0] + 0.5 * passed / dt * (rates[1] - rates[0])),
            }
        };
        let steps = self.path.spin.windows(2).enumerate();
        let first = self.path.heading.first().copied().unwrap_or(0.0);
        (!self.path.spin.is_empty()).then(|| first + steps.map(turn).sum::<f64>())
    }

    /// Its speed at a sample, in m/s.
    pub(super) fn speed(&self, sample: usize) -> f64 {
        length(&self.path.velocity[sample])
    }

    /// It, moving in the plane.
    pub(super) fn mover(&self, colour: &str, period: f64) -> Mover {
        let outline = match &self.body.shape {
            Shape::Point => Outline::Dot(DOT),
            Shape::Ball(radius) => Outline::Disc(*radius),
            Shape::Box(half) => Outline::Polygon(rectangle(&[0.0; 2], half)),
        };
        let places = self.places().into_iter().map(|(time, x)| (time, [x[0], x[1]])).collect();
        Mover { colour: colour.to_owned(), outline, opacity: 0.9, places, period }
    }
}

/// The hand over the bars of a race.
pub(super) fn hand(end: f64, high: f64, period: f64) -> Mover {
    let places = vec![(0.0, [0.0, high]), (end, [end, high])];
    let colour = COLOURS[COLOURS.len() - 1].to_owned();
    Mover { colour, outline: Outline::Hand, opacity: 1.0, places, period }
}

/// The corners of a box.
pub(super) fn rectangle(at: &[f64], half: &[f64]) -> Vec<[f64; 2]> {
    let corner = |x: f64, y: f64| [at[0] + x * half[0], at[1] + y * half[1]];
    vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]
}
