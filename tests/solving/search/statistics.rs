//! Counts that must agree with each other, and presets.

use carom::prelude::*;
use carom::solution::Heuristic;

use super::{knapsack, parity};
use crate::instances::generators::{boxes, pendulum, wall};

#[test]
fn every_node_ends_in_one_way() {
    let limited = Options::default().with_node_limit(9);
    for (model, options) in [
        (knapsack(16, 1), Options::default()),
        (knapsack(16, 1), Options::default().with_threads(2)),
        (knapsack(16, 1), Options::default().with_deterministic(true)),
        (parity(20), limited),
        (pendulum(12, [0.0, 0.8], false), Options::default()),
        (boxes(20, 4, false), Options::default()),
        (wall(122, 0.02, 0.5, false), Options::default()),
    ] {
        let threads = options.threads;
        let solution = BranchAndBound::new(options).solve(&model).unwrap();
        let s = solution.statistics();
        let ends = s.refuted_by_propagation + s.refuted_by_relaxation + s.cut_off + s.leaves;
        assert_eq!(s.nodes, ends + s.split + s.unfinished, "{s:?}");
        assert!(s.depth < s.nodes && s.max_open <= s.nodes);
        assert!(s.iterations >= s.relaxations || s.relaxations == 0);
        assert!(s.threads <= threads as u64);
        assert!(s.tree_bytes > 0 && s.tree_bytes < 1000 * (s.max_open + 2));
        // What is measured is part of what passed, on each thread.
        assert!(s.times.total() <= s.time * threads as u32);
        assert!(s.nodes_per_second() > 0.0);
        let found: u64 = s.heuristics.iter().map(|(_, count)| count.incumbents).sum();
        assert_eq!(found, s.incumbents);
        for heuristic in Heuristic::ALL {
            let count = s.heuristics.of(heuristic);
            assert!(count.incumbents <= count.points && count.points <= count.calls, "{count:?}");
        }
    }
}

/// What an open node costs does not grow with its depth: a path copied for every node would be 24
/// bytes a decision.
#[test]
fn bytes_of_a_node_do_not_grow_with_depth() {
    let options = Options::default().with_node_limit(400);
    let solution = BranchAndBound::new(options).solve(&knapsack(60, 2)).unwrap();
    let s = solution.statistics();
    assert!(s.tree_bytes < 400 * s.max_open + 100 * s.depth + 2000, "{s:?}");
}

#[test]
fn presets_differ_and_agree_on_the_answer() {
    assert_eq!(Options::balanced(), Options::default());
    let (fast, proof) = (Options::fast(), Options::precise());
    assert!(fast.relative_gap > Options::balanced().relative_gap);
    assert!(proof.relative_gap < Options::balanced().relative_gap);
    assert!(proof.deterministic && !fast.deterministic);
    let models = [knapsack(16, 3), boxes(20, 4, true), pendulum(12, [0.0, 0.8], false)];
    for model in &models {
        let solve = |options: Options| BranchAndBound::new(options).solve(model).unwrap();
        let (fast, balanced, proof) =
            (solve(Options::fast()), solve(Options::balanced()), solve(Options::precise()));
        for (solution, gap) in [(&fast, 1e-3), (&balanced, 1e-6), (&proof, 1e-7)] {
            assert!(solution.is_optimal(), "{:?}", solution.termination());
            let objective = solution.objective().unwrap();
            assert!(solution.gap() <= (gap * objective.abs()).max(1.001e-7));
            let best = proof.objective().unwrap();
            assert!((objective - best).abs() <= gap * best.abs().max(1.0) + 1e-6);
        }
        assert!(fast.statistics().nodes <= proof.statistics().nodes + 8);
    }
}
