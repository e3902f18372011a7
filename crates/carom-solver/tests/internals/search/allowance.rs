//! The budget of a heuristic.

use carom_solver::internals::search::heuristics::Allowance;

/// Iterations of a free start.
const START: u64 = 50;

#[test]
fn what_finds_nothing_is_called_ever_less() {
    let run = |success: bool| {
        let (mut allowance, mut spent) = (Allowance::default(), 0);
        for total in (0..100_000).step_by(100) {
            if allowance.left(total, false) >= 50 {
                allowance.book(50, success);
                spent += 50;
            }
        }
        spent
    };
    assert!((13_000..=15_000).contains(&run(true)));
    assert!(run(false) < 3_000, "{}", run(false));
}

#[test]
fn before_the_first_point_a_little_is_free() {
    let mut allowance = Allowance::default();
    assert_eq!((allowance.left(0, false), allowance.left(0, true)), (0, START));
    allowance.book(START, false);
    assert_eq!(allowance.left(0, true), 0);
}
