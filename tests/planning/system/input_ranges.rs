//! One rule for ranges of inputs under several choices: rows, sets, replays, waiting and terminal
//! sets agree about it.

use carom::hybrid::reach::{ReachSets, SetOptions};
use carom::hybrid::{
    HybridRun, HybridSystem, LinearSystem, Lqr, Monotonicity, Region, ShortestOptions,
    TerminalOptions, TerminalSet,
};
use carom::interval::Interval;
use carom::prelude::*;
use carom_hybrid::internals::{Choice, Transition};

/// `x⁺ = x + u`, and 10 more with the boost, and 40 more if shut; u is within [-1, 1] unless a
/// transition says otherwise: 3 with the boost, and `shut` if shut.
fn system(shut: Option<f64>) -> HybridSystem {
    let flow = |shift: f64| LinearSystem::new([[1.0]], [[1.0]], [shift]).unwrap();
    let range = |most: f64| Interval::new(-most, most);
    let boost = Transition::new("boost", flow(10.0)).with_input_range("u", range(3.0));
    let closed = Transition::new("shut", flow(40.0));
    let closed = match shut {
        Some(most) => closed.with_input_range("u", range(most)),
        None => closed,
    };
    HybridSystem::new(1.0)
        .with_state("x", Interval::new(-100.0, 100.0))
        .with_input("u", range(1.0))
        .with_flow(flow(0.0))
        .with_choice(
            Choice::new("engine")
                .with_transition(Transition::new("cruise", flow(0.0)))
                .with_transition(boost),
        )
        .with_choice(
            Choice::new("brake")
                .with_transition(Transition::new("open", flow(0.0)))
                .with_transition(closed),
        )
}

