//! Compensated sums of products.
//!
//! Terms of an objective may be as large as 1e12 and cancel down to 1. The rounding error of each
//! product and each sum is itself a float, so we can add these errors up separately. The result is
//! as accurate as if it had been computed in twice the precision and rounded once.

/// The rounded sum and its rounding error (Knuth).
pub(crate) fn exact_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

/// The rounded product and its rounding error (Dekker).
pub(crate) fn exact_product(a: f64, b: f64) -> (f64, f64) {
    let halves = |v: f64| {
        let t = 134_217_729.0 * v; // 2^27 + 1
        let high = t - (t - v);
        (high, v - high)
    };
    let product = a * b;
    let ((a, x), (b, y)) = (halves(a), halves(b));
    (product, ((a * b - product) + a * y + x * b) + x * y)
}

/// A sum together with its accumulated rounding error.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Sum {
    sum: f64,
    rest: f64,
}

impl Sum {
    pub(crate) fn new(value: f64) -> Self {
        Sum { sum: value, rest: 0.0 }
    }

    /// Adds a value.
    pub(crate) fn add(&mut self, value: f64) {
        let (sum, error) = exact_sum(self.sum, value);
        self.sum = sum;
        self.rest += error;
    }

    /// Adds the product of two values.
    pub(crate) fn add_product(&mut self, a: f64, b: f64) {
        let (product, error) = exact_product(a, b);
        self.add(product);
        self.rest += error;
    }

    /// Adds the product of three values.
    pub(crate) fn add_product_of_three(&mut self, a: f64, b: f64, c: f64) {
        let (product, error) = exact_product(a, b);
        self.add_product(product, c);
        self.rest += error * c;
    }

    /// The sum. If a term was infinite or NaN, this is the plain sum.
    pub(crate) fn value(self) -> f64 {
        if self.rest.is_finite() { self.sum + self.rest } else { self.sum }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cancellation_loses_no_digits() {
        let mut sum = Sum::new(1e16);
        sum.add(1.0);
        sum.add(-1e16);
        assert_eq!(sum.value(), 1.0);
    }

    #[test]
    fn products_keep_their_low_digits() {
        let a = 1.0 + f64::EPSILON;
        // (1 + e)^2 - (1 + 2e) is e^2.
        let mut square = Sum::default();
        square.add_product(a, a);
        square.add(-(1.0 + 2.0 * f64::EPSILON));
        assert_eq!(square.value(), f64::EPSILON * f64::EPSILON);
        let mut cube = Sum::default();
        cube.add_product_of_three(a, a, 3.0);
        cube.add_product(-3.0, 1.0 + 2.0 * f64::EPSILON);
        assert_eq!(cube.value(), 3.0 * f64::EPSILON * f64::EPSILON);
    }

    #[test]
    fn infinities_are_kept() {
        let mut sum = Sum::new(1.0);
        sum.add(f64::INFINITY);
        assert_eq!(sum.value(), f64::INFINITY);
        let mut product = Sum::default();
        product.add_product(1e200, 1e200);
        assert_eq!(product.value(), f64::INFINITY);
    }
}
