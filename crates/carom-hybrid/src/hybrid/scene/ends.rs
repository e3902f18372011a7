//! Checks that refuse starts and goals: wrong lengths, states beyond the limits of their body,
//! places inside something.

use super::axes::AXES;
use super::body::Body;
use super::contact::{ContactFace, ContactPair, contacts};
use super::geometry::{length, minus};
use super::statement::{INSIDE, Scene};
use crate::activity::term_ends;
use crate::error::{Error, SceneError};
use crate::hybrid::system::{Region, check_cut, check_ends};
use crate::interval::Interval;
use crate::tolerance::{FEASIBILITY, margin_scale};

impl Body {
    /// Refuses a start or a goal that does not fit the body or that its limits exclude.
    pub(super) fn check_regions(&self) -> Result<(), Error> {
        for (word, end, region) in [("start", "starts", &self.start), ("goal", "ends", &self.goal)]
        {
            let Some(region) = region else { continue };
            self.check_region(word, region)?;
            self.check_limits(end, region)?;
        }
        Ok(())
    }

    fn check_region(&self, word: &str, region: &Region) -> Result<(), Error> {
        let mut expected = 2 * self.axes();
        let found = region.ranges.len();
        // A goal need not say anything about a spin and a heading.
        for has_one in [self.spin.is_some(), self.heading.is_some()] {
            if has_one && (word == "start" || found > expected) {
                expected += 1;
            }
        }
        if found != expected {
            let name = format!("the {word} of {}", self.name);
            return Err(SceneError::Axes { name, found, expected }.into());
        }
        for side in &region.halfspaces {
            let found = side.normal.len();
            if found != expected {
                let name = format!("the half-space {} of the {word} of {}", side.name, self.name);
                return Err(SceneError::Axes { name, found, expected }.into());
            }
            check_cut(side, expected)?;
        }
        for disc in &region.norms {
            let found = disc.bound.factors.len();
            if found != expected {
                let name = format!("the disc {} of the {word} of {}", disc.name, self.name);
                return Err(SceneError::Axes { name, found, expected }.into());
            }
        }
        let finite = |range: &&Interval| range.lower.is_finite() && range.upper.is_finite();
        region.ranges.iter().filter(finite).try_for_each(|range| check_ends(&self.name, *range))
    }

    /// The start or goal has states within the domain and the largest speed.
    fn check_limits(&self, end: &'static str, region: &Region) -> Result<(), SceneError> {
        let axes = self.axes();
        let body = || self.name.clone();
        let speed = Interval::new(-self.max_speed, self.max_speed);
        let mut left = Vec::new();
        let spin = self.spin.map_or(Interval::REALS, |spin| spin.rates());
        let heading = self.heading.unwrap_or(Interval::REALS);
        for (i, &range) in region.ranges.iter().enumerate() {
            let axis = AXES[i % axes];
            let (what, allowed, words, unit) = match i / axes {
                0 => (axis.to_owned(), self.domain[i], "domain", "m"),
                1 => (format!("v{axis}"), speed, "largest speed", "m/s"),
                _ if i == 2 * axes => ("spin".to_owned(), spin, "largest spin", "rad/s"),
                _ => ("heading".to_owned(), heading, "range", "rad"),
            };
            let both = range.intersection(allowed);
            let miss = FEASIBILITY * margin_scale(allowed.magnitude(), 0.0);
            if both.lower - both.upper > miss {
                let limit = format!("{words}, {} to {} {unit}", allowed.lower, allowed.upper);
                let Interval { lower, upper } = range;
                return Err(SceneError::Limits { body: body(), end, what, lower, upper, limit });
            }
            left.push(if both.is_empty() { Interval::point(both.lower) } else { both });
        }
        let polygon = region.polyhedral();
        if self.is_speed_ball {
            // The slowest state of the box.
            let slowest: Vec<f64> =
                left[axes..2 * axes].iter().map(|range| range.nearest(0.0)).collect();
            let nearest = length(&slowest);
            let limit = self.max_speed;
            if nearest - limit > FEASIBILITY * margin_scale(nearest, limit) {
                let what = "the speed".to_owned();
                let (lower, upper) = (nearest, nearest);
                let limit = format!("largest speed, 0 to {limit} m/s");
                return Err(SceneError::Limits { body: body(), end, what, lower, upper, limit });
            }
        }
        for side in &polygon.halfspaces {
            let back = minus(&side.normal);
            // Not -0.
            let (nearest, limit) = (0.0 - farthest(&left, &back), side.limit_at(0));
            if nearest - limit > FEASIBILITY * margin_scale(nearest.abs(), limit) {
                let halfspace = side.name.clone();
                return Err(SceneError::Cut { body: body(), end, halfspace, nearest, limit });
            }
        }
        Ok(())
    }
}

impl Scene {
    /// The largest `direction . x` of a contact, over the boxes of a region of its body and of the
    /// other body.
    fn farthest(
        &self,
        contact: &ContactPair,
        direction: &[f64],
        own: &Option<Region>,
        its: Option<&Option<Region>>,
    ) -> f64 {
        let of = |body: usize, region: &Option<Region>, direction: &[f64]| match region {
            Some(region) => farthest(&region.ranges, direction),
            None => farthest(&self.bodies[body].domain, direction),
        };
        let back = minus(direction);
        let other = contact.other.zip(its).map_or(0.0, |(body, its)| of(body, its, &back));
        of(contact.body, own, direction) + other
    }

    /// The least `normal . x` at which a contact may start.
    pub(super) fn nearest_start(&self, contact: &ContactPair, face: &ContactFace) -> f64 {
        let back = minus(&face.normal);
        let own = &self.bodies[contact.body].start;
        let its = contact.other.map(|b| &self.bodies[b].start);
        -self.farthest(contact, &back, own, its)
    }

    /// Refuses bodies that start or end inside something.
    pub(super) fn check_ends(&self) -> Result<(), Error> {
        for contact in contacts(self) {
            let (body, other) =
                (&self.bodies[contact.body], contact.other.map(|b| &self.bodies[b]));
            let ends = [
                ("starts", &body.start, other.map(|o| &o.start)),
                ("ends", &body.goal, other.map(|o| &o.goal)),
            ];
            for (end, own, its) in ends {
                if end == "ends" && !contact.velocity.is_empty() {
                    continue;
                }
                if own.is_none() || its == Some(&None) {
                    continue;
                }
                let inside = |face: &ContactFace| {
                    let most = self.farthest(&contact, &face.normal, own, its);
                    most < face.limit_at(0) - INSIDE
                };
                if contact.faces.iter().all(inside) {
                    let obstacle = match (contact.obstacle, other) {
                        (Some(o), _) => self.obstacles[o].name.clone(),
                        (None, other) => other.map_or(String::new(), |other| other.name.clone()),
                    };
                    let body = body.name.clone();
                    return Err(SceneError::Inside { body, end, obstacle }.into());
                }
            }
        }
        Ok(())
    }
}

/// The largest `direction . x` over a box.
fn farthest(ranges: &[Interval], direction: &[f64]) -> f64 {
    let ends = direction.iter().zip(ranges).map(|(n, range)| match *n {
        0.0 => 0.0,
        n => term_ends(n, [range.lower, range.upper])[1],
    });
    ends.sum()
}
