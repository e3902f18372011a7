//! Sums of facts with simpler multipliers than those of a relaxation, and with facts of a linear
//! objective.

use super::bounds::Bounds;
use super::facts::Facts;
use super::relaxed::{FactRefutation, Relaxer};

/// The part of the largest multiplier below which another one is rounding (no unit).
const ROUNDING_SHARE: f64 = 1e-7;

/// Into how many parts the least multiplier is divided (no unit).
const PARTS_OF_LEAST: f64 = 12.0;

/// How many bits of the largest multiplier are kept.
const KEPT_BITS: [f64; 3] = [6.0, 16.0, 30.0];

/// A fact of the objective: it is at most something.
#[derive(Debug, Clone, Copy)]
pub(super) struct ObjectiveFact {
    pub(super) fact: usize,
    /// The objective without its constant as a multiple of the fact's terms.
    pub(super) ratio: f64,
    /// The largest objective that it leaves.
    pub(super) most: f64,
}

impl Relaxer<'_> {
    /// Whether a sum with one of the facts of a linear objective is a contradiction.
    pub(super) fn check_objective(
        &mut self,
        facts: &Facts,
        bounds: &Bounds,
        found: &mut FactRefutation,
    ) -> Option<()> {
        for k in 0..self.objective.len() {
            let ObjectiveFact { fact, ratio, .. } = self.objective[k];
            found.facts.push((fact, -ratio));
            if self.check(facts, bounds, found).is_some() {
                return Some(());
            }
            let kept = found.facts.clone();
            if self.check_simpler(facts, bounds, found).is_some() {
                return Some(());
            }
            found.facts = kept;
            if self.check(facts, bounds, found).is_none()
                && self.check_repaired(facts, bounds, found).is_some()
            {
                return Some(());
            }
            found.facts.retain(|(own, _)| *own != fact);
        }
        None
    }

    /// Tries sums with simpler numbers, whose terms cancel exactly where a column has no bound:
    /// parts of the least multiplier, and multiples of powers of 2.
    pub(super) fn check_simpler(
        &mut self,
        facts: &Facts,
        bounds: &Bounds,
        found: &mut FactRefutation,
    ) -> Option<()> {
        if !found.tight.is_empty() || !found.cones.is_empty() || found.tangent.is_some() {
            return None;
        }
        let exact = found.facts.clone();
        let sizes = || exact.iter().map(|(_, y)| y.abs());
        let most = sizes().fold(0.0, f64::max);
        let least = sizes().filter(|y| *y > ROUNDING_SHARE * most).fold(f64::INFINITY, f64::min);
        if !(most > 0.0 && most.is_finite()) {
            return None;
        }
        let power = most.log2().floor();
        let grids = KEPT_BITS.map(|bits| (1.0, 2.0_f64.powf(power - bits)));
        for (scale, grid) in std::iter::once((PARTS_OF_LEAST / least, 1.0)).chain(grids) {
            let rounded = exact.iter().map(|&(fact, y)| (fact, (scale * y / grid).round() * grid));
            found.facts = rounded.filter(|(_, y)| *y != 0.0).collect();
            if self.check(facts, bounds, found).is_some() {
                return Some(());
            }
        }
        found.facts = exact;
        None
    }
}
