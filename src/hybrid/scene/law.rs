//! The ways in which a step may pass a contact, as transitions of a hybrid system.
//!
//! With the prediction of free flight, let `g` be the gap to a face with the normal n, and `r` the
//! velocity relative to the face. A hit needs `g <= 0` and `n . r <= 0`, and then
//! `x⁺ = x - n (1+e) g` and `v⁺ = v + (M - 1) r`, where M is the surface's law; in a hit of two
//! bodies, each takes its share.

use std::f64::consts::{PI, TAU};

use faer::Mat;

use super::contact::{ContactFace, ContactPair, Mode, at};
use super::geometry::{dot, tangents};
use super::statement::Scene;
use super::surface::Tangential;
use crate::error::Error;
use crate::hybrid::contact::IMPACT_SPEED;
use crate::hybrid::damage::ImpactEstimate;
use crate::hybrid::linear::LinearSystem;
use crate::hybrid::system::{
    Halfspace, NormEntry, NormLimit, Reset, Schedule, Transition, Uncertain,
};
use crate::interval::Interval;

/// A linear function of the relative velocity that must be at most 0: its factors, and a name.
#[derive(Clone)]
pub(super) struct Guard {
    pub(super) name: &'static str,
    pub(super) factors: Vec<f64>,
    /// The same of the relative velocity at the start of the step; 0 in mirrored hits.
    pub(super) at_start: Vec<f64>,
}

/// A law of a hit: the change `(M - 1) r` of the relative velocity r, and when it applies.
#[derive(Clone)]
pub(super) struct Law {
    pub(super) name: String,
    /// M - 1 without a rebound, by rows.
    pub(super) change: Vec<Vec<f64>>,
    /// The part that the rebound adds to it: `-e n n'`.
    pub(super) rebound: Vec<Vec<f64>>,
    /// The factors of the relative velocity at the start of the step in the change; 0 in mirrored hits.
    pub(super) at_start: Vec<Vec<f64>>,
    pub(super) guards: Vec<Guard>,
    /// Functions of which the length of the first ones is at most the last one; empty if there is no cone.
    pub(super) cone: Vec<Guard>,
}

/// Writes the transitions of one contact.
pub(super) struct Writer<'a> {
    pub(super) scene: &'a Scene,
    pub(super) contact: &'a ContactPair,
    pub(super) flow: &'a LinearSystem,
}

/// Values at the samples that begin steps.
pub(super) fn at_start(values: &[f64]) -> Schedule<f64> {
    match values.len() {
        0 | 1 => at(values, 0).into(),
        n => values[..n - 1].to_vec().into(),
    }
}

/// Values at the samples that end steps.
pub(super) fn at_end(values: &[f64]) -> Schedule<f64> {
    match values.len() {
        0 | 1 => at(values, 0).into(),
        _ => values[1..].to_vec().into(),
    }
}

