//! Sums of facts in which columns that have no bound have coefficients of the wrong sign, by
//! rounding: a small change of all multipliers, and of the tangent's point, turns the signs.
//!
//! Corrections of relaxations (`relaxation/correction.rs`) let coefficients vanish as well as they
//! can. Here each needs its sign without rounding, in sums of lemmas and tangents, too.

use super::bounds::Bounds;
use super::conjugate_gradients::conjugate_gradients;
use super::facts::Facts;
use super::pivoted_solution::pivoted_solution;
use super::relaxed::{FactRefutation, Relaxer};
use crate::tolerance::largest_magnitude;

/// Most changes of the multipliers.
const MOST_CHANGES: usize = 6;

/// Steps of conjugate gradients of a change.
const MOST_CHANGE_STEPS: usize = 200;

/// By how much a sign is turned, as a multiple of the coefficient that is wrong (no unit).
const TURNED_BY: f64 = 2.0;

/// The parts of the largest multiplier below which others are taken for rounding, one try each (no
/// unit).
const SLIGHT_SHARES: [f64; 3] = [0.0, 1e-9, 1e-6];

/// The largest matrix of a change that is solved by elimination.
const MOST_ELIMINATED: usize = 100_000;

/// The least size of an entry of the tangent's point that changes are measured by, as a part of the
/// largest (no unit).
const SLIGHT_ENTRY: f64 = 1e-3;

/// A number that a change moves.
#[derive(Debug, Clone, Copy)]
enum Adjustable {
    /// The multiplier at a place of the sum.
    Fact(usize),
    /// The entry of a column of the tangent's point.
    Entry(usize),
}

impl Relaxer<'_> {
    /// Whether a sum becomes a contradiction by a change of its multipliers, after
    /// [`check`](Self::check) has refused it.
    pub(super) fn check_repaired(
        &mut self,
        facts: &Facts,
        bounds: &Bounds,
        found: &mut FactRefutation,
    ) -> Option<()> {
        let kept = (found.facts.clone(), found.tangent.clone());
        for (share, eliminates) in SLIGHT_SHARES.into_iter().flat_map(|s| [(s, false), (s, true)]) {
            (found.facts, found.tangent) = kept.clone();
            let size = |&(fact, y): &(usize, f64)| {
                y.abs() * largest_magnitude(facts.terms(fact).map(|(_, a)| a))
            };
            let least = share * found.facts.iter().map(size).fold(0.0, f64::max);
            found.facts.retain(|term| size(term) > least);
            if share > 0.0 && found.facts.len() == kept.0.len() {
                continue;
            }
            if self.check(facts, bounds, found).is_some()
                || self.check_changed(facts, bounds, found, eliminates).is_some()
            {
                return Some(());
            }
        }
        (found.facts, found.tangent) = kept;
        None
    }

    /// The same by changes along conjugate gradients, or by elimination.
    fn check_changed(
        &mut self,
        facts: &Facts,
        bounds: &Bounds,
        found: &mut FactRefutation,
        eliminates: bool,
    ) -> Option<()> {
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
                let own = self.sum.coefficient(j);
                let sign = match bounds.of(j).map(f64::is_infinite) {
                    [true, true] => return -own,
                    [_, true] => 1.0,
                    _ => -1.0,
                };
                -sign * (sign * own + TURNED_BY * most).max(0.0)
            });
            let change: Vec<f64> = change.collect();
            let steps = match eliminates {
                true => self.eliminated(facts, bounds, found, (&columns, &change))?,
                false => {
                    let steps = self.change(facts, &found.facts, &columns, &change);
                    steps
                        .into_iter()
                        .enumerate()
                        .map(|(k, step)| (Adjustable::Fact(k), step))
                        .collect()
                }
            };
            self.moved(facts, found, steps);
            if self.check(facts, bounds, found).is_some() {
                return Some(());
            }
        }
        None
    }

    fn moved(&self, facts: &Facts, found: &mut FactRefutation, steps: Vec<(Adjustable, f64)>) {
        let mut point = vec![0.0; self.program.column_count()];
        found.tangent.iter().flatten().for_each(|&(j, p)| point[j] = p);
        for (mover, step) in steps {
            match mover {
                Adjustable::Fact(k) => {
                    let (fact, y) = &mut found.facts[k];
                    let [lower, upper] = facts.limits(*fact);
                    let side = if *y + step > 0.0 { lower } else { upper };
                    if side.is_finite() {
                        *y += step;
                    }
                }
                Adjustable::Entry(j) => point[j] += step,
            }
        }
        if let Some(tangent) = &mut found.tangent {
            *tangent = self.tangent_point(&point);
        }
    }

    /// The change that gives the coefficients of some columns theirs, by elimination with the
    /// largest pivots; `None` if there is too much to eliminate.
    fn eliminated(
        &self,
        facts: &Facts,
        bounds: &Bounds,
        found: &FactRefutation,
        (columns, change): (&[usize], &[f64]),
    ) -> Option<Vec<(Adjustable, f64)>> {
        let mut place = vec![usize::MAX; self.program.column_count()];
        columns.iter().enumerate().for_each(|(k, &j)| place[j] = k);
        let (mut movers, mut vectors) = (Vec::new(), Vec::new());
        let mut add = |mover, size: f64, terms: &mut dyn Iterator<Item = (usize, f64)>| {
            let mut vector = vec![0.0; columns.len()];
            let mut is_empty = true;
            for (j, a) in terms {
                if let Some(entry) = vector.get_mut(place[j]) {
                    *entry += a * size;
                    is_empty = false;
                }
            }
            if !is_empty {
                movers.push((mover, size));
                vectors.push(vector);
            }
            vectors.len() * columns.len() <= MOST_ELIMINATED
        };
        for (k, &(fact, y)) in found.facts.iter().enumerate() {
            if !add(Adjustable::Fact(k), y.abs(), &mut facts.terms(fact)) {
                return None;
            }
        }
        if let Some(tangent) = &found.tangent {
            let most = tangent.iter().map(|(_, p)| p.abs()).fold(1.0, f64::max);
            for j in 0..self.program.column_count() {
                let (rows, values) = self.program.quadratic_column(j);
                let [lower, upper] = bounds.of(j);
                if rows.is_empty() || lower == upper {
                    continue;
                }
                let p = tangent.binary_search_by_key(&j, |(column, _)| *column);
                let p = p.map_or(0.0, |k| tangent[k].1.abs());
                let mut terms = rows.iter().zip(values).map(|(&i, a)| (i, -a));
                if !add(Adjustable::Entry(j), p.max(SLIGHT_ENTRY * most), &mut terms) {
                    return None;
                }
            }
        }
        let steps = pivoted_solution(&vectors, change);
        Some(movers.into_iter().zip(steps).map(|((mover, size), z)| (mover, size * z)).collect())
    }

    /// The change of multipliers, small beside them, that changes the coefficients of some columns,
    /// by conjugate gradients.
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
