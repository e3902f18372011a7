//! Limits and interrupts at any moment: a valid bound, a verified point if any, and a solver that
//! solves the next program as if nothing had been.

use std::cell::Cell;
use std::ops::ControlFlow;
use std::sync::OnceLock;

use carom::prelude::*;
use proptest::prelude::*;
use std::time::Duration;

use super::knapsack;
use crate::common::config;

fn sound(model: &Model, solution: &Solution, optimum: f64) {
    let sign = model.sense().sign();
    let slack = 1e-5 * optimum.abs().max(1.0);
    assert!(sign * (optimum - solution.bound()) >= -slack, "{} {optimum}", solution.bound());
    if let Some(objective) = solution.objective() {
        assert!(sign * (objective - optimum) >= -slack, "{objective} {optimum}");
        assert!(solution.verification().is_some_and(|v| v.holds()));
    }
    if solution.is_optimal() {
        assert!((solution.objective().unwrap() - optimum).abs() <= slack);
    }
}

#[derive(Debug, Clone)]
enum Stop {
    Nodes(u64),
    Bytes(u64),
    Micros(u64),
    /// After so many questions to the callbacks.
    Event(usize),
    Incumbent(usize),
}

fn stop() -> impl Strategy<Value = Stop> {
    prop_oneof![
        (0..60_u64).prop_map(Stop::Nodes),
        (0..4000_u64).prop_map(Stop::Bytes),
        (0..20_000_u64).prop_map(Stop::Micros),
        (0..4_usize).prop_map(Stop::Event),
        (0..4_usize).prop_map(Stop::Incumbent),
    ]
}

/// The optimum of the knapsack of a seed, solved once.
fn optimum(seed: u64) -> f64 {
    static OPTIMA: [OnceLock<f64>; 3] = [const { OnceLock::new() }; 3];
    *OPTIMA[seed as usize].get_or_init(|| {
        BranchAndBound::default().solve(&knapsack(14, seed)).unwrap().objective().unwrap()
    })
}

proptest! {
    #![proptest_config(config(32, "tests/regressions/limits.txt"))]

    #[test]
    fn any_moment_is_a_good_one(
        seed in 0..3_u64,
        stop in stop(),
        threads in 1..=3_usize,
        deterministic in any::<bool>(),
    ) {
        let model = knapsack(14, seed);
        let optimum = optimum(seed);
        let plain = Options::default().with_threads(threads).with_deterministic(deterministic);
        let mut solver = BranchAndBound::new(plain.clone());
        let interrupt = Interrupt::new();
        let (mut events, mut points) = (0, 0);
        let mut after = usize::MAX;
        let mut break_at = usize::MAX;
        let options = solver.options_mut();
        match stop {
            Stop::Nodes(nodes) => options.node_limit = Some(nodes),
            Stop::Bytes(bytes) => options.memory_limit = Some(bytes),
            Stop::Micros(micros) => options.time_limit = Some(Duration::from_micros(micros)),
            Stop::Event(count) => after = count,
            Stop::Incumbent(count) => break_at = count,
        }
        let mut callback = |_: &Event| {
            if events == after {
                interrupt.trigger();
            }
            events += 1;
        };
        let mut note = |best: &Incumbent<'_>| {
            assert!(best.point.value(model.objective()).is_ok());
            points += 1;
            if points > break_at { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let mut control = Control::default()
            .with_progress(&mut callback)
            .with_incumbent(&mut note)
            .with_interrupt(&interrupt);
        let solution = solver.solve_with(&model, &mut control).unwrap();
        sound(&model, &solution, optimum);
        let ended = solution.termination();
        prop_assert!(ended.is_limit() || ended == Termination::Optimal, "{ended}");
        if let Stop::Nodes(nodes) = stop {
            prop_assert!(solution.statistics().nodes <= nodes);
        }
        *solver.options_mut() = plain;
        let again = solver.solve(&model).unwrap();
        prop_assert!(again.is_optimal());
        prop_assert!((again.objective().unwrap() - optimum).abs() < 1e-6);
    }
}

#[test]
fn a_callback_that_breaks_ends_the_search() {
    let model = knapsack(20, 1);
    for deterministic in [false, true] {
        let options = Options::default().with_deterministic(deterministic);
        let mut solver = BranchAndBound::new(options);
        let mut note = |_: &Incumbent<'_>| ControlFlow::Break(());
        let mut control = Control::default().with_incumbent(&mut note);
        let solution = solver.solve_with(&model, &mut control).unwrap();
        assert_eq!(solution.termination(), Termination::Interrupted);
        assert!(solution.point().is_some());
        assert!(!control.interrupt().is_triggered(), "the user's handle is the user's");
        assert!(solver.solve(&model).unwrap().is_optimal());
    }
}

#[test]
fn memory_ends_like_the_other_limits() {
    let model = knapsack(40, 3);
    for threads in [1, 2] {
        let options = Options::default().with_threads(threads).with_memory_limit(600);
        let solution = BranchAndBound::new(options).solve(&model).unwrap();
        assert_eq!(solution.termination(), Termination::MemoryLimit);
        assert!(solution.termination().is_limit());
        assert!(solution.statistics().tree_bytes >= 600);
        assert!(solution.objective().is_none_or(|objective| objective <= solution.bound()));
    }
    // Where depth goes first, the same program is solved with less.
    let model = knapsack(22, 3);
    let free = BranchAndBound::default().solve(&model).unwrap();
    let (bytes, best) = (free.statistics().tree_bytes, free.objective());
    let limit = bytes * 3 / 4;
    let options = Options::default().with_memory_limit(limit);
    let tight = BranchAndBound::new(options).solve(&model).unwrap();
    assert!(tight.statistics().tree_bytes < bytes);
    if tight.is_optimal() {
        assert_eq!(tight.objective(), best);
    }
}

/// A limit that is over before the start is heard before the root is worked at: nothing is counted,
/// and what the callbacks see says so.
#[test]
fn limits_are_heard_before_anything_long() {
    let model = crate::instances::generators::wall(484, 0.005, 0.5, false);
    let asked = Cell::new(0);
    let mut callback = |_: &Event| asked.set(asked.get() + 1);
    let mut control = Control::default().with_progress(&mut callback);
    let options = Options::default().with_time_limit(Duration::ZERO);
    let solution = BranchAndBound::new(options).solve_with(&model, &mut control).unwrap();
    assert_eq!(solution.termination(), Termination::TimeLimit);
    assert_eq!(solution.statistics().nodes, 0);
    assert_eq!(solution.statistics().relaxations, 0);
    assert_eq!(asked.get(), 0);
}
