//! Norm limits of states and inputs: `|entries| <= bound`, as limits, guards and parts of regions.

use super::schedule::Schedule;
use crate::model::{Affine, ConicRow, Norm, norm};
use crate::sum::Sum;

/// `factors . (state, input) + constant`; without coefficients of inputs, it does not depend on
/// them.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct NormEntry {
    pub(crate) factors: Vec<f64>,
    /// By step.
    pub(crate) constant: Schedule<f64>,
}

impl NormEntry {
    /// The constant at a step, of an entry that has been checked.
    pub(crate) fn constant_at(&self, step: usize) -> f64 {
        self.constant.get(step).copied().unwrap_or(0.0)
    }
}

/// A named limit of a length, `|entries| <= bound`, in the unit of the bound.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct NormLimit {
    pub(crate) name: String,
    pub(crate) entries: Vec<NormEntry>,
    pub(crate) bound: NormEntry,
    /// Whether an explanation may drop it.
    pub(crate) is_limit: bool,
}

impl NormLimit {
    /// The length of some entries of a vector of states, or of states and inputs, at most a
    /// constant.
    pub(crate) fn ball(
        name: impl Into<String>,
        entries: impl IntoIterator<Item = usize>,
        width: usize,
        radius: f64,
    ) -> Self {
        let unit = |k: usize| {
            let factors = (0..width).map(|i| if i == k { 1.0 } else { 0.0 }).collect();
            NormEntry { factors, constant: 0.0.into() }
        };
        let bound = NormEntry { factors: vec![0.0; width], constant: radius.into() };
        let entries = entries.into_iter().map(unit).collect();
        NormLimit { name: name.into(), entries, bound, is_limit: true }
    }

    /// The entries, then the bound.
    pub(crate) fn parts(&self) -> impl Iterator<Item = &NormEntry> {
        self.entries.iter().chain([&self.bound])
    }

    /// The same, to be changed.
    pub(super) fn parts_mut(&mut self) -> impl Iterator<Item = &mut NormEntry> {
        self.entries.iter_mut().chain([&mut self.bound])
    }

    /// Whether an input has a coefficient other than 0.
    pub(crate) fn is_joint(&self, states: usize) -> bool {
        self.parts().any(|part| part.factors.iter().skip(states).any(|a| *a != 0.0))
    }

    /// The step from which on it is the same.
    pub(crate) fn settles(&self) -> usize {
        self.parts().map(|part| part.constant.settles()).max().unwrap_or(0)
    }

    /// Whether it depends on the step.
    pub(crate) fn varies(&self) -> bool {
        self.parts().any(|part| part.constant.varies())
    }

    /// The limit from a step on.
    pub(crate) fn since_step(&self, step: usize) -> Self {
        let mut later = self.clone();
        for part in later.parts_mut() {
            part.constant = part.constant.from_step(step);
        }
        later
    }

    /// The same limit of other states: each part's factors as `place` puts them.
    pub(crate) fn placed(&self, place: impl Fn(&[f64]) -> Vec<f64>) -> Self {
        let mut placed = self.clone();
        for part in placed.parts_mut() {
            part.factors = place(&part.factors);
        }
        placed
    }

    /// The row at a step, of the expressions for factors and a constant.
    pub(crate) fn row(&self, step: usize, expression: impl Fn(&[f64], f64) -> Affine) -> ConicRow {
        let at_step = |part: &NormEntry| expression(&part.factors, part.constant_at(step));
        let entries: Norm = norm(self.entries.iter().map(at_step));
        entries.le(at_step(&self.bound))
    }

    /// The largest magnitude that it is made of at a point, in its unit.
    pub(crate) fn size(&self, point: &[f64], step: usize) -> f64 {
        let of = |part: &NormEntry| {
            let terms = part.factors.iter().zip(point).map(|(factor, x)| (factor * x).abs());
            terms.fold(part.constant_at(step).abs(), f64::max)
        };
        self.parts().map(of).fold(0.0, f64::max)
    }

    /// By how much it holds at a point of states, or of states and then inputs, in its unit.
    pub(crate) fn slack(&self, point: &[f64], step: usize) -> f64 {
        let value = |part: &NormEntry| {
            let mut sum = Sum::new(part.constant_at(step));
            for (&factor, &x) in part.factors.iter().zip(point) {
                sum.add_product(factor, x);
            }
            sum.value()
        };
        let length = self.entries.iter().fold(0.0_f64, |length, entry| length.hypot(value(entry)));
        value(&self.bound) - length
    }
}
