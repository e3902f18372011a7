//! Impacts located inside a step, and the motion with them.
//!
//! The time-stepped law reflects a whole step at once, but real contact happens inside the step.
//! For accelerations of at most `a_max` (m/s²), a flight between samples outside a wall enters it
//! by at most `a_max Δt²/8` (m), and over one step from a common state speeds differ by at most
//! `(1+e) a_max Δt` (m/s), because the law also reflects the acceleration after the impact.

use super::world::{State, Touch, World};
use crate::hybrid::scene::geometry::dot;
use crate::tolerance::{MAX_BOUNCES, REST_SPEED};

/// Number of parts of a step that are looked at for bodies with springs or drag.
const PARTS: usize = 64;

/// Number of parts of a step that are looked at for dips into obstacles with several faces.
const DIPS: usize = 16;

/// Depth inside a surface that counts as touching it only, in m.
const DEPTH: f64 = 1e-9;

/// Height of a hop that is none at a surface with rest, in m.
const HOP: f64 = 1e-6;

/// The first impact of a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct FirstImpact {
    /// From the start of the span, in s.
    pub(super) time: f64,
    pub(super) face: usize,
    /// Towards the face, in m/s.
    pub(super) speed: f64,
}

/// A step, or the rest of one.
#[derive(Clone, Copy)]
pub(super) struct Span<'a> {
    pub(super) step: usize,
    pub(super) inputs: &'a [Vec<f64>],
    /// Where in the step it begins, in s.
    pub(super) from: f64,
}

/// The end of a step with its impacts.
#[derive(Debug, Clone)]
pub(super) struct Advance {
    pub(super) state: State,
    /// Time from the start of the step, in s, and speed towards the surface, in m/s.
    pub(super) impacts: Vec<(f64, f64)>,
    /// Whether a body came to rest at a surface that it is pressed against.
    pub(super) rested: bool,
}