/// The largest input in a step that takes these transitions.
fn cases() -> Vec<(HybridSystem, [&'static str; 2], f64)> {
    let alone = [
        (["cruise", "open"], 1.0),
        (["cruise", "shut"], 1.0),
        (["boost", "open"], 3.0),
        (["boost", "shut"], 3.0),
    ];
    let both = [
        (["cruise", "open"], 1.0),
        (["cruise", "shut"], 1.0),
        (["boost", "open"], 1.0),
        (["boost", "shut"], 2.0),
    ];
    let narrow = [
        (["cruise", "open"], 1.0),
        (["cruise", "shut"], 0.5),
        (["boost", "open"], 1.0),
        (["boost", "shut"], 0.5),
    ];
    let of = |shut: Option<f64>, cases: [([&'static str; 2], f64); 4]| {
        cases.map(|(taken, most)| (system(shut), taken, most))
    };
    [of(None, alone), of(Some(2.0), both), of(Some(0.5), narrow)].concat()
}

/// One step from 0 with an input.
fn run(taken: [&str; 2], u: f64) -> HybridRun {
    let shift = if taken[0] == "boost" { 10.0 } else { 0.0 };
    let shift = shift + if taken[1] == "shut" { 40.0 } else { 0.0 };
    let mut run = HybridRun::default();
    run.states = vec![("x".into(), vec![0.0, shift + u])];
    run.inputs = vec![("u".into(), vec![u])];
    run.transitions =
        vec![("engine".into(), vec![taken[0].into()]), ("brake".into(), vec![taken[1].into()])];
    run
}

#[test]
fn rows_sets_and_replays_have_the_same_ranges() {
    for (system, taken, most) in cases() {
        // Replays.
        assert!(system.certify(&run(taken, most)).is_ok(), "{taken:?}, {most}");
        assert!(system.certify(&run(taken, -most - 0.01)).is_err(), "{taken:?}, {most}");
        // Rows.
        let mut model = Model::new("step");
        let program = system.write(&mut model, "", 1).unwrap();
        for (choice, name) in ["engine", "brake"].into_iter().zip(taken) {
            let literal = program.taken(choice, name, 0).unwrap().unwrap();
            model.fix(literal.variable(), f64::from(u8::from(literal.is_on()))).unwrap();
        }
        model.maximize(program.inputs()[0][0]).unwrap();
        let solution = BranchAndBound::default().solve(&model).unwrap();
        assert!((solution.objective().unwrap() - most).abs() < 1e-6, "{taken:?}, {most}");
        // Sets: where the step ends tells which transitions it took.
        for (u, reaches) in [(most - 0.01, true), (most + 0.01, false)] {
            let to = run(taken, u).states[0].1[1];
            let (start, goal) = (Region::point([0.0]), Region::point([to]));
            let mut sets = ReachSets::new(&system, start, goal, SetOptions::default()).unwrap();
            assert_eq!(!sets.tube(1).unwrap().is_empty(), reaches, "{taken:?}, {u}");
        }
    }
}

#[test]
fn waiting_and_terminal_sets_have_the_same_ranges() {
    // 0 is held with -2, which only a wide range allows.
    let flow = |shift: f64| LinearSystem::new([[0.5]], [[1.0]], [shift]).unwrap();
    let system = |other: Option<f64>| {
        let hold = Transition::new("hold", flow(2.0));
        let hold = hold.with_input_range("u", Interval::new(-3.0, 3.0));
        let idle = Transition::new("idle", flow(0.0));
        let idle = match other {
            Some(most) => idle.with_input_range("u", Interval::new(-most, most)),
            None => idle,
        };
        HybridSystem::new(1.0)
            .with_state("x", Interval::new(-9.0, 9.0))
            .with_input("u", Interval::new(-1.0, 1.0))
            .with_flow(flow(0.0))
            .with_choice(Choice::new("one").with_transition(hold))
            .with_choice(Choice::new("two").with_transition(idle))
    };
    let lqr = Lqr::new(&flow(2.0), [[1.0]], [[1.0]]).unwrap();
    for (other, is_held) in [(None, true), (Some(2.5), true), (Some(1.5), false)] {
        let (rest, away) = (Region::point([0.0]), Region::from([Interval::new(1.0, 2.0)]));
        let monotonicity = system(other).monotonicity(&rest, &away).unwrap();
        assert_eq!(monotonicity.is_monotone(), is_held, "{monotonicity:?}");
        if let Monotonicity::Monotone(reason) = monotonicity {
            assert!(reason.contains("u = -2"), "{reason}");
        }
        let (options, solver) = (TerminalOptions::default(), &mut BranchAndBound::default());
        let set =
            TerminalSet::new(&system(other), &["hold", "idle"], &lqr, &[0.0], &options, solver);
        assert_eq!(set.is_ok(), is_held, "{set:?}");
        if let Ok(set) = set {
            let inside = (-90..=90).map(|k| [0.1 * f64::from(k)]);
            let inside = inside.filter(|x| set.region.contains(x, 0.0).unwrap());
            let most = other.unwrap_or(3.0);
            assert!(inside.clone().count() > 3);
            assert!(inside.map(|x| set.feedback(&x).unwrap()[0].abs()).all(|u| u <= most));
        }
    }
}

#[test]
fn an_input_without_any_value_at_a_step_is_infeasible_with_and_without_sets() {
    // Both choices limit the input, and from step 1 on their ranges have nothing in common.
    let flow = || LinearSystem::new([[1.0]], [[1.0]], [0.0]).unwrap();
    let only = |name: &str, ranges: Vec<Interval>| {
        Choice::new(name)
            .with_transition(Transition::new("go", flow()).with_input_range("u", ranges))
    };
    let system = HybridSystem::new(1.0)
        .with_state("x", Interval::new(-9.0, 9.0))
        .with_input("u", Interval::new(-1.0, 1.0))
        .with_flow(flow())
        .with_choice(only("a", vec![Interval::new(0.0, 1.0), Interval::new(0.5, 1.0)]))
        .with_choice(only("b", vec![Interval::new(0.0, 1.0), Interval::new(-1.0, 0.25)]));
    for (goal, found) in [(0.75, Some(1)), (1.5, None)] {
        for sets in [true, false] {
            let (start, goal) = (Region::point([0.0]), Region::point([goal]));
            let options = ShortestOptions::default().with_max_steps(4).with_reach_sets(sets);
            let mut solver = BranchAndBound::default();
            let run = system.shortest_with(&start, &goal, &options, &mut solver).unwrap();
            assert_eq!(run.steps, found, "{sets}");
        }
    }
}
