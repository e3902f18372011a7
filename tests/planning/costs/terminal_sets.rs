//! Terminal sets: points inside stay, points outside do not.

use carom::hybrid::{
    HybridSystem, LinearSystem, Lqr, Matrix, TerminalError, TerminalOptions, TerminalSet,
};
use carom::interval::Interval;
use carom::prelude::*;
use carom_hybrid::internals::HasParts;
use carom_hybrid::internals::{Choice, Halfspace, Transition};
use proptest::prelude::*;

use crate::common::config;

fn reason(error: &carom::Error) -> TerminalError {
    let carom::ErrorKind::Terminal(own) = error.kind() else { panic!("{error}") };
    own.clone()
}

/// A limit on the state and the input, as plain numbers: `state . x + input . u <= limit`.
type Plain = (Vec<f64>, Vec<f64>, f64);

fn holds(limits: &[Plain], x: &[f64], u: &[f64], tolerance: f64) -> bool {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    limits.iter().all(|(state, input, limit)| dot(state, x) + dot(input, u) <= limit + tolerance)
}

fn boxed(n: usize, m: usize, domain: f64, range: f64) -> Vec<Plain> {
    let unit = |length: usize, i: usize, sign: f64| -> Vec<f64> {
        (0..length).map(|j| if i == j { sign } else { 0.0 }).collect()
    };
    let states = (0..n).flat_map(|i| [1.0, -1.0].map(|s| (unit(n, i, s), vec![0.0; m], domain)));
    let inputs = (0..m).flat_map(|i| [1.0, -1.0].map(|s| (vec![0.0; n], unit(m, i, s), range)));
    states.chain(inputs).collect()
}

proptest! {
    #![proptest_config(config(12, "tests/regressions/terminal_sets.txt"))]

    #[test]
    fn points_inside_stay_and_points_outside_break_a_limit(
        n in prop::sample::select(vec![1, 2, 2, 3, 3]),
        weight in 1.0..1e4_f64,
        entries in prop::collection::vec(-1.1..1.1_f64, 9),
        gains in prop::collection::vec(-1.0..1.0_f64, 3),
        target in prop::collection::vec(-0.5..0.5_f64, 3),
        normal in prop::collection::vec(-1.0..1.0_f64, 4),
        points in prop::collection::vec(prop::collection::vec(-1.0..1.0_f64, 3), 40),
    ) {
        let a = Matrix::from_fn(n, n, |i, j| entries[3 * i + j]);
        let b = Matrix::from_fn(n, 1, |i, _| if i + 1 == n { 1.0 } else { 0.3 * gains[i] });
        // The constant part makes the target an equilibrium at the input 0.1.
        let c: Vec<f64> = (0..n)
            .map(|i| {
                let moved: f64 = (0..n).map(|j| a[(i, j)] * target[j]).sum();
                target[i] - moved - 0.1 * b[(i, 0)]
            })
            .collect();
        let flow = LinearSystem::new(a, b, c).unwrap();
        let Ok(lqr) = Lqr::new(&flow, Matrix::identity(n), [[weight]]) else {
            return Err(TestCaseError::reject("no regulator"));
        };
        prop_assume!(lqr.spectral_radius < 0.97);
        let target = &target[..n];
        // A guard on the state and the input, and one on the prediction.
        let mut joint = normal[..n].to_vec();
        joint.push(normal[3]);
        let at = |x: &[f64], u: f64| joint[..n].iter().zip(x).map(|(a, x)| a * x).sum::<f64>() + joint[n] * u;
        let limit = at(target, 0.1) + 0.7;
        let mut system = HybridSystem::new(1.0).with_input("u", Interval::new(-1.0, 1.0));
        for i in 0..n {
            system = system.with_state(format!("x{i}"), Interval::new(-2.0, 2.0));
        }
        let system = system.with_transition(
            Transition::new("go", flow.clone())
                .with_guard(Halfspace::new("joint", joint.clone(), limit))
                .with_prediction_guard(Halfspace::new("low", normal[..n].to_vec(), 3.0)),
        );
        let mut limits = boxed(n, 1, 2.0, 1.0);
        limits.push((joint[..n].to_vec(), vec![joint[n]], limit));

        let mut solver = BranchAndBound::default();
        let options = TerminalOptions::default();
        let set = TerminalSet::new(&system, &["go"], &lqr, target, &options, &mut solver);
        let set = match set {
            Ok(set) => set,
            Err(error) => {
                prop_assert!(matches!(reason(&error), TerminalError::AtLimit { .. }), "{error}");
                return Ok(());
            }
        };
        prop_assert!((set.input[0] - 0.1).abs() < 1e-9);
        let low = |x: &[f64]| normal[..n].iter().zip(x).map(|(a, x)| a * x).sum::<f64>();
        // Whether the run keeps all limits, and whether it stays in the set.
        let run = |start: &[f64]| {
            let (mut x, mut keeps, mut stays) = (start.to_vec(), true, true);
            for _ in 0..300 {
                let u = set.feedback(&x).unwrap();
                let y = flow.step(&x, &u).unwrap();
                keeps &= holds(&limits, &x, &u, 1e-9) && low(&y) <= 3.0 + 1e-9;
                stays &= set.region.contains(&x, 1e-9).unwrap();
                x = y;
            }
            (keeps, stays)
        };
        for point in &points {
            // The crossing of the ray with the set's border, by bisection.
            let ray = |s: f64| -> Vec<f64> {
                target.iter().zip(point).map(|(at, d)| at + s * d).collect()
            };
            let (mut inside, mut outside) = (0.0, 1e3);
            for _ in 0..60 {
                let middle = 0.5 * (inside + outside);
                match set.region.contains(&ray(middle), 0.0).unwrap() {
                    true => inside = middle,
                    false => outside = middle,
                }
            }
            prop_assert_eq!(run(&ray(inside)), (true, true));
            prop_assert_eq!(run(&ray(0.6 * inside)), (true, true));
            // 1e-4 a step is the margin.
            let margin = 1.0 + 2e-4 * (set.iterations + 1) as f64;
            prop_assert!(!run(&ray(margin * outside)).0);
        }
    }
}

