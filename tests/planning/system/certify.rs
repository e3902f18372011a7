//! Certificates of runs: what is simulated agrees, and one wrong number or name does not.

use crate::rows::wall::reflecting;
use carom::ErrorKind;
use carom::collision_tolerant::Wall;
use carom::hybrid::{Condition, HybridRun, HybridSystem, RunError};
use carom::interval::Interval;
use carom::prelude::*;
use carom::solution::Point;
use carom_hybrid::internals::HasParts;
use proptest::prelude::*;

use super::random::{follow_wishes, system, wishes};
use crate::common::config;

fn refusal(system: &HybridSystem, run: &HybridRun) -> RunError {
    let error = system.certify(run).unwrap_err();
    let ErrorKind::Run(own) = error.kind() else { panic!("{error}") };
    own.clone()
}

fn wall() -> HybridSystem {
    super::wall(0.5, None).with_most_events(2)
}

fn bounce() -> HybridRun {
    let inputs: Vec<[f64; 1]> = (0..12).map(|_| [0.25]).collect();
    wall().simulate(&[1.0, -2.0], &inputs).unwrap().to_run()
}

proptest! {
    #![proptest_config(config(150, "tests/regressions/certificates.txt"))]

    #[test]
    fn simulated_runs_are_certified(raw in system(), wishes in wishes()) {
        let system = raw.hybrid();
        let (start, inputs) = raw.cut(&wishes);
        let options = follow_wishes(&system, &start, &inputs, &wishes);
        let simulation = system.simulate_with(&start, &inputs, &options).unwrap();
        prop_assume!(!simulation.steps.is_empty());
        let run = simulation.to_run();
        let certificate = system.certify(&run).unwrap();
        prop_assert!(certificate.largest_residual <= 1e-12 && certificate.drift <= 1e-12);
        prop_assert!(certificate.largest_violation <= 1e-9);
        prop_assert_eq!(certificate.events, simulation.events());
    }

    /// The simulation and the rows, which share no code, agree about what a run is.
    #[test]
    fn simulated_runs_satisfy_the_rows(raw in system(), wishes in wishes()) {
        let system = raw.hybrid();
        let (start, inputs) = raw.cut(&wishes);
        let options = follow_wishes(&system, &start, &inputs, &wishes);
        let simulation = system.simulate_with(&start, &inputs, &options).unwrap();
        prop_assume!(!simulation.steps.is_empty());
        let run = simulation.to_run();
        let mut model = Model::new("m");
        let program = system.write(&mut model, "", simulation.steps.len()).unwrap();
        let mut values = vec![0.0; model.variable_count()];
        for (variable, value) in program.values(&run).unwrap() {
            values[variable.index()] = value;
        }
        let point = Point::new(&model, values).unwrap();
        let verification = Verification::of(&model, &point, 1e-6);
        prop_assert!(verification.holds(), "{:?}\n{}", verification.violations(), system);
    }

    #[test]
    fn one_wrong_number_is_named(raw in system(), wishes in wishes(), place in any::<[u8; 3]>()) {
        let system = raw.hybrid();
        let (start, inputs) = raw.cut(&wishes);
        let first = SimulationOptions::default().with_first_possible(true);
        let simulation = system.simulate_with(&start, &inputs, &first).unwrap();
        prop_assume!(!simulation.steps.is_empty());
        let mut run = simulation.to_run();
        let steps = simulation.steps.len();
        // Not the first sample: that is another run.
        let (sample, state) =
            (1 + usize::from(place[0]) % steps, usize::from(place[1]) % run.states.len());
        run.states[state].1[sample] += if place[2] < 128 { 1e-4 } else { -1e-4 };
        let found = refusal(&system, &run);
        let RunError::State { sample: at, state: name, residual, .. } = &found else {
            // The step to the sample is checked first, unless its transitions are not possible.
            panic!("{found}")
        };
        prop_assert_eq!((*at, name), (sample, &run.states[state].0));
        prop_assert!((residual - 1e-4).abs() < 1e-9);
    }

    #[test]
    fn another_transition_is_refused_or_leads_to_the_same(
        raw in system(), wishes in wishes(), place in any::<[u8; 3]>(),
    ) {
        let system = raw.hybrid();
        let (start, inputs) = raw.cut(&wishes);
        let first = SimulationOptions::default().with_first_possible(true);
        let simulation = system.simulate_with(&start, &inputs, &first).unwrap();
        prop_assume!(!simulation.steps.is_empty());
        let mut run = simulation.to_run();
        let c = usize::from(place[0]) % system.parts().choices.len();
        let t = usize::from(place[1]) % simulation.steps.len();
        let transitions = &system.parts().choices[c].transitions;
        let other = &transitions[usize::from(place[2]) % transitions.len()].name;
        prop_assume!(run.transitions[c].1[t] != *other);
        run.transitions[c].1[t].clone_from(other);
        run.modes.clear();
        let Err(error) = system.certify(&run) else {
            // A tie: it was possible, to the tolerance of a certificate.
            return Ok(());
        };
        let ErrorKind::Run(own) = error.kind() else { panic!("{error}") };
        match own {
            RunError::Transition { step, transition, .. } => {
                // Modes, dwell times and events may tell at a later step.
                prop_assert!(*step > t || (*step, transition) == (t, other), "{}", error);
            }
            RunError::State { sample, .. } => prop_assert_eq!(*sample, t + 1),
            RunError::Output { step, .. } => prop_assert_eq!(*step, t),
            RunError::Sample { condition, .. } => {
                prop_assert_eq!(condition, &Condition::MostEvents);
            }
            other => panic!("{other}"),
        }
    }
}

