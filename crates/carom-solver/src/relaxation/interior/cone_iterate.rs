//! The part of an iterate that belongs to second-order cones: slacks and multipliers, both inside
//! their cones, and the scaling of Nesterov and Todd that takes both to the same point.
//!
//! With `J = diag(1, -1, ..., -1)`, a cone's scaling is `W = e [w0 w1'; w1 I + w1 w1' / (1 + w0)]`
//! with `w' J w = 1`, so that `W^-2 = (2 Jw (Jw)' - J) / e^2`, and `W z = W^-1 s` is the scaled
//! point. (Vandenberghe, "The CVXOPT linear and quadratic cone program solvers", 2010, sections 4
//! and 5.)

use super::scaled_cones::ScaledCones;
use crate::presolve::refill;

/// Slacks `s`, multipliers `z`, and what a step needs.
#[derive(Debug, Default)]
pub(super) struct ConeIterate {
    pub(super) slack: Vec<f64>,
    pub(super) dual: Vec<f64>,
    /// `G x + h - s`.
    residual: Vec<f64>,
    /// By entry, `w`; by cone, `e`.
    point: Vec<f64>,
    size: Vec<f64>,
    /// The scaled point.
    scaled: Vec<f64>,
    /// The amount that the slacks are to lose, besides the effect of the step of the multipliers.
    push: Vec<f64>,
    slack_move: Vec<f64>,
    dual_move: Vec<f64>,
    scratch: Vec<f64>,
    other: Vec<f64>,
}

/// `a' J a`, accurate near the boundary.
fn determinant(a: &[f64]) -> f64 {
    let tail = length(&a[1..]);
    (a[0] - tail) * (a[0] + tail)
}