fn elevator() -> (HybridSystem, LinearSystem) {
    let line = LinearSystem::double_integrator(0.1).unwrap();
    let fast = LinearSystem::new(
        line.a(),
        Matrix::from_fn(2, 1, |i, j| 2.0 * line.b()[(i, j)]),
        [0.0, 0.0],
    )
    .unwrap();
    let system = HybridSystem::new(1.0)
        .with_state("x", Interval::new(0.0, 15.0))
        .with_state("v", Interval::new(-2.5, 2.5))
        .with_input("u", Interval::new(-1.0, 1.0))
        .with_transition(Transition::new("low", line.clone()))
        .with_transition(Transition::event("high", fast).with_guard(Halfspace::new(
            "fast",
            [0.0, -1.0],
            -0.4,
        )));
    (system, line)
}

#[test]
fn what_has_no_terminal_set_is_refused() {
    let (system, line) = elevator();
    let lqr = Lqr::new(&line, [[1.0, 0.0], [0.0, 1.0]], [[1.0]]).unwrap();
    let build = |system: &HybridSystem, transition: &str, lqr: &Lqr, at: [f64; 2], most: usize| {
        let options = TerminalOptions::default().with_most_iterations(most);
        TerminalSet::new(system, &[transition], lqr, &at, &options, &mut BranchAndBound::default())
    };
    let set = build(&system, "low", &lqr, [12.0, 0.0], 100).unwrap();
    assert!(set.region.contains(&[12.3, 0.1], 0.0).unwrap());
    let refused = |transition: &str, at: [f64; 2], most: usize| {
        reason(&build(&system, transition, &lqr, at, most).unwrap_err())
    };
    assert_eq!(refused("low", [12.0, 0.0], 2), TerminalError::NotDetermined { iterations: 2 });
    // At rest, high gear is not allowed.
    let TerminalError::AtLimit { limit, slack } = refused("high", [12.0, 0.0], 100) else {
        panic!("a guard")
    };
    assert_eq!((limit.as_str(), slack), ("fast", -0.4));
    let at_end = refused("low", [15.0, 0.0], 100);
    assert_eq!(at_end, TerminalError::AtLimit { limit: "x".into(), slack: 0.0 });
    let TerminalError::NoEquilibrium { state, .. } = refused("low", [5.0, 1.0], 100) else {
        panic!("it moves")
    };
    assert_eq!(state, "x");
    let slip = Lqr::new(
        &LinearSystem::new([[0.5, 0.0], [0.0, 0.5]], [[0.0], [1.0]], [0.0; 2]).unwrap(),
        [[1.0, 0.0], [0.0, 1.0]],
        [[1.0]],
    )
    .unwrap();
    let error = reason(&build(&system, "low", &slip, [5.0, 0.0], 100).unwrap_err());
    assert!(matches!(error, TerminalError::NotStabilising { .. }));
    let limited = system.clone().with_most_events(3);
    let error = reason(&build(&limited, "high", &lqr, [5.0, 0.0], 100).unwrap_err());
    assert!(matches!(error, TerminalError::CannotStay { .. }));
    let error = build(&system, "middle", &lqr, [5.0, 0.0], 100).unwrap_err();
    assert_eq!(error.to_string(), "the model has no transition of the choice named `middle`");
}

