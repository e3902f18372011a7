//! Cuts of cones: rows that hold in a second-order cone, each proved by its own coefficients.
//!
//! `w.tail <= p head` holds in `|tail| <= head` if `|w| <= p`, and `2 w.tail <= p first + q second`
//! in `|tail|^2 <= first second` if `p` and `q` are at least 0 and `|w|^2 <= p q`, because
//! `2 |w| |tail| <= 2 sqrt(p first q second) <= p first + q second`. Both conditions are met by the
//! floats that the rows are made of, with rounding accounted for.

use crate::presolve::ReducedCone;
use crate::program::{ConeRole, ConeShape};
use crate::tolerance::largest_magnitude;

/// The largest quotient of two coefficients of a cut (no unit); larger ones trouble linear
/// programs.
const MAX_COEFFICIENT_RATIO: f64 = 1e8;

/// A weight of the tail below this part of the largest coefficient is left out (no unit).
const SLIGHT_WEIGHT: f64 = 1e-9;

/// A row `terms <= 0` over columns of a program that holds in a cone.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ConeCut {
    /// Columns and coefficients.
    pub terms: Vec<(usize, f64)>,
}

impl ConeCut {
    /// The sum of its terms at a point of a program; above 0 if it is violated.
    pub(crate) fn violation(&self, x: &[f64]) -> f64 {
        self.terms.iter().map(|&(j, a)| a * x[j]).sum()
    }

    /// The cut that a point outside a cone violates; `None` if there is none with usable
    /// coefficients.
    pub(crate) fn at(cone: &ReducedCone, x: &[f64]) -> Option<ConeCut> {
        let tail: Vec<f64> = cone.tail().iter().map(|entry| entry.at(x)).collect();
        match cone.shape {
            ConeShape::Norm => {
                let cut = ConeCut::in_norm(cone, &tail)?;
                cut.is_balanced().then_some(cut)
            }
            ConeShape::Rotated => {
                let (first, second) = (cone.entries[0], cone.entries[1]);
                let (a, b) = (first.at(x).max(0.0), second.at(x).max(0.0));
                let size = length(&tail);
                // The tangent at the point that the other factor and the tail tell, or, if both
                // factors are free, at the nearest point.
                let tangent = |factor: f64| (factor > 0.0).then(|| size / factor);
                let is_ratio = matches!(cone.role, ConeRole::Part | ConeRole::Square);
                let along = if second.is_fixed() || (is_ratio && b > 0.0) {
                    tangent(b).map(|slope| [1.0, slope * slope, slope])
                } else if first.is_fixed() {
                    tangent(a).map(|slope| [slope * slope, 1.0, slope])
                } else {
                    None
                };
                let from = |[p, q, slope]: [f64; 3]| {
                    let weights: Vec<f64> = tail.iter().map(|t| t / size * slope).collect();
                    ConeCut::in_rotated(cone, p, q, weights).filter(ConeCut::is_balanced)
                };
                along.and_then(from).or_else(|| {
                    let all = (2.0 * size).hypot(a - b);
                    let lean = (a - b) / all;
                    from([1.0 - lean, 1.0 + lean, 2.0 * size / all])
                })
            }
        }
    }

