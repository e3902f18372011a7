//! The shortest run of a system against enumeration, and why waiting is free or not.

use carom::ErrorKind;
use carom::hybrid::{
    HybridRun, HybridSystem, LinearSystem, Monotonicity, Region, ShortestOptions, ShortestStatus,
    State, TimeStepGrid, least_time_step,
};
use carom::interval::Interval;
use carom::prelude::*;
use carom_hybrid::internals::HasParts;
use carom_hybrid::internals::{Choice, Halfspace, Transition};
use proptest::prelude::*;

use crate::common::config;

const DOMAIN: f64 = 4.0;
const MOST: usize = 4;

/// One transition: `x⁺ = A x + b u + c` where `x[0] >= edge` or `<= edge`.
#[derive(Debug, Clone)]
struct Plain {
    a: [[f64; 2]; 2],
    b: [f64; 2],
    c: [f64; 2],
    side: f64,
    edge: f64,
}

fn plain() -> impl Strategy<Value = Plain> {
    let entry = -1.2..1.2_f64;
    (
        [[entry.clone(), entry.clone()], [entry.clone(), entry.clone()]],
        [entry.clone(), entry.clone()],
        [-0.5..0.5_f64, -0.5..0.5_f64],
        any::<bool>(),
        entry,
    )
        .prop_map(|(a, b, c, right, edge)| {
            let side = if right { 1.0 } else { -1.0 };
            Plain { a, b, c, side, edge }
        })
}

/// Whether a sequence of transitions has a run from the start to the goal, as a linear program.
fn has_run(sequence: &[&Plain], start: [f64; 2], goal: &[Interval; 2]) -> bool {
    let mut model = Model::new("sequence");
    let steps = sequence.len();
    let x: Vec<Family> = (0..2)
        .map(|i| model.continuous_family(&format!("x{i}"), steps + 1, -DOMAIN, DOMAIN).unwrap())
        .collect();
    let u = model.continuous_family("u", steps, -1.0, 1.0).unwrap();
    for i in 0..2 {
        model.fix(x[i][0], start[i]).unwrap();
        model.set_bounds(x[i][steps], goal[i].lower, goal[i].upper).unwrap();
    }
    for (t, taken) in sequence.iter().enumerate() {
        model.add(("side", t), (taken.side * x[0][t]).ge(taken.side * taken.edge)).unwrap();
        for i in 0..2 {
            let next = taken.a[i][0] * x[0][t] + taken.a[i][1] * x[1][t] + taken.b[i] * u[t];
            model.add((format!("next{i}"), t), x[i][t + 1].equals(next + taken.c[i])).unwrap();
        }
    }
    let solution = BranchAndBound::default().solve(&model).unwrap();
    assert!(solution.point().is_some() || solution.is_infeasible());
    solution.point().is_some()
}

/// The end of a run that takes the first possible transition from the picked one on in each step.
fn drive(
    transitions: &[Plain],
    start: [f64; 2],
    picks: &[usize],
    inputs: &[f64],
) -> Option<[f64; 2]> {
    let mut x = start;
    for (pick, u) in picks.iter().zip(inputs) {
        let order = (0..transitions.len()).map(|k| &transitions[(pick + k) % transitions.len()]);
        let taken = order.into_iter().find(|p| p.side * x[0] >= p.side * p.edge)?;
        x = [0, 1]
            .map(|i| taken.a[i][0] * x[0] + taken.a[i][1] * x[1] + taken.b[i] * u + taken.c[i]);
        if x.iter().any(|x| x.abs() > DOMAIN - 0.2) {
            return None;
        }
    }
    Some(x)
}

/// The smallest number of steps up to [`MOST`], by all sequences.
fn enumerated(transitions: &[Plain], start: [f64; 2], goal: &[Interval; 2]) -> Option<usize> {
    let mut sequences: Vec<Vec<&Plain>> = vec![Vec::new()];
    for steps in 1..=MOST {
        sequences = sequences
            .iter()
            .flat_map(|sequence| {
                transitions.iter().map(move |next| {
                    sequence.iter().copied().chain([next]).collect::<Vec<&Plain>>()
                })
            })
            .collect();
        if sequences.iter().any(|sequence| has_run(sequence, start, goal)) {
            return Some(steps);
        }
    }
    None
}

