//! Second-order cones as the polynomials that they keep from falling below 0: a quadratic row and
//! the cone that it becomes are the same polynomial but for rounding and a positive factor.

use std::collections::BTreeMap;

/// How much the coefficients of two polynomials may differ, relative to them (no unit): the roots
/// in a cone are rounded.
const ROUNDING: f64 = 1e-9;

/// The same, relative to what they are the sum of.
const ROUNDING_OF_SUMS: f64 = 16.0 * f64::EPSILON;

/// How much larger than the largest coefficient the terms of one may be that cancel (no unit):
/// beyond it, nothing can be said of the others.
const LARGEST_CANCELLATION: f64 = 1e6;

/// Stands for 1 in the place of a column.
const ONE: u32 = u32::MAX;

/// A linear form with a constant.
#[derive(Debug, Clone, Default)]
pub(super) struct Affine {
    pub(super) terms: Vec<(u32, f64)>,
    pub(super) constant: f64,
}

impl Affine {
    pub(super) fn column(column: u32) -> Self {
        Affine { terms: vec![(column, 1.0)], constant: 0.0 }
    }

    pub(super) fn constant(constant: f64) -> Self {
        Affine { terms: Vec::new(), constant }
    }

    /// Adds a multiple of a form.
    pub(super) fn add(&mut self, factor: f64, other: &Affine) {
        self.terms.extend(other.terms.iter().map(|&(column, value)| (column, factor * value)));
        self.constant += factor * other.constant;
    }

    fn factors(&self) -> impl Iterator<Item = (u32, f64)> {
        self.terms.iter().copied().chain([(ONE, self.constant)])
    }
}

/// A sum of products of two columns, of columns and a constant.
#[derive(Debug, Clone, Default)]
pub(super) struct Polynomial {
    /// By the two columns, the coefficient, and the sizes of what it is the sum of.
    terms: BTreeMap<(u32, u32), (f64, f64)>,
}

impl Polynomial {
    fn add(&mut self, (i, j): (u32, u32), value: f64) {
        let entry = self.terms.entry((i.min(j), i.max(j))).or_default();
        entry.0 += value;
        entry.1 += value.abs();
    }

    pub(super) fn add_affine(&mut self, factor: f64, form: &Affine) {
        form.factors().for_each(|(column, value)| self.add((column, ONE), factor * value));
    }

    /// Adds a multiple of two columns' product.
    pub(super) fn add_square(&mut self, columns: (u32, u32), value: f64) {
        self.add(columns, value);
    }

    pub(super) fn add_product(&mut self, factor: f64, a: &Affine, b: &Affine) {
        for (i, p) in a.factors() {
            for (j, q) in b.factors() {
                self.add((i, j), factor * p * q);
            }
        }
    }

    /// Whether it has a product of columns.
    pub(super) fn has_products(&self) -> bool {
        self.terms.iter().any(|(&(_, j), &(value, _))| j != ONE && value != 0.0)
    }

    /// Its columns, perhaps several times.
    pub(super) fn columns(&self) -> impl Iterator<Item = u32> {
        self.terms.keys().flat_map(|&(i, j)| [i, j]).filter(|column| *column != ONE)
    }

    /// A linear form.
    pub(super) fn of(form: &Affine) -> Self {
        let mut polynomial = Polynomial::default();
        polynomial.add_affine(1.0, form);
        polynomial
    }

    /// The same with other numbers of columns.
    pub(super) fn renumbered(&self, at: impl Fn(u32) -> u32) -> Self {
        let at = |column: u32| if column == ONE { ONE } else { at(column) };
        let mut other = Polynomial::default();
        for (&(i, j), &(value, size)) in &self.terms {
            let (i, j) = (at(i), at(j));
            let entry = other.terms.entry((i.min(j), i.max(j))).or_default();
            (entry.0, entry.1) = (entry.0 + value, entry.1 + size);
        }
        other
    }

    /// Whether it is a positive multiple of another one, but for rounding.
    pub(super) fn is_multiple(&self, other: &Polynomial) -> bool {
        let of = |polynomial: &Polynomial, key: &(u32, u32)| {
            polynomial.terms.get(key).copied().unwrap_or_default()
        };
        let largest = other.terms.iter().max_by(|a, b| a.1.0.abs().total_cmp(&b.1.0.abs()));
        let Some((key, &(value, _))) = largest else { return false };
        let ratio = of(self, key).0 / value;
        let most = self.terms.values().map(|term| term.0.abs()).fold(0.0, f64::max);
        let is_same = |key: &(u32, u32)| {
            let ((a, size), (b, other)) = (of(self, key), of(other, key));
            let allowed =
                ROUNDING * (a.abs() + ratio * b.abs()) + ROUNDING_OF_SUMS * (size + ratio * other);
            (a - ratio * b).abs() <= allowed && size <= LARGEST_CANCELLATION * most
        };
        ratio > 0.0 && ratio.is_finite() && self.terms.keys().chain(other.terms.keys()).all(is_same)
    }
}