impl Writer<'_> {
    pub(super) fn axes(&self) -> usize {
        self.scene.axes()
    }

    /// `direction . x`, of the body or relative to the other body, as factors of all states.
    pub(super) fn position(&self, direction: &[f64]) -> Vec<f64> {
        self.spread(direction, 0)
    }

    /// `direction . v`, likewise.
    pub(super) fn velocity(&self, direction: &[f64]) -> Vec<f64> {
        self.spread(direction, self.axes())
    }

    fn spread(&self, direction: &[f64], from: usize) -> Vec<f64> {
        let mut factors = vec![0.0; self.flow.states()];
        let block = 2 * self.axes();
        for (i, n) in direction.iter().enumerate() {
            factors[block * self.contact.body + from + i] += n;
            if let Some(other) = self.contact.other {
                factors[block * other + from + i] -= n;
            }
        }
        factors
    }

    /// `direction` times the velocity of the surface, by step.
    pub(super) fn speed(&self, direction: &[f64]) -> Schedule<f64> {
        match self.contact.velocity.is_empty() {
            true => 0.0.into(),
            false => {
                let speeds = self.contact.velocity.iter().map(|v| dot(direction, v));
                speeds.collect::<Vec<f64>>().into()
            }
        }
    }

    /// All transitions, and what they are.
    pub(super) fn transitions(&self) -> Result<(Vec<Transition>, Vec<Mode>), Error> {
        let (mut transitions, mut modes) = (Vec::new(), Vec::new());
        for face in 0..self.contact.faces.len() {
            transitions.push(self.flight(face));
            let name = transitions[transitions.len() - 1].name.clone();
            modes.push(Mode { name, face, is_hit: false });
        }
        for (face, own) in self.contact.faces.iter().enumerate() {
            let Some(restitution) = own.surface.restitution else { continue };
            if own.surface.rests {
                for (transition, is_hit) in self.resting(face, restitution.value())? {
                    modes.push(Mode { name: transition.name.clone(), face, is_hit });
                    transitions.push(transition);
                }
                continue;
            }
            let e = restitution.value();
            for law in laws(own, e, 0.0) {
                let mut hit = self.hit(face, &law);
                for guard in &law.guards {
                    hit = hit.with_prediction_guard(self.guard(guard));
                }
                let cone = law.cone.iter().map(|part| self.guard(part));
                hit.prediction_norms.extend(norm_of(cone));
                let (matrix, offset) = self.reset(own, e, &law);
                let mut transition = hit.with_reset_by_step(matrix, offset);
                transition.uncertain.extend(self.uncertain(own, &law));
                modes.push(Mode { name: transition.name.clone(), face, is_hit: true });
                transitions.push(transition);
            }
        }
        Ok((transitions, modes))
    }

    pub(super) fn is_convex(&self) -> bool {
        self.contact.faces.len() > 1
    }

    pub(super) fn name(&self, word: &str, face: usize) -> String {
        if self.is_convex() { format!("{word} {face}") } else { word.to_owned() }
    }

    /// The step stays in front of a face.
    fn flight(&self, face: usize) -> Transition {
        let own = &self.contact.faces[face];
        let back: Vec<f64> = own.normal.iter().map(|n| -n).collect();
        let minus = |values: &[f64]| values.iter().map(|b| -b).collect::<Vec<f64>>();
        let word = if self.is_convex() { "beyond" } else { "clear" };
        let mut flight = Transition::new(self.name(word, face), self.flow.clone());
        let limits = minus(&own.limit);
        if self.scene.estimate == ImpactEstimate::Sound {
            if self.is_convex() {
                let starts =
                    Halfspace::new("starts in front", self.position(&back), at_start(&limits));
                flight = flight.with_guard(starts);
            }
            flight = flight.with_guard(self.no_dip(own));
        }
        let margin = if own.surface.restitution.is_some() { self.scene.margin } else { 0.0 };
        let limits: Vec<f64> = limits.iter().map(|limit| limit - margin).collect();
        let ends = Halfspace::new("ends in front", self.position(&back), at_end(&limits));
        flight.with_prediction_guard(ends)
    }

    /// The middle control point of the step's parabola is in front of a face, so that the whole step
    /// is if both ends are: `g + Δt/2 s >= J Δt³/12`, where J bounds the third derivative of g.
    fn no_dip(&self, face: &ContactFace) -> Halfspace {
        let back: Vec<f64> = face.normal.iter().map(|n| -n).collect();
        let limits: Vec<f64> = face.limit.iter().map(|b| -b).collect();
        self.middle("no dip".into(), &back, &limits)
    }

    /// `direction . c <= limit` at the middle control point `c = x + Δt/2 v` of the step's parabola,
    /// in the middle between the limits at both ends.
    pub(super) fn middle(&self, name: String, direction: &[f64], limits: &[f64]) -> Halfspace {
        let dt = self.scene.time_step;
        let mut factors = self.position(direction);
        let rates = self.velocity(direction);
        factors.iter_mut().zip(rates).for_each(|(x, v)| *x += 0.5 * dt * v);
        let margin = self.jerk(direction) * dt * dt * dt / 12.0;
        let steps = limits.len().saturating_sub(1).max(1);
        let limit = |t: usize| 0.5 * (at(limits, t) + at(limits, t + 1)) - margin;
        Halfspace::new(name, factors, (0..steps).map(limit).collect::<Vec<f64>>())
    }

    /// The largest rate of change of the relative acceleration in a direction, in m/s³.
    pub(super) fn jerk(&self, direction: &[f64]) -> f64 {
        let bodies = [Some(self.contact.body), self.contact.other];
        let of = |b: usize| self.scene.bodies[b].largest_jerk(direction, self.scene.time_step);
        bodies.into_iter().flatten().map(of).sum()
    }

    /// A guard of a law, of the velocities at the end of free flight.
    pub(super) fn guard(&self, guard: &Guard) -> Halfspace {
        let limit = self.speed(&guard.factors);
        Halfspace::new(guard.name, self.velocity(&guard.factors), limit)
    }

    /// The step hits a face: everything but the guards of its law and what it does.
    pub(super) fn hit(&self, face: usize, law: &Law) -> Transition {
        let own = &self.contact.faces[face];
        let mut hit = Transition::event(self.name(&law.name, face), self.flow.clone());
        hit = self.entering(hit, own);
        let behind: Vec<f64> = own.limit.iter().map(|limit| limit - self.scene.margin).collect();
        let ends = Halfspace::new("ends behind", self.position(&own.normal), at_end(&behind));
        hit = hit.with_prediction_guard(ends);
        let towards = self.velocity(&own.normal);
        let moves = Halfspace::new("moves towards it", towards.clone(), self.speed(&own.normal));
        hit = self.limited(hit.with_prediction_guard(moves), face);
        let away: Vec<f64> = towards.iter().map(|n| -n).collect();
        hit.with_output(IMPACT_SPEED, away, self.speed(&own.normal))
    }

    /// The limits of the rules on a single hit.
    fn limited(&self, mut hit: Transition, face: usize) -> Transition {
        let own = &self.contact.faces[face];
        let back: Vec<f64> = own.normal.iter().map(|n| -n).collect();
        let dt = self.scene.time_step;
        let is_sound = self.scene.estimate == ImpactEstimate::Sound;
        for rule in &self.scene.rules {
            if !rule.applies(self.contact, face) {
                continue;
            }
            if let Some(most) = rule.most_speed(self.contact, face) {
                let margin = if is_sound { sound_margin(own, dt) } else { 0.0 };
                let most = most - margin;
                let limit = |most: f64| self.speed(&back).map(|s| most + s);
                let when = if is_sound { " at the end" } else { "" };
                let name = format!("{}{when}", rule.name);
                let end = Halfspace::limit(name, self.velocity(&back), limit(most));
                hit = hit.with_prediction_guard(end);
                if is_sound {
                    let name = format!("{} at the start", rule.name);
                    let start = Halfspace::limit(name, self.velocity(&back), limit(most));
                    hit = hit.with_guard(start);
                }
            }
            if let (Some(slope), 3) = (rule.incidence_slope(self.axes()), self.axes()) {
                let at_end = self.incidence(&own.normal, slope, is_sound, &rule.name);
                let at_start = at_end.clone().map(|limit| NormLimit {
                    name: format!("{} incidence at the start", rule.name),
                    ..limit
                });
                // Directions within the limit are a cone, so that all in between are.
                hit.norms.extend(at_start.filter(|_| is_sound));
                hit.prediction_norms.extend(at_end);
            } else if let Some(slope) = rule.incidence_slope(self.axes()) {
                for (k, tangent) in around(&own.normal, 2).enumerate() {
                    // d . r + slope n . r <= 0.
                    let factors: Vec<f64> =
                        tangent.iter().zip(&own.normal).map(|(d, n)| d + slope * n).collect();
                    let margin = if is_sound { self.jerk(&factors) * dt * dt / 8.0 } else { 0.0 };
                    let limit = || self.speed(&factors).map(|s| s - margin);
                    let name = format!("{} incidence {k}", rule.name);
                    let guard = Halfspace::limit(name, self.velocity(&factors), limit());
                    hit = hit.with_prediction_guard(guard);
                    if is_sound {
                        // Directions within the limit are a cone, so that all in between are.
                        let name = format!("{} incidence {k} at the start", rule.name);
                        let start = Halfspace::limit(name, self.velocity(&factors), limit());
                        hit = hit.with_guard(start);
                    }
                }
            }
        }
        hit
    }

    /// The approach is within a cone around the normal, in space.
    fn incidence(
        &self,
        normal: &[f64],
        slope: f64,
        is_sound: bool,
        rule: &str,
    ) -> Option<NormLimit> {
        let dt = self.scene.time_step;
        let tangents = tangents(normal);
        let along = tangents.iter().map(|t| self.jerk(t)).fold(0.0_f64, f64::hypot);
        let most = along + slope * self.jerk(normal);
        let margin = if is_sound { most * dt * dt / 8.0 } else { 0.0 };
        let part = |factors: &[f64], margin: f64| {
            let limit = self.speed(factors).map(|s| s + margin);
            Halfspace::new(format!("{rule} incidence"), self.velocity(factors), limit)
        };
        let back: Vec<f64> = normal.iter().map(|n| -slope * n).collect();
        let parts = tangents.iter().map(|t| part(t, 0.0)).chain([part(&back, margin)]);
        norm_of(parts).map(|limit| NormLimit { is_limit: true, ..limit })
    }

    /// What the spread of the restitution adds to the reset of a hit, which is affine in it: what e = 1 adds
    /// to e = 0.
    fn uncertain(&self, face: &ContactFace, law: &Law) -> Option<Uncertain> {
        let spread = face.surface.spread;
        let rebound = |e: f64| Law { rebound: rebound(&face.normal, e), ..law.clone() };
        let (one, offset) = self.reset(face, 1.0, &rebound(1.0));
        let (none, offset_of_none) = self.reset(face, 0.0, &rebound(0.0));
        let last = offset.settles().max(offset_of_none.settles());
        let at = |step: usize| -> Vec<f64> {
            let both = offset.get(step).into_iter().flatten();
            let both = both.zip(offset_of_none.get(step).into_iter().flatten());
            both.map(|(one, none)| one - none).collect()
        };
        let effect =
            Reset { matrix: one - none, offset: (0..=last).map(at).collect::<Vec<_>>().into() };
        let range = Interval::new(-spread, spread);
        (spread > 0.0).then_some(Uncertain { range, effect })
    }

    /// The reset of a hit: a matrix and an offset by step. The position moves by the gap times
    /// `1 + e`.
    pub(super) fn reset(
        &self,
        face: &ContactFace,
        e: f64,
        law: &Law,
    ) -> (Mat<f64>, Schedule<Vec<f64>>) {
        let (axes, width) = (self.axes(), self.flow.states());
        let n = &face.normal;
        let mut matrix = Mat::<f64>::identity(width, width);
        let steps = face.limit.len().saturating_sub(1).max(1);
        let mut offsets = vec![vec![0.0; width]; steps];
        let gap = self.position(n);
        let parts = [
            (Some(self.contact.body), self.contact.share),
            (self.contact.other, self.contact.share - 1.0),
        ];
        for (body, share) in parts {
            let Some(body) = body else { continue };
            let first = 2 * axes * body;
            for i in 0..axes {
                // One after the other, so that 1 - (1 + e) is exactly -e along the normal.
                for lift in [-share * n[i], -share * e * n[i]] {
                    for (j, g) in gap.iter().enumerate() {
                        matrix[(first + i, j)] += lift * g;
                    }
                }
                for change in [&law.change[i], &law.rebound[i]] {
                    for (j, c) in self.velocity(change).iter().enumerate() {
                        matrix[(first + axes + i, j)] += share * c;
                    }
                }
                let lift = -share * (1.0 + e) * n[i];
                for (t, offset) in offsets.iter_mut().enumerate() {
                    offset[first + i] -= lift * at(&face.limit, t + 1);
                    let surface = self.contact.velocity_in(t, axes);
                    let rows = [&law.change[i], &law.rebound[i], &law.at_start[i]];
                    let moved: f64 = rows.iter().map(|row| dot(row, &surface)).sum();
                    offset[first + axes + i] -= share * moved;
                }
            }
        }
        // Not -0.
        offsets.iter_mut().flatten().for_each(|r| *r += 0.0);
        (matrix, offsets.into())
    }
}

