//! Compensated sums keep digits that plain ones lose.

use carom_model::internals::sum::Sum;

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
