//! Numbers with as many digits as the run of an unstable system needs.
//!
//! Most runs need no more than floats with a bound of their rounding. Beyond, a value is a sum of
//! floats that do not overlap (J. R. Shewchuk, "Adaptive precision floating-point arithmetic and
//! fast robust geometric predicates", Discrete & Computational Geometry 18, 1997, sections 2.4 and
//! 2.8). Only so many are kept; what is dropped is added up.

use crate::sum::{exact_product, exact_sum};

/// The rounding of the sums of what is dropped (no unit).
const UPWARD: f64 = 1.0 + 1e-9;

/// A number of a run, with a bound of what it has lost.
pub(super) trait RunNumber: Clone {
    fn new(value: f64) -> Self;

    /// The number less a float, as a float; NaN or infinite if it has left their range.
    fn minus(&self, value: f64) -> f64;

    /// The most by which the number differs from what it stands for.
    fn lost(&self) -> f64;

    /// Adds the product of two floats.
    fn add_product(&mut self, a: f64, b: f64);

    /// Adds a multiple of another number.
    fn add_multiple(&mut self, factor: f64, other: &Self);

    /// Keeps so many parts, if it has more.
    fn keep(&mut self, most: usize);
}

/// A float and a bound of its rounding.
#[derive(Debug, Clone, Copy)]
pub(super) struct RoundedFloat {
    value: f64,
    lost: f64,
}

impl RunNumber for RoundedFloat {
    fn new(value: f64) -> Self {
        RoundedFloat { value, lost: 0.0 }
    }

    fn minus(&self, value: f64) -> f64 {
        self.value - value
    }

    fn lost(&self) -> f64 {
        self.lost
    }

    fn add_product(&mut self, a: f64, b: f64) {
        let product = a * b;
        self.value += product;
        // Twice the rounding of the two operations.
        self.lost += f64::EPSILON * (product.abs() + self.value.abs());
    }

    fn add_multiple(&mut self, factor: f64, other: &Self) {
        self.add_product(factor, other.value);
        self.lost = (self.lost + factor.abs() * other.lost) * UPWARD;
    }

    fn keep(&mut self, _most: usize) {}
}

/// A number as a sum of floats.
#[derive(Debug, Clone)]
pub(super) struct Digits {
    /// In ascending order of magnitude.
    parts: Vec<f64>,
    /// The most by which the sum differs from the number.
    lost: f64,
}

impl Digits {
    /// The number as a float; NaN or infinite if it has left their range.
    pub(super) fn value(&self) -> f64 {
        self.parts.iter().sum()
    }

    fn add(&mut self, value: f64) {
        let (mut sum, mut kept) = (value, 0);
        for k in 0..self.parts.len() {
            let (next, rest) = exact_sum(sum, self.parts[k]);
            sum = next;
            if rest != 0.0 {
                self.parts[kept] = rest;
                kept += 1;
            }
        }
        self.parts.truncate(kept);
        if sum != 0.0 {
            self.parts.push(sum);
        }
    }
}

impl RunNumber for Digits {
    fn new(value: f64) -> Self {
        Digits { parts: vec![value], lost: 0.0 }
    }

    fn minus(&self, value: f64) -> f64 {
        let mut difference = self.clone();
        difference.add(-value);
        difference.value()
    }

    fn lost(&self) -> f64 {
        self.lost
    }

    fn add_product(&mut self, a: f64, b: f64) {
        let (product, rest) = exact_product(a, b);
        self.add(rest);
        self.add(product);
    }

    fn add_multiple(&mut self, factor: f64, other: &Digits) {
        for &part in &other.parts {
            self.add_product(factor, part);
        }
        self.lost = (self.lost + factor.abs() * other.lost) * UPWARD;
    }

    /// Makes the parts as few as they can be, and drops the smallest beyond the first `most`.
    fn keep(&mut self, most: usize) {
        let Some(mut rest) = self.parts.pop() else { return };
        let mut kept = Vec::with_capacity(most + 1);
        for part in self.parts.drain(..).rev() {
            let (sum, small) = exact_sum(rest, part);
            rest = sum;
            if small != 0.0 {
                kept.push(sum);
                rest = small;
            }
        }
        kept.push(rest);
        let dropped: f64 = kept.iter().skip(most).map(|part| part.abs()).sum();
        self.lost = (self.lost + dropped) * UPWARD;
        kept.truncate(most);
        kept.reverse();
        self.parts = kept;
    }
}
