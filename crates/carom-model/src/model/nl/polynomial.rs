//! Polynomials of degree two over the columns of a file, with nonlinear expressions beside them, in
//! which an expression ends.

use crate::model::affine::Affine;
use crate::model::ids::{ModelTag, Variable};
use crate::model::nonlinear::Nonlinear;
use crate::model::quadratic::Quadratic;

/// `constant + sum a_j x_j + sum q_jk x_j x_k + functions`, with terms in any order, some of them
/// several times.
#[derive(Debug, Clone, Default)]
pub(super) struct Polynomial {
    pub(super) constant: f64,
    pub(super) linear: Vec<(usize, f64)>,
    /// Products with the smaller column first.
    pub(super) products: Vec<((usize, usize), f64)>,
    /// The rest, which is not quadratic, over the variables of the model that is to be.
    pub(super) functions: Nonlinear,
}

impl Polynomial {
    pub(super) fn constant(value: f64) -> Self {
        Polynomial { constant: value, ..Polynomial::default() }
    }

    pub(super) fn column(column: usize) -> Self {
        Polynomial { linear: vec![(column, 1.0)], ..Polynomial::default() }
    }

    /// The value, if it is a constant.
    pub(super) fn as_constant(&self) -> Option<f64> {
        let is_constant = self.linear.is_empty() && self.products.is_empty();
        (is_constant && self.functions.is_zero()).then_some(self.constant)
    }

    pub(super) fn scaled(mut self, factor: f64) -> Self {
        self.constant *= factor;
        self.linear.iter_mut().for_each(|(_, a)| *a *= factor);
        self.products.iter_mut().for_each(|(_, q)| *q *= factor);
        self.functions.scale(factor);
        self
    }

    /// The sum; the terms of the shorter one are moved.
    pub(super) fn plus(mut self, mut other: Polynomial) -> Self {
        if self.linear.len() + self.products.len() < other.linear.len() + other.products.len() {
            std::mem::swap(&mut self, &mut other);
        }
        self.constant += other.constant;
        self.linear.append(&mut other.linear);
        self.products.append(&mut other.products);
        self.functions.append(&other.functions, 1.0);
        self
    }

    /// The quadratic part over the variables of a model.
    pub(super) fn quadratic(&self, tag: ModelTag) -> Quadratic {
        let mut affine = Affine::constant(self.constant);
        self.linear.iter().for_each(|&(k, a)| affine.add_term(a, Variable::new(k, tag)));
        let mut sum = Quadratic::from(affine);
        for &((i, j), factor) in &self.products {
            sum.add_product(factor, Variable::new(i, tag), Variable::new(j, tag));
        }
        sum
    }

    /// The whole over the variables of a model.
    pub(super) fn into_nonlinear(self, tag: ModelTag) -> Nonlinear {
        let mut whole = Nonlinear::from(self.quadratic(tag));
        whole.append(&self.functions, 1.0);
        whole
    }

    /// A nonlinear expression.
    pub(super) fn of(functions: Nonlinear) -> Self {
        Polynomial { functions, ..Polynomial::default() }
    }

    /// The product; a nonlinear expression if its degree is more than two.
    pub(super) fn times(self, other: Polynomial, tag: ModelTag) -> Self {
        let (left, right) = (self.merged(), other.merged());
        if let Some(factor) = right.as_constant() {
            return left.scaled(factor);
        }
        if let Some(factor) = left.as_constant() {
            return right.scaled(factor);
        }
        let is_affine = |of: &Polynomial| of.products.is_empty() && of.functions.is_zero();
        if !is_affine(&left) || !is_affine(&right) {
            let (left, right) = (left.into_nonlinear(tag), right.into_nonlinear(tag));
            return Polynomial::of(Nonlinear::product(left, right));
        }
        let mut product = Polynomial::constant(left.constant * right.constant);
        for &(i, a) in &left.linear {
            let pairs = right.linear.iter().map(|&(j, b)| ((i.min(j), i.max(j)), a * b));
            product.products.extend(pairs);
        }
        let by = |terms: &[(usize, f64)], factor: f64| -> Vec<(usize, f64)> {
            terms.iter().filter(|_| factor != 0.0).map(|&(j, a)| (j, a * factor)).collect()
        };
        product.linear = by(&left.linear, right.constant);
        product.linear.extend(by(&right.linear, left.constant));
        product
    }

    /// With each term once, and none that is 0.
    pub(super) fn merged(mut self) -> Self {
        merge(&mut self.linear);
        merge(&mut self.products);
        self
    }
}

fn merge<K: Ord + Copy>(terms: &mut Vec<(K, f64)>) {
    if !terms.is_sorted_by(|a, b| a.0 < b.0) {
        terms.sort_by_key(|term| term.0);
        terms.dedup_by(|later, kept| {
            let is_same = later.0 == kept.0;
            kept.1 += if is_same { later.1 } else { 0.0 };
            is_same
        });
    }
    terms.retain(|term| term.1 != 0.0);
}
