//! Sums and products rounded outward.

/// The next float above a finite `value`; returns infinities and NaN unchanged.
#[inline]
pub(crate) fn up(value: f64) -> f64 {
    if value.is_finite() { value.next_up() } else { value }
}

/// The next float below a finite `value`; returns infinities and NaN unchanged.
#[inline]
pub(crate) fn down(value: f64) -> f64 {
    if value.is_finite() { value.next_down() } else { value }
}

/// Whether `sum` is exactly `a + b` (Knuth's two-sum).
#[inline]
pub(crate) fn is_exact_sum(a: f64, b: f64, sum: f64) -> bool {
    let rest = sum - a;
    (a - (sum - rest)) + (b - rest) == 0.0
}

/// Whether `product` is exactly `a * b`; products near underflow count as inexact.
#[inline]
pub(crate) fn is_exact_product(a: f64, b: f64, product: f64) -> bool {
    product == 0.0 && (a == 0.0 || b == 0.0)
        || product.abs() > 1e-250 && a.mul_add(b, -product) == 0.0
}

/// `a + b`, rounded down if inexact.
#[inline]
pub fn add_down(a: f64, b: f64) -> f64 {
    let sum = a + b;
    if is_exact_sum(a, b, sum) { sum } else { down(sum) }
}

/// `a + b`, rounded up if inexact.
#[inline]
pub fn add_up(a: f64, b: f64) -> f64 {
    let sum = a + b;
    if is_exact_sum(a, b, sum) { sum } else { up(sum) }
}
