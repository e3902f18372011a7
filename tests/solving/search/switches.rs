//! Parts of the search on and off: no combination changes an answer, and each switch does switch.

use carom::prelude::*;
use carom::solver::RelaxationMethod;
use proptest::prelude::*;

use crate::common::config;
use crate::common::generate::{Shape, case};
use crate::common::judge::is_right;
use crate::instances::generators::{pendulum, wall};

/// The parts whose bits are set.
fn options(bits: u8) -> Options {
    let on = |bit: u8| bits & (1 << bit) != 0;
    Options::default()
        .with_reductions(on(0))
        .with_probing(on(1))
        .with_cuts(on(2))
        .with_blocks(on(3))
        .with_disjunctive_tightening(on(4))
        .with_big_m_tightening(on(5))
        .with_facet_nodes(if on(6) { 0 } else { u64::MAX })
}

fn solve(options: Options, model: &Model) -> Solution {
    BranchAndBound::new(options).solve(model).unwrap()
}

proptest! {
    #![proptest_config(config(100, "tests/regressions/switches.txt"))]

    #[test]
    fn any_combination_finds_the_optimum(
        case in case(Shape::QUADRATIC),
        bits in 0..128_u8,
        threads in 1..=2_usize,
        deterministic in any::<bool>(),
    ) {
        let (model, _) = case.build();
        let options = options(bits).with_threads(threads).with_deterministic(deterministic);
        let solution = solve(options, &model);
        is_right(&case, &solution)?;
    }
}

proptest! {
    #![proptest_config(config(100, "tests/regressions/relaxation_methods.txt"))]

    #[test]
    fn every_method_of_relaxations_finds_the_optimum(
        case in case(Shape::QUADRATIC),
        bits in 0..16_u8,
        deterministic in any::<bool>(),
    ) {
        let (model, _) = case.build();
        for method in RelaxationMethod::ALL {
            let options = options(bits).with_deterministic(deterministic).with_relaxation(method);
            let solution = solve(options, &model);
            is_right(&case, &solution)?;
            let statistics = solution.statistics();
            let counts = statistics.relaxation_counts;
            prop_assert_eq!(counts.total(), statistics.relaxations);
            let warm = counts.dual_simplex + counts.active_set;
            let own = warm + counts.interior_point;
            prop_assert!(method != RelaxationMethod::Clarabel || own == 0);
            prop_assert!(method == RelaxationMethod::Automatic || warm == 0);
            prop_assert!(counts.given_up <= statistics.relaxations);
        }
    }
}

/// The dual simplex method is counted for linear relaxations, and the active-set method for curved
/// ones.
#[test]
fn each_method_is_counted_under_its_own_name() {
    let counts = |curved: bool| {
        let mut model = Model::new("either");
        let n = model.integer_family("n", 3, 0.0, 9.0).unwrap();
        model.add("odd", (2.0 * n[0] + 2.0 * n[1] + 2.0 * n[2]).within(7.0, 31.0)).unwrap();
        let squares = n.iter().map(|n| (1.3 * n - 4.0).square()).sum::<Quadratic>();
        let costs = Quadratic::from(1.5 * n[0] + 1.3 * n[1] + 1.1 * n[2]);
        model.minimize(if curved { squares } else { costs }).unwrap();
        let options = Options::default().with_presolve(false).with_cuts(false);
        *solve(options, &model).statistics()
    };
    let (linear, curved) = (counts(false).relaxation_counts, counts(true).relaxation_counts);
    assert!(linear.dual_simplex > 0 && linear.active_set == 0, "{linear:?}");
    assert!(curved.active_set > 0 && curved.dual_simplex == 0, "{curved:?}");
}

