//! How fast a tree grows.

use carom_solver::internals::search::branching::growth_rate;

#[test]
fn rates_of_growth() {
    let close = |gains: &[f64], rate: f64| {
        let found = growth_rate(gains);
        assert!((found - rate).abs() <= 1e-4 * rate, "{gains:?}: {found}");
    };
    close(&[1.0, 1.0], 2.0_f64.ln());
    close(&[0.5, 0.5, 0.5], 2.0 * 3.0_f64.ln());
    // The golden ratio.
    close(&[1.0, 2.0], ((1.0 + 5.0_f64.sqrt()) / 2.0).ln());
    // A child that gains nothing is worse than a third one that gains something.
    assert!(growth_rate(&[1.0, 1e-9]) > growth_rate(&[1.0, 1.0, 1.0]));
}
