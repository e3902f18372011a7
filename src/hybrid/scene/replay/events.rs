//! Impacts located inside a step, and the motion with them.

use super::world::{State, Touch, World};
use crate::hybrid::scene::geometry::dot;
use crate::tolerance::REST_SPEED;

/// Number of parts of a step that are looked at for bodies with springs or drag.
const PARTS: usize = 64;

/// Depth inside a surface that counts as touching it only, in m.
const DEPTH: f64 = 1e-9;

/// The most impacts of one step that are followed.
const MOST: usize = 1000;

/// The first impact of a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct FirstImpact {
    /// From the start of the step, in s.
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

impl World<'_> {
    /// The first time at which a body enters an obstacle or another body by more than `DEPTH`, from
    /// a state in flight.
    pub(super) fn first_impact(
        &self,
        touch: Touch,
        start: &State,
        span: Span<'_>,
    ) -> Option<FirstImpact> {
        let dt = self.scene.time_step;
        let rest = dt - span.from;
        let state = |time: f64| self.fly(start, span.inputs, time);
        let part = |time: f64| ((span.from + time) / dt).min(1.0);
        let clearance = |time: f64| self.clearance(touch, &state(time).x, span.step, part(time));
        let mut times = self.crossings(touch, start, span, rest);
        times.extend([0.0, rest]);
        times.sort_by(f64::total_cmp);
        for pair in times.windows(2) {
            let middle = 0.5 * (pair[0] + pair[1]);
            if clearance(middle).0 >= -DEPTH && clearance(pair[1]).0 >= -DEPTH {
                continue;
            }
            // The surface is crossed at the beginning of the span, or within it.
            let (mut low, mut high) =
                (pair[0], if clearance(middle).0 < -DEPTH { middle } else { pair[1] });
            for _ in 0..60 {
                let time = 0.5 * (low + high);
                if clearance(time).0 < -DEPTH { high = time } else { low = time }
            }
            let at = state(low);
            let face = clearance(low).1;
            let r = self.relative(touch, &at.v, span.step);
            let speed = -dot(self.normal(touch, face), &r);
            if speed <= 0.0 {
                // On its way out of what it touched.
                continue;
            }
            return Some(FirstImpact { time: low, face, speed });
        }
        None
    }

    /// Times at which a gap may change its sign: the roots of parabolas, or a grid.
    fn crossings(&self, touch: Touch, start: &State, span: Span<'_>, rest: f64) -> Vec<f64> {
        let bodies = self.shares(touch);
        let curved = bodies.iter().any(|(b, _)| self.scene.bodies[*b].dynamics.is_some());
        if curved {
            return (1..PARTS).map(|k| rest * k as f64 / PARTS as f64).collect();
        }
        let dt = self.scene.time_step;
        let mut times = Vec::new();
        let ends = [0.0, 0.5 * rest, rest].map(|time| self.fly(start, span.inputs, time).x);
        for face in 0..self.faces(touch) {
            let gap = |k: usize, time: f64| {
                self.gap(touch, face, &ends[k], span.step, (span.from + time) / dt)
            };
            let (g, middle, end) = (gap(0, 0.0), gap(1, 0.5 * rest), gap(2, rest));
            // g + b s + a s² over s in [0, 1].
            let (a, b) = (2.0 * (g - 2.0 * middle + end), 4.0 * middle - 3.0 * g - end);
            let mut push = |s: f64| {
                if s > 0.0 && s < 1.0 {
                    times.push(s * rest);
                }
            };
            let under = b * b - 4.0 * a * g;
            if under >= 0.0 {
                let q = -0.5 * (b + b.signum() * under.sqrt());
                [q / a, g / q].into_iter().filter(|s| s.is_finite()).for_each(&mut push);
            }
            // The deepest point, for gaps that only just become negative.
            if a != 0.0 {
                push(-0.5 * b / a);
            }
        }
        times
    }

    /// A whole step with impacts where they happen. A body that hardly rebounds stays at the surface
    /// for the rest of the step.
    pub(super) fn advance(&self, start: &State, step: usize, inputs: &[Vec<f64>]) -> State {
        let dt = self.scene.time_step;
        let (mut state, mut from) = (start.clone(), 0.0);
        let mut inputs = inputs.to_vec();
        for _ in 0..MOST {
            let span = Span { step, inputs: &inputs, from };
            let impacts = self
                .touches()
                .into_iter()
                .filter_map(|touch| Some((touch, self.first_impact(touch, &state, span)?)));
            let first = impacts.min_by(|a, b| a.1.time.total_cmp(&b.1.time));
            let Some((touch, impact)) = first else { break };
            state = self.fly(&state, &inputs, impact.time);
            from += impact.time;
            let face = impact.face;
            let r = self.relative(touch, &state.v, step);
            let Some(change) = self.changes(touch, face, [&r, &r], 0.0).into_iter().next() else {
                break;
            };
            for (body, share) in self.shares(touch) {
                state.v[body].iter_mut().zip(&change).for_each(|(v, c)| *v += share * c);
            }
            let n = self.normal(touch, face);
            let rebound = dot(n, &self.relative(touch, &state.v, step));
            let push = |inputs: &[Vec<f64>], body: usize, share: f64| {
                let gravity = &self.scene.bodies[body].gravity;
                let total: Vec<f64> =
                    inputs[body].iter().zip(gravity).map(|(u, g)| u + g).collect();
                (share.signum() * dot(n, &total)).min(0.0)
            };
            let shares = self.shares(touch);
            let pull: f64 = shares.iter().map(|&(body, share)| push(&inputs, body, share)).sum();
            // At a surface with rest, hops that are lower than a micrometre are none.
            let is_still = self.surface(touch, face).rests && rebound * rebound <= -2e-6 * pull;
            if rebound <= REST_SPEED || is_still {
                // It rests: nothing pushes it into the surface.
                for (body, share) in shares {
                    let push = push(&inputs, body, share);
                    inputs[body]
                        .iter_mut()
                        .zip(n)
                        .for_each(|(u, n)| *u -= share.signum() * push * n);
                }
            }
            if dt - from <= 1e-12 * dt {
                return state;
            }
        }
        self.fly(&state, &inputs, dt - from)
    }
}
