//! Learning from conflicts changes no answer.

use carom::prelude::*;
use carom::solver::PoolMode;
use proptest::prelude::*;

use super::{knapsack, parity};
use crate::common::config;
use crate::common::enumeration::all_optima;
use crate::common::generate::{Shape, case};

/// Shapes that a search may learn from.
fn shape() -> impl Strategy<Value = Shape> {
    prop_oneof![
        Just(Shape::LINEAR),
        Just(Shape::QUADRATIC),
        Just(Shape::SCALED),
        Just(Shape::BOUNDED),
        Just(Shape::FEASIBILITY),
    ]
}

proptest! {
    #![proptest_config(config(200, "tests/regressions/conflicts_search.txt"))]

    #[test]
    fn optima_stay_the_same(
        case in shape().prop_flat_map(case),
        threads in 1..=2_usize,
        deterministic in any::<bool>(),
        presolve in any::<bool>(),
    ) {
        let (model, _) = case.build();
        let solve = |conflicts: bool| {
            let options = Options::default()
                .with_presolve(presolve)
                .with_threads(threads)
                .with_deterministic(deterministic)
                .with_conflicts(conflicts);
            BranchAndBound::new(options).solve(&model).unwrap()
        };
        let (with, without) = (solve(true), solve(false));
        prop_assert_eq!(with.termination(), without.termination());
        if let (Some(a), Some(b)) = (with.objective(), without.objective()) {
            prop_assert!((a - b).abs() <= 1e-5 * b.abs().max(1.0), "{} instead of {}", a, b);
        }
        prop_assert_eq!(without.statistics().conflicts, 0);
    }

    /// Points of a pool lie beyond many cutoffs that no-goods were learned under.
    #[test]
    fn pools_stay_the_same(
        case in case(Shape::BOUNDED),
        size in 2..=6_usize,
        threads in 1..=2_usize,
        deterministic in any::<bool>(),
    ) {
        let (model, _) = case.build();
        let options = Options::default()
            .with_pool(size, PoolMode::Best)
            .with_threads(threads)
            .with_deterministic(deterministic)
            .with_conflicts(true);
        let solution = BranchAndBound::new(options).solve(&model).unwrap();
        let wanted = all_optima(&case);
        let found: Vec<f64> =
            solution.pool().iter().map(|p| case.sign() * p.objective()).collect();
        prop_assert_eq!(found.len(), size.min(wanted.len()));
        for (found, (_, value)) in found.iter().zip(&wanted) {
            prop_assert!((found - value).abs() < 1e-5 * value.abs().max(1.0));
        }
    }
}

#[test]
fn a_search_learns_and_uses_it() {
    let options = Options::default().with_presolve(false);
    let solve = |conflicts: bool| {
        let mut solver = BranchAndBound::new(options.clone().with_conflicts(conflicts));
        solver.solve(&knapsack(30, 4)).unwrap()
    };
    let (with, without) = (solve(true), solve(false));
    assert_eq!(with.objective(), without.objective());
    let s = with.statistics();
    assert!(s.conflicts > 0 && s.fixed_by_no_goods + s.refuted_by_no_goods > 0, "{s:?}");
}

/// Each worker of the rounds learns for itself: the search is the same on any number of threads.
#[test]
fn rounds_learn_the_same_on_any_number_of_threads() {
    for (model, learns) in [(knapsack(30, 4), true), (knapsack(25, 1), false), (parity(12), false)]
    {
        let solve = |threads: usize| {
            let options = Options::default()
                .with_deterministic(true)
                .with_threads(threads)
                .with_presolve(false)
                .with_conflicts(true)
                .with_node_limit(3000);
            let solution = BranchAndBound::new(options).solve(&model).unwrap();
            (solution.statistics().without_times(), solution.objective())
        };
        let (one, two) = (solve(1), solve(2));
        assert_eq!(one, two);
        assert!(one.0.conflicts > 0 || !learns);
    }
}