    /// The cut that the multipliers of a cone are, and its own multiplier; `None` if they are
    /// nothing.
    ///
    /// # Arguments
    ///
    /// * `z`: one multiplier for each entry of `|tail| <= head`, or of
    ///   `|(first - second, 2 tail)| <= first + second` for a rotated cone, within the same cone.
    /// * `slight`: the share of the largest multiplier below which one of a norm counts as 0. A
    ///   point that leaves for infinity has multipliers that are ever closer to 0.
    pub(super) fn of_multipliers(
        cone: &ReducedCone,
        z: &[f64],
        slight: f64,
    ) -> Option<(ConeCut, f64)> {
        let size = largest_magnitude(z);
        if !(size > 0.0 && size.is_finite()) {
            return None;
        }
        let scaled = |v: &f64| if v.abs() <= slight * size { 0.0 } else { -v / size };
        let cut = match cone.shape {
            ConeShape::Norm => {
                let weights: Vec<f64> = z[1..].iter().map(scaled).collect();
                if length(&weights) == 0.0 {
                    let terms = vec![(cone.entries[0].column, -1.0)];
                    return (z[0] > 0.0).then_some((ConeCut { terms }, z[0]));
                }
                ConeCut::in_norm(cone, &weights)?
            }
            ConeShape::Rotated => {
                let (p, q) = ((z[0] + z[1]) / size, (z[0] - z[1]) / size);
                let weights: Vec<f64> = z[2..].iter().map(scaled).collect();
                let is_flat = slight > 0.0 && weights.iter().all(|w| *w == 0.0);
                // Without weights, factors that only weights need are 0 as well.
                let [p, q] = [p, q].map(|v| if is_flat && v <= slight { 0.0 } else { v.max(0.0) });
                ConeCut::in_rotated(cone, p, q, weights)?
            }
        };
        Some((cut, size))
    }

    /// The cut `weights.tail <= |weights| head`, as large as the weights are.
    fn in_norm(cone: &ReducedCone, weights: &[f64]) -> Option<ConeCut> {
        // The length of a single weight is exact.
        let head = match weights.iter().filter(|w| **w != 0.0).count() {
            1 => largest_magnitude(weights),
            _ => rounded_up(length(weights), weights.len()),
        };
        if !(head > 0.0 && head.is_finite()) {
            return None;
        }
        let mut terms = vec![(cone.entries[0].column, -head)];
        let tail = cone.tail().iter().zip(weights);
        terms.extend(
            tail.filter(|(_, w)| w.abs() > SLIGHT_WEIGHT * head).map(|(e, w)| (e.column, *w)),
        );
        Some(ConeCut { terms })
    }

    /// The cut `2 weights.tail <= p first + q second`, with weights that are short enough.
    fn in_rotated(cone: &ReducedCone, p: f64, q: f64, mut weights: Vec<f64>) -> Option<ConeCut> {
        if !(p.is_finite() && q.is_finite() && p >= 0.0 && q >= 0.0 && p.max(q) > 0.0) {
            return None;
        }
        let allowed = (p * q).next_down().max(0.0).sqrt().next_down().max(0.0);
        let size = rounded_up(length(&weights), weights.len());
        if !size.is_finite() {
            return None;
        }
        if size > allowed {
            // A few units in the last place, where the multipliers are on the boundary.
            let factor = allowed / size * (1.0 - 8.0 * f64::EPSILON);
            weights.iter_mut().for_each(|w| *w *= factor);
        }
        let mut terms = Vec::with_capacity(cone.entries.len());
        let heads = [(cone.entries[0].column, -p), (cone.entries[1].column, -q)];
        terms.extend(heads.into_iter().filter(|(_, a)| *a != 0.0));
        let least = SLIGHT_WEIGHT * p.max(q);
        let tail = cone.tail().iter().zip(&weights).filter(|(_, w)| w.abs() > least);
        terms.extend(tail.map(|(entry, w)| (entry.column, 2.0 * w)));
        Some(ConeCut { terms })
    }

    /// Whether no coefficient is far larger than another one.
    fn is_balanced(&self) -> bool {
        let sizes = || self.terms.iter().map(|(_, a)| a.abs());
        let (least, most) = (sizes().fold(f64::INFINITY, f64::min), sizes().fold(0.0, f64::max));
        self.terms.len() > 1 && most <= MAX_COEFFICIENT_RATIO * least
    }
}

/// The length of a vector.
pub(super) fn length(vector: &[f64]) -> f64 {
    let largest = largest_magnitude(vector);
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    largest * vector.iter().map(|v| (v / largest).powi(2)).sum::<f64>().sqrt()
}

/// A computed length of so many entries, plus its possible rounding.
fn rounded_up(length: f64, entries: usize) -> f64 {
    length * (1.0 + (entries as f64 + 4.0) * f64::EPSILON)
}