/// Most relaxations are the crate's own, and horizons come out the same by either method.
#[test]
fn either_method_solves_a_horizon() {
    let model = pendulum(12, [0.0, 0.8], false);
    let methods = [RelaxationMethod::InteriorPoint, RelaxationMethod::Clarabel];
    let [own, other] = methods.map(|method| {
        let solution = solve(Options::default().with_relaxation(method), &model);
        assert!(solution.is_optimal(), "{method}");
        (solution.objective().unwrap(), solution.statistics().relaxation_counts)
    });
    assert!((own.0 - other.0).abs() < 2e-6 * own.0.abs(), "{own:?} {other:?}");
    assert!(own.1.interior_point > own.1.clarabel, "{own:?}");
    assert!(other.1.interior_point == 0 && other.1.clarabel > 0, "{other:?}");
}

/// A horizon a step too short is refuted with probing and without it, in far more nodes.
#[test]
fn probing_spares_nodes() {
    let model = wall(122, 0.02, 0.5, false);
    let [with, without] = [true, false].map(|on| {
        let solution = solve(Options::default().with_probing(on), &model);
        assert!(solution.is_infeasible(), "{on}");
        *solution.statistics()
    });
    assert!(2 * with.nodes < without.nodes, "{} {}", with.nodes, without.nodes);
    assert!(without.times.probing.is_zero() && !with.times.probing.is_zero());
}

/// Each part of presolve changes the tree, and all together spare nodes.
#[test]
fn parts_of_presolve_are_switched() {
    let nodes = |options, model: &Model| {
        let solution = solve(options, model);
        assert!(solution.is_optimal());
        solution.statistics().nodes
    };
    let model = pendulum(40, [0.0, 0.8], false);
    let all = nodes(Options::default(), &model);
    let parts = [
        Options::default().with_presolve(false),
        Options::default().with_disjunctive_tightening(false),
        Options::default().with_big_m_tightening(false),
    ];
    let without = parts.map(|options| nodes(options, &model));
    assert!(without[0] > 2 * all && without[2] > 2 * all, "{all} {without:?}");
    assert_ne!(without[1], all);
}

/// Horizons with an objective, with any single part left out.
#[test]
fn no_part_is_needed_for_an_answer() {
    let model = pendulum(12, [0.0, 0.8], false);
    let all = solve(Options::default(), &model);
    for bit in 0..6 {
        let solution = solve(options(0b11_1111 & !(1 << bit)), &model);
        assert!(solution.is_optimal());
        let (one, other) = (solution.objective().unwrap(), all.objective().unwrap());
        assert!((one - other).abs() < 2e-6 * other.abs(), "{bit}: {one} {other}");
    }
}

/// Lots of sizes to meet demands, with set-ups: `constant` is spent whatever is decided.
fn lots(constant: f64) -> Model {
    let demand = [31.0, 17.0, 42.0, 8.0, 25.0, 36.0, 12.0, 29.0];
    let mut model = Model::new("lots");
    let made = model.continuous_family("made", demand.len(), 0.0, 200.0).unwrap();
    let stock = model.continuous_family("stock", demand.len(), 0.0, 200.0).unwrap();
    let set_up = model.binary_family("set_up", demand.len()).unwrap();
    let mut cost = Affine::from(constant);
    for (t, &needed) in demand.iter().enumerate() {
        let before = if t == 0 { Affine::from(0.0) } else { Affine::from(stock[t - 1]) };
        model.add(("balance", t), (before + made[t] - stock[t]).equals(needed)).unwrap();
        model.add(("only_set_up", t), (made[t] - 200.0 * set_up[t]).le(0.0)).unwrap();
        cost = cost + 50.0 * set_up[t] + 1.0 * stock[t];
    }
    model.minimize(cost).unwrap();
    model
}

/// Cuts are kept for what they close of the gap, however large a constant the objective has.
#[test]
fn a_constant_does_not_turn_cuts_off() {
    let (cut, uncut) = (Options::default(), Options::default().with_cuts(false));
    let nodes = |options: Options, constant: f64| {
        let options = options.with_relative_gap(0.0).with_absolute_gap(1e-4);
        let solution = solve(options, &lots(constant));
        assert!(solution.is_optimal());
        solution.statistics().nodes
    };
    let [plain, shifted] = [0.0, 1e5].map(|constant| nodes(cut.clone(), constant));
    let without = nodes(uncut, 1e5);
    assert!(plain < without && shifted < without, "{plain} {shifted} {without}");
}