fn system(transitions: &[Plain]) -> (HybridSystem, [State; 2]) {
    let mut system = HybridSystem::new(1.0);
    let states = ["x", "y"].map(|name| system.state(name, -DOMAIN, DOMAIN).unwrap());
    let [x, y] = states;
    let u = system.input("u", -1.0, 1.0).unwrap();
    for (k, p) in transitions.iter().enumerate() {
        let next = |i: usize| p.a[i][0] * x + p.a[i][1] * y + p.b[i] * u + p.c[i];
        let mode = system.mode(&format!("t{k}")).unwrap().next([(x, next(0)), (y, next(1))]);
        mode.unwrap().guard((p.side * x).ge(p.side * p.edge)).unwrap();
    }
    (system, states)
}

/// Replays a run step by step from its own samples.
fn replayed(system: &HybridSystem, run: &HybridRun) {
    let taken = run.transitions("mode").unwrap();
    let at = |of: &[(String, Vec<f64>)], t: usize| -> Vec<f64> {
        of.iter().map(|(_, values)| values[t]).collect()
    };
    for (t, name) in taken.iter().enumerate() {
        let transition = system.transitions().find(|transition| transition.name == *name).unwrap();
        let (x, u) = (at(&run.states, t), at(&run.inputs, t));
        let next = transition.flow.step(&x, &u).unwrap();
        for (y, x) in next.iter().zip(at(&run.states, t + 1)) {
            assert!((y - x).abs() < 1e-6, "step {t}: {y} {x}");
        }
        for guard in &transition.guards {
            let value: f64 = guard.normal.iter().zip(&x).map(|(a, x)| a * x).sum();
            assert!(value <= guard.limit.get(t).unwrap() + 2e-6);
        }
    }
}

proptest! {
    #![proptest_config(config(48, "tests/regressions/shortest_runs.txt"))]

    #[test]
    fn shortest_runs_are_those_of_enumeration(
        transitions in prop::collection::vec(plain(), 1..4),
        start in [-2.0..2.0_f64, -2.0..2.0_f64],
        corner in [-2.0..2.0_f64, -2.0..2.0_f64],
        width in 0.2..1.5_f64,
        sets in any::<bool>(),
        aimed in prop::option::weighted(0.8, (2..=MOST, [0..3_usize, 0..3, 0..3, 0..3])),
        inputs in [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0, -1.0..1.0],
    ) {
        // Most goals are around the end of a run.
        let corner = match aimed {
            None => corner,
            Some((steps, picks)) => {
                let end = drive(&transitions, start, &picks[..steps], &inputs);
                let Some(end) = end else { return Err(TestCaseError::reject("no run")) };
                end.map(|x| x - 0.1)
            }
        };
        let width = if aimed.is_some() { 0.2 } else { width };
        let goal = corner.map(|low| Interval::new(low, low + width));
        let expected = enumerated(&transitions, start, &goal);
        let (system, [x, y]) = system(&transitions);
        let options = ShortestOptions::default().with_max_steps(MOST).with_reach_sets(sets);
        let to = Region::from(goal);
        let from = [x.equals(start[0]), y.equals(start[1])];
        let rows = [x.within(goal[0].lower, goal[0].upper), y.within(goal[1].lower, goal[1].upper)];
        let mut solver = BranchAndBound::default();
        let found = system.shortest_with(from, rows, &options, &mut solver).unwrap();
        prop_assert_eq!(found.steps, expected);
        match expected {
            Some(steps) => {
                prop_assert!(found.is_found());
                let plan = found.plan.expect("a plan");
                let run = &plan.run;
                prop_assert_eq!(run.transitions("mode").unwrap().len(), steps);
                let end = [run.states[0].1[steps], run.states[1].1[steps]];
                prop_assert!(to.contains(&end, 2e-6).unwrap());
                prop_assert!(plan.certificate.largest_residual <= 1e-6);
                replayed(&system, run);
            }
            None => {
                let none = ShortestStatus::NoneWithin { max_steps: MOST };
                prop_assert_eq!(found.status, none);
            }
        }
    }
}

