//! Pseudocosts.

use carom_solver::internals::search::pseudocosts::{LEAST_GAIN, Pseudocosts};

#[test]
fn unknown_columns_are_average() {
    let mut costs = Pseudocosts::new(2);
    assert_eq!(costs.gains(0, 0.5), [LEAST_GAIN; 2]);
    for gain in [1.0, 2.0, 3.0] {
        costs.learn(0, true, gain, 0.5);
    }
    assert!(!costs.known(0) && costs.known_up(0));
    assert_eq!(costs.gain_up(0, 0.5), Some(2.0));
    assert_eq!((costs.gain_up(1, 0.5), costs.gains(1, 0.5)[1]), (None, 2.0));
    // An infinite gain, or that of a column that has hardly moved, teaches nothing.
    costs.learn(0, false, f64::INFINITY, 0.5);
    costs.learn(0, false, 1.0, 0.0);
    assert!(!costs.known(0));
}
