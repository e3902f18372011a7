//! Compensated sums of products.
//!
//! Terms of an objective may be as large as 1e12 and cancel down to 1. The rounding error of each
//! product and each sum is itself a float, so we can add these errors up separately. The result is
//! as accurate as if it had been computed in twice the precision and rounded once.

/// The rounded sum and its rounding error (Knuth).
#[inline]
pub fn exact_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

/// The rounded product and its rounding error (Dekker).
#[inline]
pub fn exact_product(a: f64, b: f64) -> (f64, f64) {
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
pub struct Sum {
    sum: f64,
    rest: f64,
}

impl Sum {
    /// A sum that starts at a value.
    #[inline]
    pub fn new(value: f64) -> Self {
        Sum { sum: value, rest: 0.0 }
    }

    /// Adds a value.
    #[inline]
    pub fn add(&mut self, value: f64) {
        let (sum, error) = exact_sum(self.sum, value);
        self.sum = sum;
        self.rest += error;
    }

    /// Adds the product of two values.
    #[inline]
    pub fn add_product(&mut self, a: f64, b: f64) {
        let (product, error) = exact_product(a, b);
        self.add(product);
        self.rest += error;
    }

    /// Adds the product of three values.
    #[inline]
    pub fn add_product_of_three(&mut self, a: f64, b: f64, c: f64) {
        let (product, error) = exact_product(a, b);
        self.add_product(product, c);
        self.rest += error * c;
    }

    /// The sum. If a term was infinite or NaN, this is the plain sum.
    #[inline]
    pub fn value(self) -> f64 {
        if self.rest.is_finite() { self.sum + self.rest } else { self.sum }
    }
}