fn length(a: &[f64]) -> f64 {
    a.iter().map(|v| v * v).sum::<f64>().sqrt()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl ConeIterate {
    /// Goes to a start near a point with the activities `G x`.
    pub(super) fn start(&mut self, cones: &ScaledCones, x: &[f64]) {
        let entries = cones.entry_count();
        for vector in [
            &mut self.slack,
            &mut self.dual,
            &mut self.residual,
            &mut self.point,
            &mut self.scaled,
            &mut self.push,
            &mut self.slack_move,
            &mut self.dual_move,
            &mut self.scratch,
            &mut self.other,
        ] {
            refill(vector, entries, 0.0);
        }
        refill(&mut self.size, cones.len(), 1.0);
        cones.activities(x, &mut self.slack);
        self.slack.iter_mut().zip(&cones.constant).for_each(|(s, h)| *s += h);
        for cone in 0..cones.len() {
            let s = &mut self.slack[cones.entries(cone)];
            s[0] = s[0].max(length(&s[1..]) + 1.0);
            let inverse = 1.0 / determinant(s);
            let z = &mut self.dual[cones.entries(cone)];
            z[0] = s[0] * inverse;
            z[1..].iter_mut().zip(&s[1..]).for_each(|(z, s)| *z = -s * inverse);
        }
    }

    /// Sets all slacks and multipliers to the centre of their cones, times a number.
    pub(super) fn centre(&mut self, cones: &ScaledCones, value: f64) {
        for vector in [&mut self.slack, &mut self.dual] {
            vector.fill(0.0);
            (0..cones.len()).for_each(|cone| vector[cones.entries(cone).start] = value);
        }
    }

    /// Computes the residuals, subtracts `G'z` from a gradient, and returns `s'z`.
    pub(super) fn measure(&mut self, cones: &ScaledCones, x: &[f64], gradient: &mut [f64]) -> f64 {
        cones.activities(x, &mut self.residual);
        let known = cones.constant.iter().zip(&self.slack);
        self.residual.iter_mut().zip(known).for_each(|(r, (h, s))| *r += h - s);
        cones.subtract_transposed(&self.dual, gradient);
        dot(&self.slack, &self.dual)
    }

    /// The largest miss of a cone, relative to its head.
    pub(super) fn violation(&self, cones: &ScaledCones) -> f64 {
        let miss = |cone: usize| {
            let at = |e: usize| self.residual[e] + self.slack[e];
            let entries = cones.entries(cone);
            let head = at(entries.start);
            let tail = entries.skip(1).map(|e| at(e).powi(2)).sum::<f64>().sqrt();
            (tail - head) / head.abs().max(1.0)
        };
        (0..cones.len()).map(miss).fold(0.0, f64::max)
    }

    /// `z'h`, and the sum of the magnitudes of its terms.
    pub(super) fn limits(&self, cones: &ScaledCones) -> (f64, f64) {
        let terms = self.dual.iter().zip(&cones.constant);
        terms.fold((0.0, 0.0), |(sum, size), (z, h)| {
            (sum + z * h, size + z.abs() * h.abs().max(1.0))
        })
    }

    /// Computes the scaling; `false` if a slack or a multiplier is not inside its cone.
    pub(super) fn scale(&mut self, cones: &ScaledCones) -> bool {
        for cone in 0..cones.len() {
            let range = cones.entries(cone);
            let (s, z) = (&self.slack[range.clone()], &self.dual[range.clone()]);
            let (of_s, of_z) = (determinant(s), determinant(z));
            if !(of_s > 0.0 && of_z > 0.0 && s[0] > 0.0 && z[0] > 0.0) {
                return false;
            }
            let (root_s, root_z) = (1.0 / of_s.sqrt(), 1.0 / of_z.sqrt());
            let gamma = (0.5 * (1.0 + dot(s, z) * root_s * root_z)).sqrt();
            let w = &mut self.point[range.clone()];
            for (e, w) in w.iter_mut().enumerate() {
                let sign = if e == 0 { 1.0 } else { -1.0 };
                *w = (s[e] * root_s + sign * z[e] * root_z) / (2.0 * gamma);
            }
            // On its hyperboloid, whatever was rounded.
            w[0] = (1.0 + dot(&w[1..], &w[1..])).sqrt();
            self.size[cone] = (of_s / of_z).sqrt().sqrt();
        }
        self.scaled.clone_from(&self.dual);
        (0..cones.len()).for_each(|cone| {
            let range = cones.entries(cone);
            apply(&self.point[range.clone()], self.size[cone], 1.0, &mut self.scaled[range]);
        });
        true
    }

    /// Passes on the entries of `W^2` with their places: by cone, column by column of an upper
    /// triangle.
    pub(super) fn for_each_block_entry(
        &self,
        cones: &ScaledCones,
        places: &[usize],
        mut visit: impl FnMut(usize, f64),
    ) {
        let mut places = places.iter();
        for cone in 0..cones.len() {
            let w = &self.point[cones.entries(cone)];
            let squared = self.size[cone].powi(2);
            for (b, of_b) in w.iter().enumerate() {
                for (a, of_a) in w[..=b].iter().enumerate() {
                    let unit = f64::from(u8::from(a == b));
                    let sign = if b == 0 { -unit } else { unit };
                    let Some(&place) = places.next() else { return };
                    visit(place, squared * (2.0 * of_a * of_b + sign));
                }
            }
        }
    }

    /// Multiplies by `W^2`.
    fn weigh(&self, cones: &ScaledCones, vector: &mut [f64]) {
        for cone in 0..cones.len() {
            let range = cones.entries(cone);
            let (w, v) = (&self.point[range.clone()], &mut vector[range]);
            let squared = self.size[cone].powi(2);
            let along = 2.0 * dot(w, v);
            v[0] = squared * (along * w[0] - v[0]);
            let tail = v[1..].iter_mut().zip(&w[1..]);
            tail.for_each(|(v, w)| *v = squared * (along * w + *v));
        }
    }

    /// Subtracts the product of the rows and columns of cones with a direction from a vector.
    ///
    /// # Arguments
    ///
    /// * `step`, `along`: the direction's columns, and its entries of cones.
    /// * `columns`, `entries`: those of the vector.
    pub(super) fn subtract_product(
        &mut self,
        cones: &ScaledCones,
        (step, along): (&[f64], &[f64]),
        columns: &mut [f64],
        entries: &mut [f64],
    ) {
        cones.subtract_transposed(along, columns);
        let mut scratch = std::mem::take(&mut self.scratch);
        cones.activities(step, &mut scratch);
        entries.iter_mut().zip(&scratch).for_each(|(v, a)| *v -= a);
        scratch.copy_from_slice(along);
        self.weigh(cones, &mut scratch);
        entries.iter_mut().zip(&scratch).for_each(|(v, a)| *v += a);
        self.scratch = scratch;
    }

    /// Aims at the boundary, as the predictor does.
    pub(super) fn aim_at_boundary(&mut self) {
        self.push.clone_from(&self.slack);
    }

    /// Aims at nothing.
    pub(super) fn aim_at_nothing(&mut self) {
        self.push.fill(0.0);
    }

    /// Aims at a complementarity, with the second-order term of the predictor.
    pub(super) fn aim_at(&mut self, cones: &ScaledCones, target: f64) {
        for cone in 0..cones.len() {
            let range = cones.entries(cone);
            let (w, size) = (&self.point[range.clone()], self.size[cone]);
            let s = &mut self.scratch[range.clone()];
            let z = &mut self.other[range.clone()];
            s.copy_from_slice(&self.slack_move[range.clone()]);
            z.copy_from_slice(&self.dual_move[range.clone()]);
            apply(w, 1.0 / size, -1.0, s);
            apply(w, size, 1.0, z);
            // Their product, without the target, divided by the scaled point.
            let product = dot(s, z) - target;
            for e in 1..s.len() {
                s[e] = s[0] * z[e] + z[0] * s[e];
            }
            s[0] = product;
            let point = &self.scaled[range.clone()];
            let head = (point[0] * s[0] - dot(&point[1..], &s[1..])) / determinant(point);
            for e in 1..s.len() {
                s[e] = (s[e] - head * point[e]) / point[0];
            }
            s[0] = head;
            apply(w, size, 1.0, s);
            let push = self.push[range.clone()].iter_mut();
            push.zip(&*s).zip(&self.slack[range]).for_each(|((push, v), s)| *push = s + v);
        }
    }

    /// Aims at a complementarity from wherever the iterate is.
    pub(super) fn aim_at_centre(&mut self, cones: &ScaledCones, target: f64) {
        for cone in 0..cones.len() {
            let range = cones.entries(cone);
            let (s, z) = (&self.slack[range.clone()], &self.dual[range.clone()]);
            let factor = target / determinant(z);
            for (e, push) in self.push[range].iter_mut().enumerate() {
                *push = s[e] - factor * if e == 0 { z[e] } else { -z[e] };
            }
        }
    }

    /// Appends the right sides of the entries.
    pub(super) fn write_right(&self, right: &mut Vec<f64>) {
        right.extend(self.residual.iter().zip(&self.push).map(|(r, push)| -r - push));
    }

    /// The moves that belong to a step of the columns and the entries.
    pub(super) fn follow(&mut self, cones: &ScaledCones, step: &[f64], along: &[f64]) {
        cones.activities(step, &mut self.slack_move);
        self.slack_move.iter_mut().zip(&self.residual).for_each(|(v, r)| *v += r);
        self.dual_move.iter_mut().zip(along).for_each(|(v, a)| *v = -a);
    }

    /// The complementarity after a part of the step.
    pub(super) fn ahead(&self, length: f64) -> f64 {
        let slacks = self.slack.iter().zip(&self.slack_move).map(|(s, step)| s + length * step);
        let duals = self.dual.iter().zip(&self.dual_move).map(|(z, step)| z + length * step);
        slacks.zip(duals).map(|(s, z)| s * z).sum()
    }

    /// The inverse of the longest step that stays inside the cones.
    pub(super) fn fastest(&self, cones: &ScaledCones) -> f64 {
        let of = |cone: usize| {
            let range = cones.entries(cone);
            let s = fall(&self.slack[range.clone()], &self.slack_move[range.clone()]);
            s.max(fall(&self.dual[range.clone()], &self.dual_move[range]))
        };
        (0..cones.len()).map(of).fold(0.0, f64::max)
    }

    /// Takes a part of the step.
    pub(super) fn step(&mut self, length: f64) {
        self.slack.iter_mut().zip(&self.slack_move).for_each(|(s, step)| *s += length * step);
        self.dual.iter_mut().zip(&self.dual_move).for_each(|(z, step)| *z += length * step);
    }

    /// The least eigenvalue of the moves of the slacks, and the largest.
    pub(super) fn eigenvalues(&self, cones: &ScaledCones) -> (f64, f64) {
        (0..cones.len()).fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), cone| {
            let range = cones.entries(cone);
            let (head, tail) = (self.slack_move[range.start], &self.slack_move[range][1..]);
            let tail = length(tail);
            (least.min(head - tail), most.max(head + tail))
        })
    }

    /// Goes to the moves of the slacks and their negatives, both moved inside.
    pub(super) fn start_from_moves(&mut self, cones: &ScaledCones, shift: f64, lift: f64) {
        self.slack.copy_from_slice(&self.slack_move);
        self.dual.iter_mut().zip(&self.slack_move).for_each(|(z, step)| *z = -step);
        for cone in 0..cones.len() {
            let head = cones.entries(cone).start;
            self.slack[head] += shift;
            self.dual[head] += lift;
        }
    }
}

/// Multiplies by `W`, or, with the inverse size and the sign -1, by `W^-1`.
fn apply(w: &[f64], size: f64, sign: f64, v: &mut [f64]) {
    let along = dot(&w[1..], &v[1..]);
    let head = v[0];
    let factor = along / (1.0 + w[0]) + sign * head;
    v[0] = size * (w[0] * head + sign * along);
    v[1..].iter_mut().zip(&w[1..]).for_each(|(v, w)| *v = size * (*v + factor * w));
}

/// The inverse of the longest step from a point of a cone that stays inside.
fn fall(from: &[f64], step: &[f64]) -> f64 {
    let a = determinant(step);
    let b = from[0] * step[0] - dot(&from[1..], &step[1..]);
    let c = determinant(from);
    if a >= 0.0 && b >= 0.0 {
        return 0.0;
    }
    // The root is real: vectors inside such a cone have `b^2 >= a c`.
    (((b * b - a * c).max(0.0).sqrt() - b) / c).max(0.0)
}