/// The domains imply every limit at the first step, but not those of the second.
#[test]
fn limits_that_cut_only_after_a_step_are_seen() {
    let flow = LinearSystem::new([[0.0, -1.5], [0.0, 0.2]], [[0.0], [0.1]], [0.0; 2]).unwrap();
    let system = HybridSystem::new(1.0)
        .with_state("x", Interval::new(-2.0, 2.0))
        .with_state("y", Interval::new(-2.0, 2.0))
        .with_input("u", Interval::new(-9.0, 9.0))
        .with_transition(Transition::new("go", flow.clone()));
    let lqr = Lqr::new(&flow, [[1.0, 0.0], [0.0, 1.0]], [[1e3]]).unwrap();
    let (options, solver) = (TerminalOptions::default(), &mut BranchAndBound::default());
    let set = TerminalSet::new(&system, &["go"], &lqr, &[0.0; 2], &options, solver).unwrap();
    // |1.5 y| <= 2 after a step.
    assert!(set.region.contains(&[1.9, 1.3], 0.0).unwrap());
    assert!(!set.region.contains(&[0.0, 1.4], 0.0).unwrap());
}

#[test]
fn the_mode_is_part_of_the_set() {
    let flow = |heat: f64| LinearSystem::new([[0.9]], [[0.1]], [heat]).unwrap();
    let heater = Choice::new("heater")
        .with_transition(Transition::new("idle", flow(0.0)).within("off"))
        .with_transition(Transition::event("start", flow(1.0)).between("off", "on"))
        .with_transition(Transition::new("heat", flow(1.0)).within("on"))
        .with_transition(Transition::event("stop", flow(0.0)).between("on", "off"));
    let system = HybridSystem::new(1.0)
        .with_state("T", Interval::new(0.0, 30.0))
        .with_input("fan", Interval::new(-9.0, 9.0))
        .with_choice(heater.clone());
    let lqr = Lqr::new(&flow(1.0), [[1.0]], [[1.0]]).unwrap();
    let options = TerminalOptions::default();
    let build = |system: &HybridSystem, transition: &str| {
        let solver = &mut BranchAndBound::default();
        TerminalSet::new(system, &[transition], &lqr, &[12.0], &options, solver)
    };
    let set = build(&system, "heat").unwrap();
    assert_eq!(*set.region.parts().modes, [("heater".to_owned(), "on".to_owned())]);
    assert!((set.input[0] - 2.0).abs() < 1e-9);
    for (transition, heater) in [("start", heater.clone()), ("heat", heater.with_dwell("on", 1, 5))]
    {
        let mut system = system.clone();
        *system.parts_mut().choices = vec![heater];
        let error = reason(&build(&system, transition).unwrap_err());
        assert!(matches!(error, TerminalError::CannotStay { .. }), "{error}");
    }
}

#[test]
fn choices_add_up() {
    // Two thrusters, each on or off, about a flow that brakes.
    let flow = |push: f64| LinearSystem::new([[0.8]], [[0.5]], [push]).unwrap();
    let thruster = |name: &str| {
        Choice::new(name)
            .with_transition(Transition::new(format!("{name} on"), flow(0.2)))
            .with_transition(Transition::new(format!("{name} off"), flow(0.0)))
    };
    let system = HybridSystem::new(1.0)
        .with_state("v", Interval::new(-3.0, 3.0))
        .with_input("u", Interval::new(-1.0, 1.0))
        .with_flow(flow(0.0))
        .with_choice(thruster("left"))
        .with_choice(thruster("right"));
    let lqr = Lqr::new(&flow(0.0), [[1.0]], [[1.0]]).unwrap();
    let options = TerminalOptions::default();
    let names = ["left on", "right on"];
    let set =
        TerminalSet::new(&system, &names, &lqr, &[1.0], &options, &mut BranchAndBound::default());
    // 0.8 + 0.4 + 0.5 u = 1.
    assert!((set.unwrap().input[0] + 0.4).abs() < 1e-12);
}
