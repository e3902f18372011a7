//! Through which face of a convex obstacle a step enters, as guards of its hit.

use super::contact::{ContactFace, at};
use super::geometry::minus;
use super::law::{Writer, at_end, at_start};
use crate::hybrid::damage::ImpactEstimate;
use crate::hybrid::system::{Halfspace, NormLimit, Transition};

/// How much deeper behind a sharp neighbour a step must start to end the same distance in front of
/// it (no unit).
///
/// A step that starts in the edge of two faces that meet at an acute angle is in front of both, and
/// within the extent of both. If it leaves in front of one, it has not entered through the other,
/// behind which it is. No closed guard separates it from steps that cut off the tip, so that those
/// that start nearer to the edge than this share of what they move are given up.
pub(super) const SHARP: f64 = 10.0;

impl Writer<'_> {
    /// The guards of a hit by which the step enters through a face, and through no other one first.
    pub(super) fn entering(&self, mut hit: Transition, own: &ContactFace) -> Transition {
        let is_sound = self.scene.estimate == ImpactEstimate::Sound;
        if self.is_convex() {
            let back = minus(&own.normal);
            let limits = minus(&own.limit);
            let starts = Halfspace::new("starts in front", self.position(&back), at_start(&limits));
            hit = hit.with_guard(starts);
        }
        for (k, (normal, limits)) in own.extent.iter().enumerate() {
            let factors = self.position(normal);
            let start =
                Halfspace::new(format!("starts within end {k}"), factors.clone(), at_start(limits));
            let end = Halfspace::new(format!("ends within end {k}"), factors, at_end(limits));
            hit = hit.with_guard(start).with_prediction_guard(end);
            if is_sound {
                // No other face is entered first.
                hit = hit.with_guard(self.middle(format!("stays within end {k}"), normal, limits));
            }
        }
        for (k, (normal, limits)) in own.sharp.iter().enumerate() {
            let mut before = self.start(normal, limits);
            if is_sound {
                let middle = self.middle(format!("goes behind sharp face {k}"), normal, limits);
                let middle = plus(middle, SHARP, &before);
                before.clone_from(&middle);
                hit = hit.with_guard(middle);
            }
            let end = self.predicted(format!("stays behind sharp face {k}"), normal, limits);
            hit = hit.with_guard(plus(end, SHARP, &before));
        }
        hit
    }

    /// `direction . x <= limit` at the start of the step.
    fn start(&self, direction: &[f64], limits: &[f64]) -> Halfspace {
        let steps = limits.len().saturating_sub(1).max(1);
        let limits: Vec<f64> = (0..steps).map(|t| at(limits, t)).collect();
        Halfspace::new("", self.position(direction), limits)
    }

    /// `direction . p <= limit` at the end of free flight, as a guard on the start and the input.
    fn predicted(&self, name: String, direction: &[f64], limits: &[f64]) -> Halfspace {
        self.before(&Halfspace::new(name, self.position(direction), at_end(limits)))
    }

    /// A guard on the end of free flight as a guard on the start and the input.
    pub(super) fn before(&self, guard: &Halfspace) -> Halfspace {
        let (factors, constant) = self.through(&guard.normal);
        let limit = guard.limit.map(|limit| limit - constant);
        Halfspace { normal: factors, limit, ..guard.clone() }
    }

    /// A norm limit of the end of free flight as one of the start and the input.
    pub(super) fn norm_before(&self, norm: &NormLimit) -> NormLimit {
        let mut before = norm.clone();
        for part in before.entries.iter_mut().chain([&mut before.bound]) {
            let (factors, constant) = self.through(&part.factors);
            part.factors = factors;
            part.constant = part.constant.map(|own| own + constant);
        }
        before
    }

    /// A function of the end of free flight as one of the start and the input: its factors and its
    /// constant.
    pub(super) fn through(&self, factors: &[f64]) -> (Vec<f64>, f64) {
        let (a, b, c) = (self.flow.a(), self.flow.b(), self.flow.c());
        let states = self.flow.states();
        let sum = |of: &dyn Fn(usize) -> f64| (0..states).map(|i| factors[i] * of(i)).sum::<f64>();
        let of_states = (0..states).map(|j| sum(&|i| a[(i, j)]));
        let of_inputs = (0..b.ncols()).map(|j| sum(&|i| b[(i, j)]));
        (of_states.chain(of_inputs).collect(), sum(&|i| c[i]))
    }
}

/// The sum of a half-space and a multiple of another one, with the name of the first.
pub(super) fn plus(first: Halfspace, factor: f64, second: &Halfspace) -> Halfspace {
    let width = first.normal.len().max(second.normal.len());
    let entry = |normal: &[f64], i: usize| normal.get(i).copied().unwrap_or(0.0);
    let normal: Vec<f64> =
        (0..width).map(|i| entry(&first.normal, i) + factor * entry(&second.normal, i)).collect();
    let steps = first.limit.values().count().max(second.limit.values().count());
    let limits: Vec<f64> =
        (0..steps).map(|t| first.limit_at(t) + factor * second.limit_at(t)).collect();
    Halfspace::new(first.name, normal, limits)
}
