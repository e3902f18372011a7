//! Sums of two floats.

use carom_solver::internals::relaxation::Extended;

#[test]
fn keeps_what_floats_lose() {
    let third = 1.0 / 3.0;
    // 3 * (1/3 rounded) - 1 = -2^-54 exactly.
    let residual = Extended::from(-1.0).plus_product(3.0.into(), third.into());
    assert_eq!(residual.high + residual.low, -(0.5_f64.powi(54)));
    let sum = Extended::from(1e17).plus(1.0).plus(-1e17);
    assert_eq!(sum, 1.0.into());
    let fine = Extended { high: 1.0, low: 1e-20 };
    assert_eq!(Extended::from(-1.0).plus_product(fine, 1.0.into()).high, 1e-20);
}
