//! The ways in which a step may pass a contact, as transitions of a hybrid system.
//!
//! With the prediction of free flight, let `g` be the gap to a face with the normal n, and `r` the
//! velocity relative to the face. A hit needs `g <= 0` and `n . r <= 0`, and then
//! `x⁺ = x - n (1+e) g` and `v⁺ = v + (M - 1) r`, where M is the surface's law; in a hit of two
//! bodies, each takes its share. Spins take theirs of the impulse along the surface.

use faer::Mat;

use super::contact::{ContactFace, ContactPair, ContactSpin, Mode, at};
use super::geometry::{around, dot, minus, tangents};
use super::rebound::{Guard, Law, laws, rebound};
use super::statement::Scene;
use crate::error::Error;
use crate::hybrid::contact::IMPACT_SPEED;
use crate::hybrid::damage::ImpactEstimate;
use crate::hybrid::linear::LinearSystem;
use crate::hybrid::system::{
    Halfspace, NormEntry, NormLimit, Reset, Schedule, Transition, Uncertain,
};
use crate::interval::Interval;

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

    /// `direction . v`, likewise. An entry after those of the axes is the factor of the speed at
    /// which spin moves the surfaces past each other.
    pub(super) fn velocity(&self, direction: &[f64]) -> Vec<f64> {
        let mut factors = self.spread(direction, self.axes());
        if let Some(factor) = direction.get(self.axes()) {
            for spin in &self.contact.spins {
                factors[spin.state] -= spin.lever * factor;
            }
        }
        factors
    }

    fn spread(&self, direction: &[f64], from: usize) -> Vec<f64> {
        let mut factors = vec![0.0; self.flow.states()];
        let block = 2 * self.axes();
        for (i, n) in direction.iter().take(self.axes()).enumerate() {
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
            for law in laws(own, self.contact.mobility(), e, 0.0) {
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
        let back = minus(&own.normal);
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

    /// The middle control point of the step's parabola is in front of a face, so that the whole
    /// step is if both ends are: `g + Δt/2 s >= J Δt³/12`, where J bounds the third derivative of
    /// g.
    fn no_dip(&self, face: &ContactFace) -> Halfspace {
        let back = minus(&face.normal);
        let limits = minus(&face.limit);
        self.middle("no dip".into(), &back, &limits)
    }

    /// `direction . c <= limit` at the middle control point `c = x + Δt/2 v` of the step's
    /// parabola, in the middle between the limits at both ends.
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
        let away = minus(&towards);
        hit.with_output(IMPACT_SPEED, away, self.speed(&own.normal))
    }

    /// The limits of the rules on a single hit.
    fn limited(&self, mut hit: Transition, face: usize) -> Transition {
        let own = &self.contact.faces[face];
        let back = minus(&own.normal);
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

    /// The states that a change of the relative velocity changes, with their shares and with its
    /// rows: the velocities of the bodies, and their spins, which the impulse along the surface
    /// turns.
    pub(super) fn taken<'b>(
        &self,
        change: &'b [Vec<f64>],
        along: &'b [f64],
    ) -> Vec<(usize, f64, &'b [f64])> {
        let axes = self.axes();
        let of = |(body, share): (usize, f64)| {
            let rows = change.iter().enumerate();
            rows.map(move |(i, row)| (axes * (2 * body + 1) + i, share, &row[..]))
        };
        let turn = |spin: &ContactSpin| {
            (spin.state, -self.contact.mass * spin.lever / spin.inertia, along)
        };
        self.contact.shares().flat_map(of).chain(self.contact.spins.iter().map(turn)).collect()
    }

    /// The part that the spread of the restitution adds to the reset of a hit. The reset is affine
    /// in e, so the part is the reset for e = 1 less that for e = 0.
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
        for (body, share) in self.contact.shares() {
            let first = 2 * axes * body;
            for i in 0..axes {
                // One after the other, so that 1 - (1 + e) is exactly -e along the normal.
                for lift in [-share * n[i], -share * e * n[i]] {
                    for (j, g) in gap.iter().enumerate() {
                        matrix[(first + i, j)] += lift * g;
                    }
                }
                let lift = -share * (1.0 + e) * n[i];
                for (t, offset) in offsets.iter_mut().enumerate() {
                    offset[first + i] -= lift * at(&face.limit, t + 1);
                }
            }
        }
        let [along, along_at_start] = &law.along;
        let ended = [self.taken(&law.change, along), self.taken(&law.rebound, &[])].concat();
        for (state, share, row) in &ended {
            for (j, c) in self.velocity(row).iter().enumerate() {
                matrix[(*state, j)] += share * c;
            }
        }
        for (state, share, row) in ended.iter().chain(&self.taken(&law.at_start, along_at_start)) {
            for (t, offset) in offsets.iter_mut().enumerate() {
                offset[*state] -= share * dot(row, &self.contact.velocity_in(t, axes));
            }
        }
        // Not -0.
        offsets.iter_mut().flatten().for_each(|r| *r += 0.0);
        (matrix, offsets.into())
    }
}

/// The norm limit of half-spaces: the length of the excesses of the first ones is at most that of
/// the last.
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
