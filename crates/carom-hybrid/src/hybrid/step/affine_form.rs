//! Affine forms of the state and the input at the start of a step.

use crate::activity;
use crate::interval::Interval;

/// An affine form `factors . z + constant` of `z = (state, input)`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct AffineForm {
    pub(crate) factors: Vec<f64>,
    pub(crate) constant: f64,
}

impl AffineForm {
    pub(crate) fn constant(width: usize, constant: f64) -> Self {
        AffineForm { factors: vec![0.0; width], constant }
    }

    pub(crate) fn is_constant(&self) -> bool {
        self.factors.iter().all(|&factor| factor == 0.0)
    }

    pub(crate) fn is_zero(&self) -> bool {
        self.constant == 0.0 && self.is_constant()
    }

    /// Adds a multiple of another map.
    pub(crate) fn add(&mut self, factor: f64, other: &AffineForm) {
        self.constant += factor * other.constant;
        self.factors.iter_mut().zip(&other.factors).for_each(|(own, its)| *own += factor * its);
    }

    pub(crate) fn minus(&self, other: &AffineForm) -> AffineForm {
        let mut difference = self.clone();
        difference.add(-1.0, other);
        difference
    }

    /// By how much it is above a limit.
    pub(crate) fn above(&self, limit: f64) -> AffineForm {
        AffineForm { constant: self.constant - limit, ..self.clone() }
    }

    pub(crate) fn scaled(&self, factor: f64) -> AffineForm {
        let factors = self.factors.iter().map(|a| factor * a).collect();
        AffineForm { factors, constant: factor * self.constant }
    }

    /// All its numbers: the factors, then the constant.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = f64> {
        self.factors.iter().copied().chain([self.constant])
    }

    /// The magnitudes of all its numbers.
    pub(crate) fn magnitudes(&self) -> AffineForm {
        let factors = self.factors.iter().map(|a| a.abs()).collect();
        AffineForm { factors, constant: self.constant.abs() }
    }

    /// Its range over a box.
    pub(crate) fn over(&self, ranges: &[Interval]) -> Interval {
        activity::range(self.constant, self.factors.iter().copied().zip(ranges.iter().copied()))
    }

    /// Its value in numbers.
    pub(crate) fn at(&self, z: &[f64]) -> f64 {
        self.factors.iter().zip(z).map(|(a, z)| a * z).sum::<f64>() + self.constant
    }
}

/// `factors . maps + constant`.
pub(crate) fn combine<'a>(
    factors: impl IntoIterator<Item = f64>,
    maps: impl IntoIterator<Item = &'a AffineForm>,
    width: usize,
    constant: f64,
) -> AffineForm {
    let mut sum = AffineForm::constant(width, constant);
    let terms = factors.into_iter().zip(maps).filter(|(factor, _)| *factor != 0.0);
    terms.for_each(|(factor, map)| sum.add(factor, map));
    sum
}