impl World<'_> {
    /// The first time at which a body enters an obstacle or another body by more than `DEPTH`, or
    /// reaches it at the end, from a state in flight; all gaps count as larger by `shift` (m).
    pub(super) fn first_impact(
        &self,
        touch: Touch,
        start: &State,
        span: Span<'_>,
        shift: f64,
    ) -> Option<FirstImpact> {
        let dt = self.scene.time_step;
        let rest = dt - span.from;
        let state = |time: f64| self.fly(start, span.inputs, time);
        let clearance = |time: f64| {
            let part = ((span.from + time) / dt).min(1.0);
            let (gap, face) = self.clearance(touch, &state(time).x, span.step, part);
            (gap + shift, face)
        };
        let mut times = self.crossings(touch, start, span, shift);
        times.extend([0.0, rest]);
        times.sort_by(f64::total_cmp);
        let impact = |time: f64, face: usize| {
            let r = self.relative(touch, &state(time).v, span.step);
            let speed = -dot(self.normal(touch, face), &r);
            // Otherwise it is on its way out of what it touched.
            (speed > 0.0).then_some(FirstImpact { time, face, speed })
        };
        for pair in times.windows(2) {
            let middle = 0.5 * (pair[0] + pair[1]);
            if clearance(middle).0 >= -DEPTH && clearance(pair[1]).0 >= -DEPTH {
                continue;
            }
            // The surface is crossed at the beginning of the span, or within it.
            let (gap, face) = clearance(pair[0]);
            if gap <= DEPTH
                && let Some(found) = impact(pair[0], face)
            {
                return Some(found);
            }
            let (mut low, mut high) =
                (pair[0], if clearance(middle).0 < -DEPTH { middle } else { pair[1] });
            for _ in 0..60 {
                let time = 0.5 * (low + high);
                if clearance(time).0 < -DEPTH { high = time } else { low = time }
            }
            if let Some(found) = impact(low, clearance(low).1) {
                return Some(found);
            }
        }
        let (gap, face) = clearance(rest);
        impact(rest, face).filter(|found| gap <= DEPTH && found.speed > REST_SPEED)
    }

    /// Times within a span at which a gap may change its sign or turn: of parabolas, or a grid.
    fn crossings(&self, touch: Touch, start: &State, span: Span<'_>, shift: f64) -> Vec<f64> {
        let dt = self.scene.time_step;
        let rest = dt - span.from;
        if self.is_curved(touch) {
            return (1..PARTS).map(|k| rest * k as f64 / PARTS as f64).collect();
        }
        let mut times = Vec::new();
        for face in 0..self.faces(touch) {
            let n = self.normal(touch, face);
            // g + s t + a t²/2.
            let g = self.gap(touch, face, &start.x, span.step, span.from / dt) + shift;
            let s = dot(n, &self.relative(touch, &start.v, span.step));
            let a = self.pull(touch, face, span.inputs);
            let under = s * s - 2.0 * a * g;
            if under >= 0.0 {
                let q = -(s + under.sqrt().copysign(s));
                times.extend([q / a, 2.0 * g / q]);
            }
            // The deepest point, for gaps that only just become negative.
            times.push(-s / a);
        }
        times.retain(|&time| time > 0.0 && time < rest);
        times
    }

    /// The largest depth of a step of free flight inside what a body touches, in m; 0 if it stays
    /// outside.
    pub(super) fn dip(&self, touch: Touch, start: &State, span: Span<'_>) -> f64 {
        let dt = self.scene.time_step;
        let mut times = self.crossings(touch, start, span, 0.0);
        times.extend([0.0, dt]);
        if self.faces(touch) > 1 {
            times.extend((1..DIPS).map(|k| dt * k as f64 / DIPS as f64));
        }
        let depth = |time: f64| {
            let x = self.fly(start, span.inputs, time).x;
            -self.clearance(touch, &x, span.step, time / dt).0
        };
        times.into_iter().map(depth).fold(0.0, f64::max)
    }

    fn is_curved(&self, touch: Touch) -> bool {
        self.shares(touch).iter().any(|(b, _)| self.scene.bodies[*b].dynamics.is_some())
    }

    /// The bodies of a contact with the sign of their gaps, and what inputs and gravity add to the
    /// acceleration of the gap to a face, in m/s².
    fn pushes(&self, touch: Touch, face: usize, inputs: &[Vec<f64>]) -> Vec<(usize, f64, f64)> {
        let n = self.normal(touch, face);
        let of = |(body, share): (usize, f64)| {
            let pairs = inputs[body].iter().zip(&self.scene.bodies[body].gravity);
            let along: f64 = pairs.zip(n).map(|((u, g), n)| n * (u + g)).sum();
            (body, share.signum(), share.signum() * along)
        };
        self.shares(touch).into_iter().map(of).collect()
    }

    /// The acceleration of the gap to a face under inputs and gravity, in m/s².
    fn pull(&self, touch: Touch, face: usize, inputs: &[Vec<f64>]) -> f64 {
        self.pushes(touch, face, inputs).iter().map(|push| push.2).sum()
    }

    /// A whole step with impacts where they happen. A body that hardly rebounds stays at the
    /// surface for the rest of the step.
    ///
    /// # Arguments
    ///
    /// * `shift`: by how much a gap counts as larger, in m.
    pub(super) fn advance(
        &self,
        start: &State,
        step: usize,
        inputs: &[Vec<f64>],
        shift: &dyn Fn(Touch) -> f64,
    ) -> Advance {
        let dt = self.scene.time_step;
        let mut end = Advance { state: start.clone(), impacts: Vec::new(), rested: false };
        let (mut inputs, mut from) = (inputs.to_vec(), 0.0);
        while end.impacts.len() <= MAX_BOUNCES && from < dt {
            for touch in self.touches() {
                end.rested |= self.hold(touch, &end.state, (step, from), &mut inputs, shift(touch));
            }
            let span = Span { step, inputs: &inputs, from };
            let impacts = self.touches().into_iter().filter_map(|touch| {
                Some((touch, self.first_impact(touch, &end.state, span, shift(touch))?))
            });
            let first = impacts.min_by(|a, b| a.1.time.total_cmp(&b.1.time));
            let Some((touch, impact)) = first else { break };
            end.state = self.fly(&end.state, &inputs, impact.time);
            from += impact.time;
            end.impacts.push((from, impact.speed));
            let face = impact.face;
            self.place(touch, face, &mut end.state, (step, from), shift(touch));
            let r = self.relative(touch, &end.state.v, step);
            let mut changes = self.changes(touch, face, step, [&end.state, &end.state], 0.0);
            let Some(mut change) = changes.drain(..).next() else { break };
            let n = self.normal(touch, face);
            let rebound = dot(n, &r) + dot(n, &change);
            let pull = self.pull(touch, face, &inputs);
            let is_still =
                self.surface(touch, face).rests && rebound * rebound <= -2.0 * HOP * pull;
            let is_worn_out = rebound <= REST_SPEED || is_still || end.impacts.len() >= MAX_BOUNCES;
            if is_worn_out && pull < 0.0 {
                change.iter_mut().zip(n).for_each(|(c, n)| *c -= rebound * n);
            }
            self.strike(touch, face, &change, &mut end.state);
        }
        end.state = self.fly(&end.state, &inputs, (dt - from).max(0.0));
        for touch in self.touches() {
            let (gap, face) = self.clearance(touch, &end.state.x, step, 1.0);
            if gap + shift(touch) < 0.0 {
                self.place(touch, face, &mut end.state, (step, dt), shift(touch));
            }
        }
        end
    }

    /// Places bodies that touch a face exactly at it.
    fn place(
        &self,
        touch: Touch,
        face: usize,
        state: &mut State,
        (step, from): (usize, f64),
        shift: f64,
    ) {
        let part = from / self.scene.time_step;
        let gap = self.gap(touch, face, &state.x, step, part) + shift;
        if gap.abs() <= DEPTH {
            let n = self.normal(touch, face);
            for (body, share) in self.shares(touch) {
                state.x[body].iter_mut().zip(n).for_each(|(x, n)| *x -= share * gap * n);
            }
        }
    }

    /// Takes away what presses a body against a surface at which it is at rest. Returns whether
    /// that was anything.
    fn hold(
        &self,
        touch: Touch,
        state: &State,
        (step, from): (usize, f64),
        inputs: &mut [Vec<f64>],
        shift: f64,
    ) -> bool {
        let (gap, face) = self.clearance(touch, &state.x, step, from / self.scene.time_step);
        let n = self.normal(touch, face);
        let rate = dot(n, &self.relative(touch, &state.v, step));
        let is_at_rest = gap + shift <= DEPTH && rate.abs() <= REST_SPEED;
        if !is_at_rest || self.pull(touch, face, inputs) >= 0.0 {
            return false;
        }
        for (body, sign, push) in self.pushes(touch, face, inputs) {
            let own = inputs[body].iter_mut().zip(n);
            own.for_each(|(u, n)| *u -= sign * push.min(0.0) * n);
        }
        true
    }
}
