//! Splits of integral columns, at whole numbers that a float can count to: no checker accepts
//! others.
//!
//! The bounds of an integral column need not be whole: those of the program are as they were
//! stated. A split at the whole number below such a bound leaves one side empty, and the other one
//! with a bound that is whole.

use super::split_places::{LARGEST_PLACE, is_counted, place_of};
use super::tree::{FRACTIONAL, ProofWriter};
use crate::search::Decision;

impl ProofWriter<'_, '_> {
    /// Whether a decision is a side of a split that a checker accepts.
    pub(super) fn is_split(&self, decision: Decision) -> bool {
        self.relaxer.program.integral[decision.column] && is_counted(place_of(decision))
    }

    /// The split of an integral column near a value; `None` if none is left, or if it is beyond
    /// what is counted.
    fn whole_split(&self, column: usize, near: f64) -> Option<Decision> {
        let [lower, upper] = self.bounds.of(column);
        let rounded = |bound: &f64| bound.is_finite() && *bound != bound.round();
        let value = match [lower, upper].into_iter().find(rounded) {
            Some(bound) => bound.floor(),
            None => {
                // A relaxed point may be slightly beyond a bound.
                let inside = near.floor().max(lower).min(upper - 1.0);
                let counted = inside.clamp(-LARGEST_PLACE, LARGEST_PLACE);
                Some(counted).filter(|at| lower <= *at && *at + 1.0 <= upper)?
            }
        };
        is_counted(value).then_some(Decision { column, is_upper: true, value })
    }

    /// The integral column to split: the most fractional one, or any that is not fixed.
    pub(super) fn own_split(&self, point: Option<&[f64]>) -> Option<Decision> {
        let program = &self.relaxer.program;
        let is_free = |j: &&usize| {
            let [lower, upper] = self.bounds.of(**j);
            lower < upper
        };
        let free = program.integers.iter().filter(is_free);
        if let Some(point) = point {
            let distance = |j: &usize| (point[*j] - point[*j].round()).abs();
            let best = free.clone().max_by(|a, b| distance(a).total_cmp(&distance(b)));
            let best = best.filter(|j| distance(j) > FRACTIONAL);
            if let Some(split) = best.and_then(|&column| self.whole_split(column, point[column])) {
                return Some(split);
            }
        }
        let split = |&column: &usize| {
            let [lower, upper] = self.bounds.of(column);
            let middle = match (lower.is_finite(), upper.is_finite()) {
                (true, true) => 0.5 * lower + 0.5 * upper,
                (true, false) => lower,
                (false, true) => upper - 1.0,
                _ => 0.0,
            };
            Some((self.width(column), self.whole_split(column, middle)?))
        };
        let narrowest = free.filter_map(split).min_by(|a, b| a.0.total_cmp(&b.0));
        narrowest.map(|(_, split)| split)
    }

    pub(super) fn width(&self, column: usize) -> f64 {
        let [lower, upper] = self.bounds.of(column);
        upper - lower
    }
}
