//! How much probing nodes get.

use carom_solver::internals::search::node_probing::NodeProbing;

/// Most trials at a node, and those that are always allowed.
const MOST: usize = 200;
const ALWAYS: usize = 4;

#[test]
fn probing_that_brings_nothing_ends_and_comes_back() {
    let mut probing = NodeProbing::new(0);
    for _ in 0..100 {
        probing.book(probing.trials().most, 0, false);
    }
    assert_eq!(probing.trials().most, ALWAYS);
    for _ in 0..50 {
        probing.book(probing.trials().most, 20, false);
    }
    assert_eq!(probing.trials().most, MOST);
}