fn elevator() -> HybridSystem {
    let mut lift = HybridSystem::new(0.1);
    let x = lift.state("x", 0.0, 15.0).unwrap();
    let v = lift.state("v", -2.5, 2.5).unwrap();
    let u = lift.input("u", -1.0, 1.0).unwrap();
    lift.mode("low gear").unwrap().rates([(x, v.into()), (v, 0.6 * u)]).unwrap();
    let high = lift.mode("high gear").unwrap().rates([(x, v.into()), (v, 1.5 * u)]).unwrap();
    high.limit("the least speed of high gear", v.ge(0.4)).unwrap();
    lift
}

#[test]
fn the_elevator_takes_72_steps() {
    let (start, goal) = (Region::point([0.0, 0.0]), Region::point([12.0, 0.0]));
    let mut solver = BranchAndBound::default();
    let options = ShortestOptions::default();
    let found = elevator().shortest_with(&start, &goal, &options, &mut solver).unwrap();
    assert!(found.is_found());
    assert_eq!(found.steps, Some(72));
    let expected = "the start is held by `low gear` with u = 0, and nothing depends on the step";
    assert_eq!(found.monotonicity, Monotonicity::Monotone(expected.into()));
    let run = found.plan.unwrap().run;
    assert!((run.state("x").unwrap()[72] - 12.0).abs() < 1e-6);
    replayed(&elevator(), &run);
}

#[test]
fn waiting_is_free_only_with_an_argument() {
    let rest = |x: f64| Region::point([x, 0.0]);
    let why = |system: &HybridSystem, start: &Region, goal: &Region| {
        system.monotonicity(start, goal).unwrap()
    };
    let elevator = elevator();
    // A moving start, then a goal at rest.
    let free = why(&elevator, &Region::point([1.0, 1.0]), &rest(12.0));
    assert!(free.is_monotone() && free.reason().starts_with("the goal is held"), "{free:?}");
    let region = Region::from([Interval::new(1.0, 2.0), Interval::point(0.0)]);
    let fixed = why(&elevator, &region, &Region::point([3.0, 1.0]));
    let expected = "the start is not a single state; the goal cannot be held";
    assert_eq!(fixed, Monotonicity::NotMonotone(expected.into()));
    // Outside its domain nothing is held.
    assert!(!why(&elevator, &rest(16.0), &rest(-1.0)).is_monotone());
    // A limit by step.
    let door = Halfspace::limit("door", [1.0, 0.0], vec![5.0, 15.0]);
    let timed = why(&elevator.clone().with_limit(door), &rest(0.0), &rest(12.0));
    assert!(!timed.is_monotone() && timed.reason().contains("depend on the step"));
    // A limit that the held input breaks.
    let push = Halfspace::limit("push", [0.0, 0.0, -1.0], -0.1);
    assert!(!why(&elevator.clone().with_limit(push), &rest(0.0), &rest(12.0)).is_monotone());
    // Only events hold it, and they are limited.
    let mut events = elevator.with_most_events(3);
    events.parts_mut().choices[0]
        .transitions
        .iter_mut()
        .for_each(|transition| transition.is_event = true);
    assert!(!why(&events, &rest(0.0), &rest(12.0)).is_monotone());
}

