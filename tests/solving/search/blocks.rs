//! Programs that fall apart: block by block or as a whole, the answer is that of all parts
//! together.

use carom::prelude::*;
use proptest::prelude::*;

use super::{knapsack, parity};
use crate::common::case::{Case, Column, Line, Square, Switch};
use crate::common::config;
use crate::common::enumeration::optimum;
use crate::common::generate::{Shape, case};
use crate::common::quadratic_program::Minimum;
use crate::instances::generators::{beside as beside_models, wall};

/// Several programs as one, without a common row; `keys` decide the order of the columns.
fn beside(cases: &[Case], keys: &[u32], maximize: bool) -> Case {
    let sizes: Vec<usize> = cases.iter().map(|case| case.columns.len()).collect();
    let n: usize = sizes.iter().sum();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by_key(|&j| (keys[j % keys.len()].rotate_left(j as u32), j));
    let mut place = vec![0; n];
    order.iter().enumerate().for_each(|(k, &j)| place[j] = k);
    let mut whole = Case {
        columns: vec![Column { kind: VariableKind::Continuous, lower: 0.0, upper: 0.0 }; n],
        lines: Vec::new(),
        switches: Vec::new(),
        squares: Vec::new(),
        linear: vec![0.0; n],
        constant: 0.0,
        maximize,
    };
    let mut first = 0;
    for (case, size) in cases.iter().zip(sizes) {
        let spread = |a: &[f64]| {
            let mut all = vec![0.0; n];
            a.iter().enumerate().for_each(|(j, &a)| all[place[first + j]] = a);
            all
        };
        let line = |line: &Line| Line { coefficients: spread(&line.coefficients), ..*line };
        for (j, column) in case.columns.iter().enumerate() {
            whole.columns[place[first + j]] = *column;
            whole.linear[place[first + j]] = case.linear[j];
        }
        whole.lines.extend(case.lines.iter().map(line));
        whole.switches.extend(case.switches.iter().map(|switch| Switch {
            binary: place[first + switch.binary],
            on: switch.on,
            line: line(&switch.line),
        }));
        let square = |s: &Square| Square { coefficients: spread(&s.coefficients), ..*s };
        whole.squares.extend(case.squares.iter().map(square));
        whole.constant += case.constant;
        first += size;
    }
    whole
}

/// The answer to all of them: infeasible where one is, and else unbounded where one is.
fn together(cases: &[Case]) -> Minimum {
    let (mut sum, mut falls) = (0.0, false);
    for case in cases {
        match optimum(case) {
            Minimum::Infeasible => return Minimum::Infeasible,
            Minimum::Unbounded => falls = true,
            Minimum::Attained { value, .. } => sum += value,
        }
    }
    if falls { Minimum::Unbounded } else { Minimum::Attained { value: sum, point: Vec::new() } }
}

fn options(presolve: bool, threads: usize, deterministic: bool) -> Options {
    let options = Options::default().with_presolve(presolve).with_threads(threads);
    options.with_deterministic(deterministic)
}

proptest! {
    #![proptest_config(config(150, "tests/regressions/blocks.txt"))]

    #[test]
    fn the_whole_is_the_sum_of_its_blocks(
        cases in prop::collection::vec(case(Shape::QUADRATIC), 2..=3),
        keys in prop::collection::vec(any::<u32>(), 24),
        maximize in any::<bool>(),
        presolve in any::<bool>(),
        threads in 1..=2_usize,
        deterministic in any::<bool>(),
    ) {
        let whole = beside(&cases, &keys, maximize);
        let (model, _) = whole.build();
        let options = options(presolve, threads, deterministic);
        let truth = together(&cases);
        for blocks in [true, false] {
            let options = options.clone().with_blocks(blocks);
            let solution = BranchAndBound::new(options).solve(&model).unwrap();
            match truth {
                Minimum::Attained { value, .. } => {
                    prop_assert!(solution.is_optimal(), "{blocks}: {solution:?}");
                    let found = whole.sign() * solution.objective().unwrap();
                    prop_assert!((found - value).abs() < 1e-5 * value.abs().max(1.0));
                    let gap = (found - whole.sign() * solution.bound()).abs();
                    prop_assert!(gap <= 1e-7_f64.max(1e-6 * found.abs()) + 1e-12);
                }
                Minimum::Infeasible => prop_assert!(solution.is_infeasible(), "{solution:?}"),
                Minimum::Unbounded => {
                    prop_assert_eq!(solution.termination(), Termination::Unbounded);
                }
            }
            prop_assert!(blocks || solution.statistics().blocks == 0);
        }
    }

    /// Whatever stops it, the bound is one of the whole, and a point is verified.
    #[test]
    fn limits_of_blocks_are_limits_of_the_whole(
        cases in prop::collection::vec(case(Shape::BOUNDED), 2..=3),
        keys in prop::collection::vec(any::<u32>(), 24),
        nodes in 0..6_u64,
        time in prop::option::of(0..3000_u64),
        events in prop::option::of(0..4_usize),
    ) {
        let whole = beside(&cases, &keys, false);
        let (model, _) = whole.build();
        let mut options = options(false, 1, false).with_node_limit(nodes);
        options.time_limit = time.map(std::time::Duration::from_micros);
        let mut solver = BranchAndBound::new(options);
        let interrupt = Interrupt::new();
        let (trigger, mut seen) = (interrupt.clone(), 0);
        let mut callback = |_: &Event| {
            if events.is_some_and(|count| seen >= count) {
                trigger.trigger();
            }
            seen += 1;
        };
        let mut control =
            Control::default().with_progress(&mut callback).with_interrupt(&interrupt);
        let solution = solver.solve_with(&model, &mut control).unwrap();
        let value = match together(&cases) {
            Minimum::Attained { value, .. } => value,
            _ => f64::INFINITY,
        };
        let slack = 1e-5 * if value.is_finite() { value.abs().max(1.0) } else { 1.0 };
        prop_assert!(solution.bound() <= value + slack, "{solution:?}");
        if let Some(found) = solution.objective() {
            prop_assert!(found >= value - slack);
            prop_assert!(solution.verification().is_some_and(|v| v.holds()));
        }
        *solver.options_mut() = Options::default();
        let solution = solver.solve(&model).unwrap();
        prop_assert_eq!(solution.is_optimal(), value.is_finite());
    }
}