proptest! {
    #![proptest_config(config(24, "tests/regressions/certified_solutions.txt"))]

    #[test]
    fn solutions_of_random_systems_are_certified(
        raw in system(), steps in 1..5_usize, weights in prop::collection::vec(-1.0..1.0_f64, 5),
    ) {
        let system = raw.hybrid();
        let mut model = Model::new("m");
        let program = system.write(&mut model, "", steps).unwrap();
        let families = program.states().iter().chain(program.inputs());
        let terms = families.zip(&weights).flat_map(|(family, weight)| {
            family.iter().enumerate().map(move |(t, v)| (1.0 + t as f64) * *weight * v)
        });
        let cost: Affine = terms.sum();
        model.minimize(cost).unwrap();
        let solution = BranchAndBound::default().solve(&model).unwrap();
        prop_assume!(solution.point().is_some());
        let (run, certificate) = program.certified(&solution).unwrap();
        prop_assert!(certificate.largest_residual <= 1e-6);
        prop_assert_eq!(run.transitions.len(), system.parts().choices.len());
    }
}

#[test]
fn what_is_wrong_is_named() {
    let run = bounce();
    let certificate = wall().certify(&run).unwrap();
    assert_eq!((certificate.events, certificate.ties.len()), (1, 0));
    let hit = run.transitions("mode").unwrap().iter().position(|t| t == "impact").unwrap();

    let mut wrong = run.clone();
    wrong.transitions[0].1[hit] = "flight".into();
    let RunError::Transition { step, transition, condition, violation, .. } =
        refusal(&wall(), &wrong)
    else {
        panic!()
    };
    let name = "ends in front".to_owned();
    assert_eq!((step, transition.as_str()), (hit, "flight"));
    assert_eq!(condition, Condition::PredictionGuard { name });
    assert!(violation > 1e-3);

    let mut wrong = run.clone();
    wrong.inputs[0].1[3] = 1.5;
    let RunError::Transition { step: 3, condition, .. } = refusal(&wall(), &wrong) else {
        panic!()
    };
    assert_eq!(condition, Condition::InputRange { input: "a".into() });

    let mut wrong = run.clone();
    wrong.outputs[0].1[hit] += 0.1;
    let RunError::Output { step, output, .. } = refusal(&wall(), &wrong) else { panic!() };
    assert_eq!((step, output.as_str()), (hit, "impact speed"));

    let none = wall().with_most_events(0);
    let RunError::Transition { condition, .. } = refusal(&none, &run) else { panic!() };
    assert_eq!(condition, Condition::MostEvents);

    let mut narrow = wall();
    narrow.parts_mut().states[0].1 = Interval::new(0.0, 0.9);
    let RunError::Sample { sample: 0, condition, .. } = refusal(&narrow, &run) else { panic!() };
    assert_eq!(condition, Condition::Domain { state: "x".into() });

    let mut short = run.clone();
    short.inputs[0].1.pop();
    assert!(wall().certify(&short).unwrap_err().to_string().contains("inputs of the run"));
    let mut odd = run;
    odd.transitions[0].1[0] = "fly".into();
    assert!(wall().certify(&odd).unwrap_err().to_string().contains("`fly`"));
}

#[test]
fn modes_are_compared() {
    let room =
        HybridSystem::thermostat(60.0, 1800.0, 5.0, 40.0, Interval::new(19.0, 21.0)).unwrap();
    let off = SimulationOptions::default().with_mode("heater", "off");
    let run = room.simulate_with(&[19.5], &[[]; 100], &off).unwrap().to_run();
    let certificate = room.certify(&run).unwrap();
    assert!(certificate.events > 2);
    let mut wrong = run;
    let last = wrong.modes[0].1.last_mut().unwrap();
    *last = if last == "on" { "off".into() } else { "on".into() };
    assert!(matches!(refusal(&room, &wrong), RunError::Mode { sample: 100, .. }));
}

#[test]
fn solutions_are_certified() {
    let system = wall();
    let mut model = Model::new("m");
    let program = system.write(&mut model, "", 15).unwrap();
    let (x, v) = (program.state("x").unwrap().clone(), program.state("v").unwrap().clone());
    for (variable, value) in [(x[0], 1.0), (v[0], -2.0)] {
        model.fix(variable, value).unwrap();
    }
    model.maximize(x[15]).unwrap();
    let solution = BranchAndBound::default().solve(&model).unwrap();
    let (run, certificate) = program.certified(&solution).unwrap();
    assert_eq!(certificate.events, 1);
    assert!(certificate.drift < 1e-5);
    assert_eq!(run.transitions("mode").unwrap().len(), 15);
    // The same program of another restitution: what was solved is not what is stated.
    let [flight, impact] = reflecting(Wall::default(), 0.6, 0.1, None);
    let mut other = system;
    other.parts_mut().choices[0].transitions = vec![flight, impact];
    assert!(matches!(refusal(&other, &run), RunError::State { .. }));
}