#[test]
fn waiting_holds_in_every_mode_of_the_end() {
    let flow = |by: f64| LinearSystem::new([[1.0]], [[1.0]], [by]).unwrap();
    let heater = Choice::new("heater")
        .with_transition(Transition::new("idle", flow(-1.0)).within("off"))
        .with_transition(Transition::event("start", flow(-1.0)).between("off", "on"))
        .with_transition(Transition::new("heat", flow(2.0)).within("on"))
        .with_transition(Transition::event("stop", flow(2.0)).between("on", "off"));
    let with = |heater: Choice| {
        HybridSystem::new(1.0)
            .with_state("T", Interval::new(0.0, 30.0))
            .with_input("u", Interval::new(-1.0, 1.0))
            .with_choice(heater)
    };
    let system = with(heater.clone());
    let point = Region::point([10.0]);
    let (off, on) =
        (point.clone().with_mode("heater", "off"), point.clone().with_mode("heater", "on"));
    // Off is held by u = 1; on would need u = -2.
    assert!(system.monotonicity(&off, &on).unwrap().is_monotone());
    let stuck = system.monotonicity(&point, &on).unwrap();
    let expected = "the start cannot be held in mode `on`; the goal cannot be held in mode `on`";
    assert_eq!(stuck.reason(), expected);
    // Off ends after three samples.
    let limited = with(heater.with_dwell("off", 1, 3));
    assert!(!limited.monotonicity(&off, &off).unwrap().is_monotone());
}

#[test]
fn time_steps_are_refuted_one_by_one_or_by_bisection() {
    let cart = |dt: f64| {
        let mut cart = HybridSystem::new(dt);
        let x = cart.state("x", -9.0, 9.0)?;
        let v = cart.state("v", -9.0, 9.0)?;
        let a = cart.input("a", -1.0, 1.0)?;
        cart.mode("roll")?.rates([(x, v.into()), (v, Affine::from(a))])?;
        Ok((cart, [x.equals(0.0), v.equals(0.0)], [x.equals(1.0), v.equals(0.0)]))
    };
    let steps: Vec<f64> = (1..=32).map(|k| 0.01 * f64::from(k)).collect();
    let grid = TimeStepGrid::new(10, steps);
    let run = |grid: &TimeStepGrid, sets: bool| {
        let options = ShortestOptions::default().with_reach_sets(sets);
        let mut solver = BranchAndBound::default();
        least_time_step(cart, grid, &options, &mut solver)
    };
    for sets in [false, true] {
        let found = run(&grid, sets).unwrap();
        assert!(found.is_proved);
        assert_eq!((found.time_step, found.refuted), (Some(0.2), Some(0.19)));
        assert_eq!(found.attempts.len(), 20);
        let run = found.run.unwrap();
        assert_eq!(run.time_step, 0.2);
        replayed(&cart(0.2).unwrap().0, &run);
    }
    let found = run(&grid.clone().with_monotone("each run can be slowed down"), true).unwrap();
    assert!(found.is_proved && found.attempts.len() <= 6);
    assert_eq!((found.time_step, found.refuted), (Some(0.2), Some(0.19)));
    // All are too short.
    let found = run(&TimeStepGrid::new(10, [0.05, 0.1]), true).unwrap();
    assert!(found.is_proved && found.run.is_none());
    assert_eq!((found.time_step, found.refuted), (None, Some(0.1)));
    for bad in [vec![], vec![0.2, 0.1], vec![0.0, 0.1], vec![f64::NAN]] {
        let error = run(&TimeStepGrid::new(10, bad), true).unwrap_err();
        assert!(matches!(error.kind(), ErrorKind::OutOfRange { .. }), "{error}");
    }
    assert!(run(&TimeStepGrid::new(0, [0.1]), true).is_err());
}

/// Feasible with five steps only, so a search that takes waiting for free misses it.
#[test]
fn a_single_feasible_horizon_is_found() {
    let system = HybridSystem::new(1.0)
        .with_state("x", Interval::new(0.0, 20.0))
        .with_transition(Transition::new("on", LinearSystem::new([[1.0]], [[]], [1.0]).unwrap()));
    let (start, goal) = (Region::point([0.0]), Region::point([5.0]));
    for sets in [false, true] {
        let options = ShortestOptions::default().with_max_steps(8).with_reach_sets(sets);
        let mut solver = BranchAndBound::default();
        let found = system.shortest_with(&start, &goal, &options, &mut solver).unwrap();
        assert!(!found.monotonicity.is_monotone());
        assert!(found.is_found());
        assert_eq!((found.steps, found.refuted_steps), (Some(5), Some(4)));
    }
}