/// The norm limit of half-spaces: the length of the excesses of the first ones is at most that of the last.
pub(super) fn norm_of(parts: impl Iterator<Item = Halfspace>) -> Option<NormLimit> {
    let mut name = String::new();
    let part = |part: Halfspace| {
        name = part.name;
        NormEntry { factors: part.normal, constant: part.limit.map(|limit| 0.0 - limit) }
    };
    let mut entries: Vec<NormEntry> = parts.map(part).collect();
    let bound = entries.pop()?;
    Some(NormLimit { name, entries, bound, is_limit: false })
}

/// By how much the approach within a step may exceed that at its ends, in m/s: `J Δt²/8`.
pub(super) fn sound_margin(face: &ContactFace, time_step: f64) -> f64 {
    face.jerk * time_step * time_step / 8.0
}

/// Directions along a face: both in the plane, `count` in space, none on a line.
fn around(normal: &[f64], count: usize) -> impl Iterator<Item = Vec<f64>> {
    let tangents = tangents(normal);
    let all: Vec<Vec<f64>> = match &tangents[..] {
        [one] => vec![one.clone(), one.iter().map(|t| -t).collect()],
        [one, two] => (0..count)
            .map(|k| {
                let (sin, cos) = (TAU * k as f64 / count as f64).sin_cos();
                one.iter().zip(two).map(|(a, b)| cos * a + sin * b).collect()
            })
            .collect(),
        _ => Vec::new(),
    };
    all.into_iter()
}

