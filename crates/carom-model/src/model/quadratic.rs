//! Quadratic expressions, for objectives and rows.

use super::affine::Affine;
use super::ids::Variable;

/// A quadratic expression `affine + sum q_jk x_j x_k`.
///
/// Made by multiplying two affine expressions or by [`Affine::square`].
///
/// ```
/// use carom::prelude::*;
///
/// let mut model = Model::new("m");
/// let x = model.continuous("x", -1.0, 1.0)?;
/// let y = model.continuous("y", -1.0, 1.0)?;
/// let e = (x - y).square() + 3.0 * x;
/// assert_eq!(e.evaluate(|v| if v == x { 1.0 } else { 0.5 }), 3.25);
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Quadratic {
    /// Products with the smaller variable first; merged on reading.
    products: Vec<(Variable, Variable, f64)>,
    affine: Affine,
}

impl Quadratic {
    /// The expression 0.
    #[inline]
    pub fn zero() -> Self {
        Quadratic::default()
    }

    /// The affine part.
    #[inline]
    pub fn affine(&self) -> &Affine {
        &self.affine
    }

    /// The products `(x_j, x_k, q_jk)` with `j <= k`, sorted, merged, without exact zeros. A
    /// square appears as `(x_j, x_j, q_jj)`, with `q_jj` its full coefficient (no factor 1/2).
    pub fn products(&self) -> Vec<(Variable, Variable, f64)> {
        let mut products = self.products.clone();
        merge_products(&mut products);
        products
    }

    /// Adds `coefficient * first * second` in place.
    pub fn add_product(&mut self, coefficient: f64, first: Variable, second: Variable) {
        self.products.push((first.min(second), first.max(second), coefficient));
    }

    /// Value at a point given by a function from variables to values.
    pub fn evaluate(&self, value: impl Fn(Variable) -> f64) -> f64 {
        let mut sum = self.affine.sum(&value);
        for &(a, b, q) in &self.products {
            sum.add_product_of_three(value(a), value(b), q);
        }
        sum.value()
    }

    /// Merges what building left behind.
    #[doc(hidden)]
    pub fn compacted(mut self) -> Self {
        merge_products(&mut self.products);
        let (terms, constant) = self.affine.into_parts();
        let mut affine = Affine::constant(constant);
        terms.iter().for_each(|&(v, a)| affine.add_term(a, v));
        Quadratic { products: self.products, affine }
    }

    #[doc(hidden)]
    pub fn product(left: &Affine, right: &Affine) -> Self {
        let mut result = Quadratic::zero();
        for &(a, p) in left.raw_terms() {
            for &(b, q) in right.raw_terms() {
                result.add_product(p * q, a, b);
            }
        }
        result.affine.append(left, right.offset());
        result.affine.append(right, left.offset());
        // Both lines above carry the product of the constants once.
        result.affine.append(&Affine::constant(left.offset() * right.offset()), -1.0);
        result
    }

    pub(crate) fn scale(&mut self, factor: f64) {
        self.affine.scale(factor);
        for (_, _, q) in &mut self.products {
            *q *= factor;
        }
    }

    pub(crate) fn divide(&mut self, divisor: f64) {
        self.affine.divide(divisor);
        for (_, _, q) in &mut self.products {
            *q /= divisor;
        }
    }

    #[doc(hidden)]
    pub fn append(&mut self, other: &Quadratic, factor: f64) {
        self.products.extend(other.products.iter().map(|&(a, b, q)| (a, b, factor * q)));
        self.affine.append(&other.affine, factor);
    }
}

fn merge_products(products: &mut Vec<(Variable, Variable, f64)>) {
    // A file may name the variables of a product in any order.
    for (first, second, _) in products.iter_mut().filter(|(first, second, _)| first > second) {
        std::mem::swap(first, second);
    }
    if !products.is_sorted_by(|a, b| (a.0, a.1) < (b.0, b.1)) {
        products.sort_by_key(|&(a, b, _)| (a, b));
        products.dedup_by(|later, kept| {
            let same = (later.0, later.1) == (kept.0, kept.1);
            if same {
                kept.2 += later.2;
            }
            same
        });
    }
    products.retain(|&(_, _, q)| q != 0.0);
}

impl Affine {
    /// The square of the expression.
    #[inline]
    pub fn square(&self) -> Quadratic {
        Quadratic::product(self, self)
    }
}

impl Variable {
    /// The square of the variable.
    #[inline]
    pub fn square(self) -> Quadratic {
        Affine::from(self).square()
    }
}

impl PartialEq for Quadratic {
    fn eq(&self, other: &Self) -> bool {
        self.affine == other.affine && self.products() == other.products()
    }
}

impl From<Affine> for Quadratic {
    fn from(affine: Affine) -> Self {
        Quadratic { products: Vec::new(), affine }
    }
}

impl From<&Affine> for Quadratic {
    fn from(affine: &Affine) -> Self {
        Quadratic::from(affine.clone())
    }
}

impl From<Variable> for Quadratic {
    fn from(variable: Variable) -> Self {
        Quadratic::from(Affine::from(variable))
    }
}

impl From<f64> for Quadratic {
    fn from(value: f64) -> Self {
        Quadratic::from(Affine::constant(value))
    }
}

impl From<&Quadratic> for Quadratic {
    fn from(expression: &Quadratic) -> Self {
        expression.clone()
    }
}
