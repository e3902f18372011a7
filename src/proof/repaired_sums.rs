//! Sums of facts in which columns that have no bound have coefficients of the wrong sign, by rounding: a small
//! change of all multipliers turns the signs.

use super::bounds::Bounds;
use super::conjugate_gradients::conjugate_gradients;
use super::facts::Facts;
use super::relaxed::{FactRefutation, Relaxer};

/// Most changes of the multipliers.
const MOST_CHANGES: usize = 6;

/// Steps of conjugate gradients of a change.
const MOST_CHANGE_STEPS: usize = 200;

/// By how much a sign is turned, as a multiple of the largest coefficient that is wrong (no unit).
const TURNED_BY: f64 = 2.0;

impl Relaxer<'_> {
    /// Whether a sum becomes a contradiction by a change of its multipliers, after [`check`](Self::check) has
    /// refused it.
    pub(super) fn check_repaired(
        &mut self,
        facts: &Facts,
        bounds: &Bounds,
        found: &mut FactRefutation,
    ) -> Option<()> {
        let kept = found.facts.clone();
        let mut columns: Vec<usize> = Vec::new();
        for _ in 0..MOST_CHANGES {
            let missing = self.sum.missing(&|j| bounds.of(j));
            let most = missing.iter().map(|(_, excess)| *excess).fold(0.0, f64::max);
            if missing.is_empty() || !most.is_finite() {
                break;
            }
            columns.extend(missing.iter().map(|(j, _)| *j));
            columns.sort_unstable();
            columns.dedup();
            let change = columns.iter().map(|&j| {
                let sign = if bounds.of(j)[1].is_infinite() { 1.0 } else { -1.0 };
                -sign * (sign * self.sum.coefficient(j) + TURNED_BY * most).max(0.0)
            });
            let change: Vec<f64> = change.collect();
            let steps = self.change(facts, &found.facts, &columns, &change);
            for ((fact, y), step) in found.facts.iter_mut().zip(steps) {
                let [lower, upper] = facts.limits(*fact);
                let side = if *y + step > 0.0 { lower } else { upper };
                if side.is_finite() {
                    *y += step;
                }
            }
            if self.check(facts, bounds, found).is_some() {
                return Some(());
            }
        }
        found.facts = kept;
        None
    }

    /// The change of multipliers, small beside them, that changes the coefficients of some columns, by conjugate
    /// gradients.
    fn change(
        &self,
        facts: &Facts,
        multipliers: &[(usize, f64)],
        columns: &[usize],
        change: &[f64],
    ) -> Vec<f64> {
        let mut place = vec![usize::MAX; self.program.column_count()];
        columns.iter().enumerate().for_each(|(k, &j)| place[j] = k);
        let largest = multipliers.iter().map(|(_, y)| y.abs()).fold(f64::MIN_POSITIVE, f64::max);
        // The steps of the multipliers that weights of the columns stand for.
        let steps = |weights: &[f64]| -> Vec<f64> {
            let step = |&(fact, y): &(usize, f64)| {
                let terms = facts.terms(fact).filter_map(|(j, a)| Some(a * weights.get(place[j])?));
                (y / largest).powi(2) * terms.sum::<f64>()
            };
            multipliers.iter().map(step).collect()
        };
        let product = |weights: &[f64]| {
            let mut product = vec![0.0; columns.len()];
            for (&(fact, _), step) in multipliers.iter().zip(steps(weights)) {
                for (j, a) in facts.terms(fact) {
                    if let Some(entry) = product.get_mut(place[j]) {
                        *entry += a * step;
                    }
                }
            }
            product
        };
        let diagonal = vec![1.0; columns.len()];
        steps(&conjugate_gradients(product, &diagonal, change, MOST_CHANGE_STEPS))
    }
}