/// Copies the variables and rows of a model, with another name, and adds its objective up.
fn add(to: &mut Model, from: &Model, prefix: &str) -> Affine {
    let copies: Vec<Variable> = from
        .variables()
        .map(|v| {
            let name = format!("{prefix}{}", v.id().index());
            to.variable(name, v.kind(), v.bounds().lower, v.bounds().upper).unwrap()
        })
        .collect();
    let copy = |terms: &[(Variable, f64)]| -> Affine {
        terms.iter().map(|&(v, a)| a * copies[v.index()]).sum()
    };
    for (k, row) in from.constraints().enumerate() {
        let limits = row.limits();
        let row = copy(row.terms()).within(limits.lower, limits.upper);
        to.add(format!("{prefix}row{k}"), row).unwrap();
    }
    copy(&from.objective().affine().terms())
}

fn two_knapsacks() -> Model {
    let mut model = Model::new("two");
    let first = add(&mut model, &knapsack(14, 3), "a");
    let second = add(&mut model, &knapsack(14, 4), "b");
    model.maximize(first + second).unwrap();
    model
}

#[test]
fn a_tree_of_blocks_is_a_sum() {
    let model = two_knapsacks();
    let solve =
        |blocks| BranchAndBound::new(Options::default().with_blocks(blocks)).solve(&model).unwrap();
    let (apart, whole) = (solve(true), solve(false));
    assert!(apart.is_optimal() && whole.is_optimal());
    assert!((apart.objective().unwrap() - whole.objective().unwrap()).abs() < 1e-6);
    assert_eq!((apart.statistics().blocks, whole.statistics().blocks), (2, 0));
    assert!(apart.statistics().nodes < whole.statistics().nodes);
    // The same again, to the last count.
    let again = solve(true);
    assert_eq!(again.statistics().without_times(), apart.statistics().without_times());
    assert_eq!(again.objective(), apart.objective());
}

/// Points are shown when all blocks have one, each better than the last and verified; whoever asks
/// for the end gets it.
#[test]
fn points_and_figures_are_those_of_the_whole() {
    let model = two_knapsacks();
    let best = BranchAndBound::default().solve(&model).unwrap().objective().unwrap();
    for stop in [false, true] {
        let (mut shown, mut figures) = (Vec::new(), Vec::new());
        let mut note = |found: &Incumbent<'_>| {
            assert!(Verification::of(&model, found.point, 1e-6).holds());
            assert_eq!(found.point.value(model.objective()).unwrap(), found.objective);
            shown.push(found.objective);
            if stop {
                std::ops::ControlFlow::Break(())
            } else {
                std::ops::ControlFlow::Continue(())
            }
        };
        let mut callback = |event: &Event| figures.push(*event.progress());
        let mut control = Control::default().with_incumbent(&mut note).with_progress(&mut callback);
        let solution = BranchAndBound::default().solve_with(&model, &mut control).unwrap();
        assert!(!shown.is_empty() && shown.is_sorted());
        assert!(figures.iter().all(|p| p.bound >= best - 1e-6));
        assert!(figures.iter().all(|p| p.incumbent.is_none_or(|value| value <= best + 1e-6)));
        assert!(figures.is_sorted_by_key(|p| p.nodes));
        if stop {
            assert_eq!(shown.len(), 1);
            assert!(solution.point().is_some());
        } else {
            assert!((shown[shown.len() - 1] - best).abs() < 1e-6);
        }
    }
}

/// A block that is never solved leaves the others their share of the nodes.
#[test]
fn a_hard_block_leaves_the_others_their_share() {
    let mut model = Model::new("hard and easy");
    let hard = add(&mut model, &parity(30), "a");
    let easy = -1.0 * add(&mut model, &knapsack(14, 3), "b");
    model.minimize(hard + easy).unwrap();
    let solve = |options| BranchAndBound::new(options).solve(&model).unwrap();
    let options = Options::default().with_presolve(false).with_cuts(false);
    let solution = solve(options.with_node_limit(200));
    assert_eq!(solution.termination(), Termination::NodeLimit);
    assert_eq!(solution.statistics().blocks, 2);
    assert!(solution.statistics().nodes <= 200);
    assert!(solution.bound().is_finite());
}

/// Without an objective, each block is searched on its own as well.
#[test]
fn blocks_without_an_objective() {
    let walls = [123, 122].map(|steps| wall(steps, 0.02, 0.5, false));
    let both = |k: usize| beside_models(&[walls[0].clone(), walls[k].clone()]);
    let solve = |model: &Model| BranchAndBound::default().solve(model).unwrap();
    let feasible = solve(&both(0));
    assert!(feasible.is_optimal() && feasible.verification().is_some_and(|v| v.holds()));
    assert_eq!(feasible.statistics().blocks, 2);
    assert!(solve(&both(1)).is_infeasible());
}
