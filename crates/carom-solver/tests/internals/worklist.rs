//! The order in which propagation visits rows.

use std::collections::BTreeSet;

use crate::common::config;
use carom_solver::internals::presolve::Worklist;
use proptest::prelude::*;

#[test]
fn a_sweep_takes_what_lies_ahead_and_turns() {
    let mut list = Worklist::new(300_000);
    [5, 299_999, 70, 4096].into_iter().for_each(|row| list.insert(row));
    assert_eq!(list.pop(), Some(5));
    assert_eq!(list.pop(), Some(70));
    // Ahead of the sweep, behind it, and where it is.
    [80, 3, 70].into_iter().for_each(|row| list.insert(row));
    let order: Vec<usize> = std::iter::from_fn(|| list.pop()).collect();
    assert_eq!(order, [70, 80, 4096, 299_999, 3]);
    // An empty list begins again from below.
    [9, 2].into_iter().for_each(|row| list.insert(row));
    assert_eq!(list.pop(), Some(2));
    let mut rest = Vec::new();
    list.drain(|row| rest.push(row));
    assert_eq!(rest, [9]);
    assert_eq!(list.pop(), None);
}

proptest! {
    #![proptest_config(config(256, "tests/regressions/worklist.txt"))]

    #[test]
    fn it_is_a_set_in_the_order_of_sweeps(
        rows in 1usize..10_000,
        steps in proptest::collection::vec((0usize..4, any::<usize>()), 1..300),
    ) {
        let (mut list, mut set) = (Worklist::new(rows), BTreeSet::new());
        let (mut at, mut falling) = (0, false);
        for (what, row) in steps {
            if what > 0 {
                list.insert(row % rows);
                set.insert(row % rows);
                continue;
            }
            let next = |set: &BTreeSet<usize>, falling: bool| match falling {
                true => set.range(..=at).next_back().copied(),
                false => set.range(at..).next().copied(),
            };
            let mut expected = next(&set, falling);
            if expected.is_none() {
                falling = !falling;
                expected = next(&set, falling);
            }
            prop_assert_eq!(list.pop(), expected);
            match expected {
                Some(row) => (at, _) = (row, set.remove(&row)),
                None => (at, falling) = (0, false),
            }
        }
    }
}
