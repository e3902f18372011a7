//! Weighted sums of facts, in floats with bounds on their rounding: what counts as a contradiction
//! here is one in exact arithmetic, too.

use super::bounds::Side;
use crate::sum::{exact_product, exact_sum};

/// Products above this have their errors as floats.
pub(super) const SMALLEST_EXACT: f64 = 1e-250;

/// A sum of terms in twice the precision, and what bounds its rounding error.
#[derive(Debug, Clone, Copy, Default)]
struct Rounded {
    sum: f64,
    /// The rounding errors of the sum and of its products.
    rest: f64,
    size: f64,
    count: f64,
    /// The size of terms that are rounded themselves.
    loose: f64,
    /// Whether anything was rounded.
    is_rounded: bool,
}

impl Rounded {
    fn add_product(&mut self, a: f64, b: f64) {
        let (product, product_error) = exact_product(a, b);
        let (sum, sum_error) = exact_sum(self.sum, product);
        if !(product_error.is_finite() && sum_error.is_finite()) {
            self.loose = f64::INFINITY;
        }
        // Errors of tiny products are lost.
        let is_large = product.abs() > SMALLEST_EXACT || a == 0.0 || b == 0.0;
        let is_exact = product_error == 0.0 && sum_error == 0.0 && is_large;
        self.is_rounded |= !is_exact;
        self.sum = sum;
        self.rest += product_error + sum_error;
        self.size += product.abs();
        self.count += 1.0;
    }

    /// Adds a term that is a product of up to three floats, rounded.
    fn add(&mut self, term: f64) {
        self.add_product(term, 1.0);
        self.is_rounded = true;
        self.loose += term.abs();
    }

    fn value(&self) -> f64 {
        self.sum + self.rest
    }

    /// Twice what the error of the value can be.
    fn error(&self) -> f64 {
        if !self.is_rounded {
            return 0.0;
        }
        let own = f64::EPSILON * self.value().abs();
        let many = f64::EPSILON * (self.count + 4.0);
        own + 4.0
            * (many * many * self.size + f64::EPSILON * self.loose + self.count * SMALLEST_EXACT)
    }
}

/// A weighted sum of facts: `terms >= limit`.
#[derive(Debug, Default)]
pub(super) struct AggregatedRow {
    terms: Vec<Rounded>,
    touched: Vec<usize>,
    limit: Rounded,
}

impl AggregatedRow {
    /// Begins a sum over so many columns.
    pub(super) fn clear(&mut self, columns: usize) {
        for j in self.touched.drain(..) {
            self.terms[j] = Rounded::default();
        }
        self.terms.resize(columns, Rounded::default());
        self.limit = Rounded::default();
    }

    /// Adds a term, the product of two floats.
    pub(super) fn add(&mut self, column: usize, a: f64, b: f64) {
        if a == 0.0 || b == 0.0 {
            return;
        }
        if self.terms[column].count == 0.0 {
            self.touched.push(column);
        }
        self.terms[column].add_product(a, b);
    }

    /// Adds a product of two floats to the limit.
    pub(super) fn add_to_limit(&mut self, a: f64, b: f64) {
        self.limit.add_product(a, b);
    }

    /// Adds a rounded product of three floats to the limit.
    pub(super) fn add_rounded_to_limit(&mut self, product: f64) {
        self.limit.add(product);
    }

    /// The coefficient of a column, rounded.
    pub(super) fn coefficient(&self, column: usize) -> f64 {
        self.terms.get(column).map_or(0.0, Rounded::value)
    }

    /// The columns of the sum.
    pub(super) fn columns(&self) -> &[usize] {
        &self.touched
    }

    /// The limit, rounded.
    pub(super) fn limit(&self) -> f64 {
        self.limit.value()
    }

    /// The columns that keep the sum from being a contradiction because they have no bound on one
    /// side, and how far their coefficients are beyond 0, with rounding.
    pub(super) fn missing(&self, bounds: &dyn Fn(usize) -> [f64; 2]) -> Vec<(usize, f64)> {
        let missing = |&column: &usize| {
            let (term, error) = (self.terms[column], self.terms[column].error());
            let [lower, upper] = bounds(column);
            let excess = match (lower.is_infinite(), upper.is_infinite()) {
                (false, true) => term.value() + error,
                (true, false) => error - term.value(),
                (true, true) => term.value().abs() + error,
                _ => return None,
            };
            (excess > 0.0).then_some((column, excess))
        };
        self.touched.iter().filter_map(missing).collect()
    }

    /// The sides whose bounds make the sum a contradiction: the largest sum of the terms is below
    /// the limit. `None` if they leave room, or if a bound that the sum needs is missing.
    pub(super) fn contradiction(&self, bounds: &dyn Fn(usize) -> [f64; 2]) -> Option<Vec<Side>> {
        let (mut most, mut sides) = (Rounded::default(), Vec::new());
        for &j in &self.touched {
            let (term, error) = (self.terms[j], self.terms[j].error());
            let [lower, upper] = bounds(j);
            let (least, largest) = (term.value() - error, term.value() + error);
            if !error.is_finite() {
                return None;
            }
            let mut worst = f64::NEG_INFINITY;
            if largest > 0.0 {
                sides.push((j, true));
                worst = worst.max(largest * upper);
            }
            if least < 0.0 {
                sides.push((j, false));
                worst = worst.max(least * lower);
            }
            if worst == f64::INFINITY {
                return None;
            }
            if worst > f64::NEG_INFINITY {
                most.add(worst);
            }
        }
        let room = self.limit.value() - self.limit.error() - (most.value() + most.error());
        (room > 0.0).then_some(sides)
    }
}
