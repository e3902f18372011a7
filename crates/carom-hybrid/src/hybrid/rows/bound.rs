//! The largest value of a linear function over a box and a few half-spaces, without a solver.
//!
//! For multipliers `μ >= 0` of the rows `a_k z <= b_k`, the maximum of `(c - Σ μ_k a_k) z` over the
//! box plus `Σ μ_k b_k` is an upper bound. It is convex and piecewise linear in each multiplier, so
//! one multiplier at a time is set to its best value by walking the breakpoints. With one row, the
//! bound is the maximum; with several, it is valid but not always the least. Rows are forms
//! `a_k z - b_k` that are at most 0.

use crate::activity::term_ends;
use crate::hybrid::step::AffineForm;
use crate::interval::Interval;

/// How often all multipliers are improved.
const SWEEPS: usize = 3;

/// The rounding of a bound, relative to the sum of the magnitudes of its terms (no unit).
const ROUNDING: f64 = 1e-15;

/// Numbers below this fraction of the terms that they are sums of are 0 (no unit).
pub(super) const NOISE: f64 = 1e-14;

/// An upper bound of a linear function.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct UpperBound {
    /// The bound, rounded up; `-inf` if the rows exclude the whole box. Values within rounding of
    /// 0 are 0.
    pub(super) value: f64,
    /// The sum of the multipliers.
    pub(super) weight: f64,
}

/// An upper bound of `factors . z + constant` over the box and the rows, which are at most 0.
///
/// The multipliers are improved in turns, from several starts, because a single one may end where
/// no multiplier alone improves the bound.
///
/// # Arguments
///
/// * `target`: a value at which a smaller bound is of no further use.
pub(super) fn upper_bound(
    factors: &[f64],
    constant: f64,
    domain: &[Interval],
    rows: &[AffineForm],
    target: f64,
) -> UpperBound {
    let mut best = Multipliers::new(factors, constant, domain, rows).bound();
    for first in 0..rows.len() {
        if best.value <= target {
            break;
        }
        let mut multipliers = Multipliers::new(factors, constant, domain, rows);
        let order = (first..rows.len()).chain(0..first);
        for sweep in 0..SWEEPS {
            let mut moved = false;
            for row in order.clone() {
                match multipliers.improve(row) {
                    Some(changed) => moved |= changed,
                    None => return UpperBound { value: f64::NEG_INFINITY, weight: 0.0 },
                }
            }
            // If the first turn changes nothing, no other start does.
            if !moved && sweep == 0 {
                return best;
            }
            let bound = multipliers.bound();
            if bound.value < best.value {
                best = bound;
            }
            if !moved || best.value <= target {
                break;
            }
        }
    }
    best
}

/// A bound in the making.
struct Multipliers<'a> {
    factors: &'a [f64],
    constant: f64,
    domain: &'a [Interval],
    rows: &'a [AffineForm],
    weights: Vec<f64>,
    /// The factors less the weighted rows.
    rest: Vec<f64>,
}

impl<'a> Multipliers<'a> {
    fn new(
        factors: &'a [f64],
        constant: f64,
        domain: &'a [Interval],
        rows: &'a [AffineForm],
    ) -> Self {
        let (weights, rest) = (vec![0.0; rows.len()], factors.to_vec());
        Multipliers { factors, constant, domain, rows, weights, rest }
    }

    fn bound(&self) -> UpperBound {
        let used = || self.rows.iter().zip(&self.weights).filter(|(_, weight)| **weight > 0.0);
        let fixed: f64 = used().map(|(row, weight)| -row.constant * weight).sum();
        let parts = self.rest.iter().zip(self.domain).filter(|(r, _)| **r != 0.0);
        let free: f64 = parts.map(|(r, range)| term_ends(*r, [range.lower, range.upper])[1]).sum();
        let scale = |row: &AffineForm| size(&row.factors, self.domain) + row.constant.abs();
        let magnitude = size(self.factors, self.domain)
            + self.constant.abs()
            + used().map(|(row, weight)| weight * scale(row)).sum::<f64>();
        let value = self.constant + fixed + free;
        let is_noise = value.abs() <= NOISE * magnitude;
        let value = if is_noise { 0.0 } else { value + ROUNDING * magnitude };
        UpperBound { value, weight: self.weights.iter().sum() }
    }

    /// Sets a row's multiplier to its best value; whether that changes it. `None` if the row
    /// excludes the whole box.
    fn improve(&mut self, row: usize) -> Option<bool> {
        let (own, weight) = (&self.rows[row], self.weights[row]);
        let next = best_weight(&self.rest, weight, self.domain, own)?;
        if next == weight {
            return Some(false);
        }
        let entries = self.rest.iter_mut().zip(self.factors).zip(&own.factors);
        for ((rest, factor), a) in entries.filter(|(_, a)| **a != 0.0) {
            let sum = *rest - (next - weight) * a;
            // What cancels is 0.
            let noise = NOISE * (factor.abs() + next.max(weight) * a.abs());
            *rest = if sum.abs() <= noise { 0.0 } else { sum };
        }
        self.weights[row] = next;
        Some(true)
    }
}

/// The sum of the magnitudes of a row's terms.
pub(super) fn size(factors: &[f64], domain: &[Interval]) -> f64 {
    let terms = factors.iter().zip(domain).filter(|(a, _)| **a != 0.0);
    terms.map(|(a, range)| a.abs() * range.magnitude()).sum()
}

/// The multiplier of a row that makes the bound least, if the others stay; `None` if the bound has
/// no least value, because the row excludes the whole box.
fn best_weight(rest: &[f64], weight: f64, domain: &[Interval], row: &AffineForm) -> Option<f64> {
    // Without this row, the factors are `rest + weight * a`; with the multiplier μ, they are 0 in
    // an entry at `μ = weight + rest / a`.
    let mut slope = -row.constant;
    let mut turns: Vec<(f64, f64)> = Vec::new();
    let mut size = row.constant.abs();
    for ((&r, &a), range) in rest.iter().zip(&row.factors).zip(domain) {
        if a == 0.0 {
            continue;
        }
        let turn = weight + r / a;
        // For μ near 0 the entry's sign is that of `r + weight * a`, which is `turn * a`.
        let positive = if turn == 0.0 { a < 0.0 } else { (turn > 0.0) == (a > 0.0) };
        slope -= a * if positive { range.upper } else { range.lower };
        size += a.abs() * range.magnitude();
        if turn > 0.0 {
            turns.push((turn, a.abs() * (range.upper - range.lower)));
        }
    }
    let flat = -1e-12 * size;
    if slope >= flat {
        return Some(0.0);
    }
    turns.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (turn, gain) in turns {
        slope += gain;
        if slope >= flat {
            return Some(turn);
        }
    }
    None
}

/// The range of `factors . z + constant` over the box and the rows; crossed if that is empty.
pub(super) fn range(
    factors: &[f64],
    constant: f64,
    domain: &[Interval],
    rows: &[AffineForm],
) -> Interval {
    if factors.iter().all(|&a| a == 0.0) {
        return Interval::point(constant);
    }
    let none = f64::NEG_INFINITY;
    let negated: Vec<f64> = factors.iter().map(|a| -a).collect();
    Interval {
        // Not -0.
        lower: 0.0 - upper_bound(&negated, -constant, domain, rows, none).value,
        upper: upper_bound(factors, constant, domain, rows, none).value,
    }
}
