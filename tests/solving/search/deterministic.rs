//! The same nodes, counts and answer for any number of threads; and the right answer on several.

use carom::prelude::*;
use carom::solver::PoolMode;
use proptest::prelude::*;

use super::{knapsack, parity};
use crate::common::config;
use crate::common::generate::{Shape, case};
use crate::common::judge::is_right;
use crate::instances::generators::{boxes, pendulum, puck, wall};

/// All of a solution that must not depend on the threads.
fn trace(options: &Options, model: &Model, threads: usize) -> String {
    let options = options.clone().with_deterministic(true).with_threads(threads);
    let solution = BranchAndBound::new(options).solve(model).unwrap();
    let statistics = solution.statistics();
    assert!(statistics.threads <= threads as u64);
    let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<u64>>();
    let pool: Vec<_> = solution.pool().iter().map(|p| bits(p.point().as_slice())).collect();
    format!(
        "{} {} {:?} {pool:?} {:?}",
        solution.termination(),
        solution.bound().to_bits(),
        statistics.without_times(),
        solution.leaves(),
    )
}

fn check(options: &Options, model: &Model) {
    let one = trace(options, model, 1);
    for threads in [2, 4] {
        assert_eq!(trace(options, model, threads), one, "{threads} threads");
    }
}

#[test]
fn control_programs() {
    for model in [
        pendulum(12, [0.0, 0.8], false),
        boxes(12, 4, false),
        boxes(12, 4, true),
        puck(15, 0.33),
        wall(60, 0.05, 0.5, true),
        wall(122, 0.02, 0.5, false),
    ] {
        check(&Options::default(), &model);
    }
}

#[test]
fn knapsacks_and_limits() {
    for seed in 0..4 {
        check(&Options::default(), &knapsack(18, seed));
    }
    let model = knapsack(16, 7);
    for options in [
        Options::default().with_node_limit(13),
        Options::default().with_memory_limit(1500),
        Options::default().with_pool(5, PoolMode::Best),
        Options::default().with_pool(5, PoolMode::Found).with_leaves(true),
        Options::precise(),
    ] {
        check(&options, &model);
    }
    check(&Options::default().with_node_limit(40), &parity(24));
}

proptest! {
    #![proptest_config(config(40, "tests/regressions/threads.txt"))]

    /// Rounds on one and on three threads are the same and right; and three threads that exchange
    /// everything at once are right.
    #[test]
    fn threads_find_the_optimum(case in case(Shape::QUADRATIC)) {
        let (model, _) = case.build();
        prop_assert_eq!(
            trace(&Options::default(), &model, 1),
            trace(&Options::default(), &model, 3)
        );
        for deterministic in [false, true] {
            let options = Options::default().with_threads(3).with_deterministic(deterministic);
            let solution = BranchAndBound::new(options).solve(&model).unwrap();
            is_right(&case, &solution)?;
        }
    }
}
