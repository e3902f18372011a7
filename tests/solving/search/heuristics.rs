//! Heuristics on and off: the answer never changes, each of them finds points, and limits hold
//! inside their small searches.

use carom::prelude::*;
use carom::solution::Heuristic;
use carom::solver::Heuristics;
use proptest::prelude::*;
use std::time::Duration;

use super::{knapsack, parity};
use crate::common::config;
use crate::common::generate::{Shape, case};
use crate::common::judge::is_right;
use crate::instances::generators::{boxes, pendulum, wall};

/// The heuristics whose bits are set.
fn chosen(bits: u8) -> Heuristics {
    let mut heuristics = Heuristics::none();
    heuristics.rounding = bits & 1 != 0;
    heuristics.diving = bits & 2 != 0;
    heuristics.neighbourhood = bits & 4 != 0;
    heuristics.roll_out = bits & 8 != 0;
    heuristics
}

const SWITCHED: [Heuristic; 4] =
    [Heuristic::Rounding, Heuristic::Diving, Heuristic::Neighbourhood, Heuristic::RollOut];

fn options(heuristics: Heuristics) -> Options {
    Options::default().with_heuristics(heuristics)
}

fn solve(options: Options, model: &Model) -> Solution {
    BranchAndBound::new(options).solve(model).unwrap()
}

proptest! {
    #![proptest_config(config(48, "tests/regressions/heuristics.txt"))]

    #[test]
    fn any_choice_finds_the_optimum(
        case in case(Shape::QUADRATIC),
        bits in 0..16_u8,
        threads in 1..=3_usize,
        deterministic in any::<bool>(),
    ) {
        let (model, _) = case.build();
        let options = options(chosen(bits)).with_threads(threads).with_deterministic(deterministic);
        let solution = solve(options, &model);
        is_right(&case, &solution)?;
    }

    /// Time limits and interrupts at any moment, small searches included.
    #[test]
    fn small_searches_end_with_the_search(
        micros in 0..60_000_u64,
        by_interrupt in any::<bool>(),
        threads in 1..=2_usize,
        bytes in prop_oneof![Just(None), (500..20_000_u64).prop_map(Some)],
    ) {
        let model = knapsack(40, 3);
        let span = Duration::from_micros(micros);
        let mut options = options(Heuristics::default()).with_threads(threads);
        options.memory_limit = bytes;
        let interrupt = Interrupt::new();
        let solution = std::thread::scope(|scope| {
            if by_interrupt {
                scope.spawn(|| {
                    std::thread::sleep(span);
                    interrupt.trigger();
                });
            } else {
                options.time_limit = Some(span);
            }
            let mut control = Control::default().with_interrupt(&interrupt);
            BranchAndBound::new(options).solve_with(&model, &mut control).unwrap()
        });
        let ended = solution.termination();
        prop_assert!(ended.is_limit() || ended == Termination::Optimal, "{ended}");
        if let Some(objective) = solution.objective() {
            prop_assert!(solution.verification().is_some_and(|v| v.holds()));
            prop_assert!(objective <= solution.bound() + 1e-6);
        }
    }
}

#[test]
fn each_heuristic_finds_points_on_its_own() {
    for (bits, heuristic, nodes) in
        [(1, Heuristic::Rounding, 1), (2, Heuristic::Diving, 1), (4, Heuristic::Neighbourhood, 600)]
    {
        let (mut points, mut incumbents) = (0, 0);
        for seed in 0..8 {
            let options = options(chosen(bits)).with_node_limit(nodes);
            let solution = solve(options, &knapsack(80, seed));
            let statistics = solution.statistics();
            let count = statistics.heuristics.of(heuristic);
            points += count.points;
            incumbents += count.incumbents;
            for other in SWITCHED {
                let calls = statistics.heuristics.of(other).calls;
                assert!(other == heuristic || calls == 0, "{other} beside {heuristic}");
            }
            assert!(bits & 4 != 0 || statistics.nested_nodes == 0);
            assert!(statistics.nested_nodes <= 200 * count.calls);
            assert!(statistics.nodes <= nodes && count.relaxations <= statistics.relaxations);
            if points > 0 && incumbents > 0 {
                break;
            }
        }
        assert!(points > 0 && incumbents > 0, "{heuristic}: {points} points, {incumbents}");
    }
}

/// The relaxation of a pendulum beside a wall leans on the wall without touching it; its inputs
/// carried out run into it. Rounding alone finds the plan that stays away, eight times as dear.
#[test]
fn rolling_out_finds_the_contact() {
    let model = pendulum(40, [-0.05, 1.0], false);
    let first = |bits: u8| {
        let solution = solve(options(chosen(bits)).with_presolve(false).with_node_limit(1), &model);
        (solution.objective().unwrap(), solution.statistics().heuristics)
    };
    let ((rounded, _), (rolled, counts)) = (first(1), first(8));
    assert!(rolled < 30.0 && rounded > 200.0, "{rolled} {rounded}");
    let count = counts.of(Heuristic::RollOut);
    assert_eq!((count.calls, count.points, count.incumbents), (1, 1, 1));
}

/// Quadratic programs and those of a horizon, where dives start from other points.
#[test]
fn horizons_with_all_and_none() {
    for model in [
        pendulum(12, [0.0, 0.8], false),
        boxes(20, 4, true),
        boxes(20, 4, false),
        wall(60, 0.05, 0.5, true),
        wall(122, 0.02, 0.5, false),
    ] {
        let all = solve(options(Heuristics::default()), &model);
        let none = solve(options(Heuristics::none()), &model);
        assert_eq!(all.termination(), none.termination());
        if let (Some(a), Some(b)) = (all.objective(), none.objective()) {
            assert!((a - b).abs() <= 2e-6 * b.abs().max(1.0), "{a} {b}");
        }
        for heuristic in SWITCHED {
            assert_eq!(none.statistics().heuristics.of(heuristic).calls, 0);
        }
    }
}

#[test]
fn without_any_the_search_is_complete() {
    for (threads, deterministic) in [(1, false), (2, false), (2, true)] {
        let plain = Options::default().with_threads(threads).with_deterministic(deterministic);
        let none = plain.clone().with_heuristics(Heuristics::none());
        for seed in 0..3 {
            let (a, b) = (
                solve(plain.clone(), &knapsack(16, seed)),
                solve(none.clone(), &knapsack(16, seed)),
            );
            assert!(a.is_optimal() && b.is_optimal());
            assert!((a.objective().unwrap() - b.objective().unwrap()).abs() < 1e-6);
        }
        assert_eq!(solve(none, &parity(12)).objective(), Some(1.0));
    }
}

/// Rounds do not depend on the number of threads, whatever runs inside them.
#[test]
fn rounds_repeat_with_all_of_them() {
    for (model, nodes) in [(knapsack(120, 0), 600), (knapsack(24, 5), 1000), (parity(24), 60)] {
        let run = |threads: usize| {
            let options = options(Heuristics::default())
                .with_deterministic(true)
                .with_node_limit(nodes)
                .with_threads(threads);
            let solution = solve(options, &model);
            (
                solution.bound().to_bits(),
                solution.point().cloned(),
                solution.statistics().without_times(),
            )
        };
        let one = run(1);
        for threads in 2..=3 {
            assert_eq!(run(threads), one, "{threads} threads");
        }
        let searched = one.2.nested_nodes > 0;
        assert!(searched || nodes != 600, "small searches are part of what repeats");
    }
}