/// `-factor n n'`, as rows.
fn rebound(n: &[f64], factor: f64) -> Vec<Vec<f64>> {
    n.iter().map(|a| n.iter().map(|b| -factor * a * b).collect()).collect()
}

/// Adds `factor a b'`.
fn add(change: &mut [Vec<f64>], factor: f64, a: &[f64], b: &[f64]) {
    for (row, a) in change.iter_mut().zip(a) {
        row.iter_mut().zip(b).for_each(|(c, b)| *c += factor * a * b);
    }
}

/// The laws of a face: one, or those of sticking and slipping. The velocity along the normal changes
/// by `1 + e` times the approach at the end of the step and `start` times that at its start.
pub(super) fn laws(face: &ContactFace, e: f64, start: f64) -> Vec<Law> {
    let (n, end) = (&face.normal, 1.0 + e);
    let plain = || Law {
        name: "hit".into(),
        change: rebound(n, 1.0),
        rebound: rebound(n, e),
        at_start: rebound(n, start),
        guards: Vec::new(),
        cone: Vec::new(),
    };
    let tangents = tangents(n);
    match face.surface.tangential {
        _ if tangents.is_empty() || face.surface.is_frictionless() => vec![plain()],
        Tangential::Frictionless => vec![plain()],
        Tangential::Linear { keep, from_normal } => {
            let mut law = plain();
            for tangent in &tangents {
                add(&mut law.change, keep - 1.0, tangent, tangent);
                // The impact speed is -n . r.
                add(&mut law.change, -from_normal, tangent, n);
            }
            vec![law]
        }
        Tangential::Coulomb { coefficient, directions } => {
            let in_plane = tangents.len() == 1;
            // The pyramid lies inside the cone.
            let inside = if in_plane { 1.0 } else { (PI / directions as f64).cos() };
            let bound = coefficient * inside;
            let ways: Vec<Vec<f64>> = around(n, directions).collect();
            let mut stick = Law { name: "stick".into(), ..plain() };
            for tangent in &tangents {
                add(&mut stick.change, -1.0, tangent, tangent);
            }
            // d . r <= bound j, where the normal impulse is j = -end n . r - start n . r(start).
            let exceeds = |name: &'static str, d: &[f64], sign: f64| -> Guard {
                let factors = d.iter().zip(n).map(|(d, n)| sign * (d + bound * end * n));
                let at_start = n.iter().map(|n| sign * bound * start * n);
                Guard { name, factors: factors.collect(), at_start: at_start.collect() }
            };
            match in_plane {
                true => stick.guards = ways.iter().map(|d| exceeds("sticks", d, 1.0)).collect(),
                // In space the cone itself.
                false => {
                    let along = |d: &Vec<f64>| Guard {
                        name: "sticks",
                        factors: d.clone(),
                        at_start: vec![0.0; n.len()],
                    };
                    let most = |share: f64| n.iter().map(|n| -coefficient * share * n).collect();
                    let bound = Guard { name: "sticks", factors: most(end), at_start: most(start) };
                    stick.cone = tangents.iter().map(along).chain([bound]).collect();
                }
            }
            let mut laws = vec![stick];
            for (k, d) in ways.iter().enumerate() {
                let name = match (in_plane, k) {
                    (true, 0) => "slip left".to_owned(),
                    (true, _) => "slip right".to_owned(),
                    (false, k) => format!("slip {k} at"),
                };
                let mut law = Law { name, ..plain() };
                // The impulse -bound j d.
                add(&mut law.change, bound * end, d, n);
                add(&mut law.at_start, bound * start, d, n);
                law.guards.push(exceeds("slips", d, -1.0));
                if !in_plane {
                    // Within the sector: nearer to d than to its neighbours.
                    for other in [k + 1, k + ways.len() - 1] {
                        let other = &ways[other % ways.len()];
                        let factors = other.iter().zip(d).map(|(o, d)| o - d).collect();
                        let at_start = vec![0.0; n.len()];
                        law.guards.push(Guard { name: "sector", factors, at_start });
                    }
                }
                laws.push(law);
            }
            laws
        }
    }
}
