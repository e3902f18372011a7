//! Checks of plans beside the laws of motion: rules about damage, limits of bodies, starts and
//! goals.

use super::world::Touch;
use super::{MISS, Played};
use crate::error::SceneError;
use crate::hybrid::damage::ImpactEstimate;
use crate::hybrid::scene::geometry::{dot, length};
use crate::hybrid::scene::handles::BodyHandle;
use crate::hybrid::scene::place::Where;
use crate::hybrid::scene::rule::{DamageMeasure, DamageRule};
use crate::tolerance::margin_scale;

/// A hit that a rule counts.
struct Counted {
    step: usize,
    touch: Touch,
    face: usize,
    /// Its damage in the measure's unit, for an impact that is slower by what a plan may miss.
    damage: f64,
}

impl Played<'_> {
    /// Refuses plans that break a rule. Hits must be complete.
    pub(super) fn rules(&self) -> Result<(), SceneError> {
        self.world.scene.rules.iter().try_for_each(|rule| self.rule(rule))
    }

    fn rule(&self, rule: &DamageRule) -> Result<(), SceneError> {
        let counted = self.counted(rule);
        for hit in &counted {
            if let Some(most) = rule.per_hit {
                let what = format!("a hit exceeds the rule `{}`", rule.name);
                self.refuse(hit.step, &what, hit.damage - most, MISS)?;
            }
            if let Some(angle) = rule.incidence {
                let what = format!("a hit is more slanted than the rule `{}` allows", rule.name);
                self.refuse(hit.step, &what, self.slant(hit, angle), MISS)?;
            }
        }
        let steps = self.inputs.len();
        let window = rule.window.unwrap_or(steps).min(steps);
        for first in 0..=steps - window {
            let inside = |hit: &&Counted| (first..first + window).contains(&hit.step);
            let own = || counted.iter().filter(inside);
            if let Some(most) = rule.total {
                let sum: f64 = own().map(|hit| hit.damage).sum();
                let what = format!("the sum from here on exceeds the rule `{}`", rule.name);
                self.refuse(first, &what, sum - most, MISS)?;
            }
            if let Some(most) = rule.count {
                let more = own().count() as f64 - most as f64;
                let what = format!("there are more hits than the rule `{}` allows", rule.name);
                self.refuse(first, &what, more, 0.0)?;
            }
        }
        Ok(())
    }

    fn counted(&self, rule: &DamageRule) -> Vec<Counted> {
        let mut all = Vec::new();
        for step in 0..self.inputs.len() {
            for (touch, face, number) in self.claimed(step) {
                let shares = self.world.shares(touch);
                let Where { bodies, obstacle, face: own_face } = &rule.place;
                let involves =
                    |own: &BodyHandle| shares.iter().any(|(body, _)| *body == own.number);
                let is_of_bodies = bodies.iter().flatten().all(involves);
                let is_there = obstacle.is_none_or(|own| match touch {
                    Touch::Obstacle(_, obstacle) => obstacle == own.number,
                    Touch::Pair(_) => false,
                });
                if is_of_bodies && is_there && own_face.is_none_or(|own| own == face) {
                    let speed = self.hits[number].damage;
                    let speed = (speed - MISS * margin_scale(speed, 0.0)).max(0.0);
                    let damage = self.measured(rule, touch, face, speed);
                    all.push(Counted { step, touch, face, damage });
                }
            }
        }
        all
    }

    /// The damage of a hit with an impact speed (m/s), in the rule's unit.
    fn measured(&self, rule: &DamageRule, touch: Touch, face: usize, speed: f64) -> f64 {
        let e = self.world.surface(touch, face).restitution.map_or(0.0, |e| e.value());
        let mass = self.world.mass(touch);
        match &rule.measure {
            DamageMeasure::ImpactSpeed => speed,
            DamageMeasure::NormalImpulse => (1.0 + e) * mass * speed,
            DamageMeasure::DissipatedEnergy => 0.5 * (1.0 - e * e) * mass * speed.powi(2),
            DamageMeasure::Convex(pieces) => {
                let values = pieces.iter().map(|(slope, constant)| slope * speed + constant);
                values.fold(0.0, f64::max)
            }
        }
    }

    /// By how much the sliding speed of a hit exceeds what an angle of incidence (rad) allows, in
    /// m/s: at the end of its step, and at the start if that counts.
    fn slant(&self, hit: &Counted, angle: f64) -> f64 {
        let world = &self.world;
        let n = world.normal(hit.touch, hit.face);
        if n.len() == 1 {
            // On a line every approach is along the normal.
            return 0.0;
        }
        let start = &self.samples[hit.step];
        let end = world.fly(start, &self.inputs[hit.step], world.scene.time_step);
        let excess = |v: &[Vec<f64>]| {
            let r = world.relative(hit.touch, v, hit.step);
            let normal = dot(n, &r);
            let along: Vec<f64> = r.iter().zip(n).map(|(r, n)| r - normal * n).collect();
            let scale = margin_scale(length(&r), 0.0);
            (length(&along) * angle.cos() + normal * angle.sin()) / scale
        };
        match world.scene.estimate {
            ImpactEstimate::Sound => excess(&start.v).max(excess(&end.v)),
            ImpactEstimate::EndOfStep => excess(&end.v),
        }
    }

    /// Refuses plans that leave the limits of a body, or start or end elsewhere.
    pub(super) fn limits(&self) -> Result<(), SceneError> {
        for (b, body) in self.world.scene.bodies.iter().enumerate() {
            let name = &body.name;
            for (t, sample) in self.samples.iter().enumerate() {
                for (i, range) in body.domain.iter().enumerate() {
                    let excess = beyond(sample.x[b][i], range.lower, range.upper);
                    self.refuse(t, &format!("{name}: leaves its domain (m)"), excess, MISS)?;
                    let excess = beyond(sample.v[b][i], -body.max_speed, body.max_speed);
                    self.refuse(t, &format!("{name}: is too fast (m/s)"), excess, MISS)?;
                }
                if let Some(spin) = &body.spin {
                    let excess = beyond(sample.w[b], -spin.max_rate, spin.max_rate);
                    self.refuse(t, &format!("{name}: spins too fast (rad/s)"), excess, MISS)?;
                }
                if let Some(range) = body.heading {
                    let excess = beyond(sample.heading[b], range.lower, range.upper);
                    self.refuse(t, &format!("{name}: turns too far (rad)"), excess, MISS)?;
                }
                if body.is_speed_ball {
                    let excess = beyond(length(&sample.v[b]), 0.0, body.max_speed);
                    self.refuse(t, &format!("{name}: is too fast (m/s)"), excess, MISS)?;
                }
            }
            for (t, input) in self.stated.iter().enumerate() {
                for (i, range) in body.acceleration.iter().enumerate() {
                    let (mut lower, mut upper) = (range.lower, range.upper);
                    if let (0, Some(first)) = (t, &body.first) {
                        (lower, upper) = (first[i], first[i]);
                    }
                    let excess = beyond(input[b][i], lower, upper);
                    let what = format!("{name}: pushes beyond its range (m/s²)");
                    self.refuse(t, &what, excess, MISS)?;
                }
                if let (Some(spin), Some(torque)) = (&body.spin, input[b].get(body.axes())) {
                    let excess = beyond(*torque, -spin.max_torque, spin.max_torque);
                    let what = format!("{name}: turns beyond its range (N m)");
                    self.refuse(t, &what, excess, MISS)?;
                }
                if let Some(most) = body.acceleration_ball {
                    let excess = beyond(length(&input[b][..body.axes()]), 0.0, most);
                    let what = format!("{name}: pushes beyond its largest acceleration (m/s²)");
                    self.refuse(t, &what, excess, MISS)?;
                }
            }
        }
        self.ends()
    }

    /// Refuses plans that start or end elsewhere.
    pub(super) fn ends(&self) -> Result<(), SceneError> {
        let last = self.samples.len() - 1;
        for (b, body) in self.world.scene.bodies.iter().enumerate() {
            let name = &body.name;
            for (end, t, region) in [("start", 0, &body.start), ("goal", last, &body.goal)] {
                let Some(region) = region else { continue };
                let sample = &self.samples[t];
                let spin = body.spin.map(|_| sample.w[b]);
                let turned = body.heading.map(|_| sample.heading[b]);
                let state: Vec<f64> = sample.x[b]
                    .iter()
                    .chain(&sample.v[b])
                    .copied()
                    .chain(spin)
                    .chain(turned)
                    .collect();
                let ranges = region.ranges.iter().zip(&state);
                let misses = ranges.map(|(range, &x)| beyond(x, range.lower, range.upper));
                let sides = region.halfspaces.iter().map(|side| {
                    let terms = || side.normal.iter().zip(&state).map(|(n, x)| n * x);
                    let size = terms().map(f64::abs).fold(0.0, f64::max);
                    let limit = side.limit_at(0);
                    (terms().sum::<f64>() - limit) / margin_scale(size, limit)
                });
                let discs = region.norms.iter().map(|disc| {
                    let (slack, size) = (disc.slack(&state, 0), disc.size(&state, 0));
                    -slack / margin_scale(size, 0.0)
                });
                let excess = misses.chain(sides).chain(discs).fold(f64::NEG_INFINITY, f64::max);
                self.refuse(t, &format!("{name}: misses its {end} (m, m/s, rad/s)"), excess, MISS)?;
            }
        }
        Ok(())
    }
}

/// By how much a value is outside a range, relative to its size.
fn beyond(value: f64, lower: f64, upper: f64) -> f64 {
    (lower - value).max(value - upper) / margin_scale(value.abs(), 0.0)
}
