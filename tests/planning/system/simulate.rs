//! Simulations: which transitions are possible, by how much, and why a run ends.

use carom::ErrorKind;
use carom::hybrid::scene::{Body, Scene, Solid, Surface};
use carom::hybrid::{
    Condition, DeadEnd, HybridSystem, ImpactEstimate, LinearSystem, Restitution, SimulationOptions,
};
use carom::interval::Interval;
use carom_hybrid::internals::{Choice, Halfspace, Transition};
use carom_hybrid::internals::{Samples, replay_line};

fn wall() -> HybridSystem {
    super::wall(0.5, None)
}

fn heater() -> HybridSystem {
    let flow = |heat: f64| LinearSystem::new([[0.9]], [[]; 1], [0.5 + heat]).unwrap();
    let choice = Choice::new("heater")
        .with_transition(Transition::new("idle", flow(0.0)).within("off"))
        .with_transition(Transition::event("start", flow(1.0)).between("off", "on"))
        .with_transition(Transition::new("heat", flow(1.0)).within("on"))
        .with_transition(Transition::event("stop", flow(0.0)).between("on", "off"))
        .with_dwell("on", 2, 3);
    HybridSystem::new(1.0).with_state("T", Interval::new(0.0, 40.0)).with_choice(choice)
}

fn planned(names: &[&str]) -> SimulationOptions {
    let steps = names.iter().map(|name| vec![(*name).to_owned()]).collect();
    SimulationOptions::default().with_transitions(steps)
}

fn first_possible() -> SimulationOptions {
    SimulationOptions::default().with_first_possible(true)
}

#[test]
fn a_wall_is_hit_as_in_its_own_replay() {
    let inputs: Vec<[f64; 1]> = (0..120).map(|t| [((t * 7) % 5) as f64 * 0.3 - 0.95]).collect();
    let run = wall().simulate(&[1.0, -1.5], &inputs).unwrap();
    assert!(run.is_complete(), "{run}");
    let (x, v) = (run.state("x").unwrap(), run.state("v").unwrap());
    let a: Vec<f64> = inputs.iter().map(|u| u[0]).collect();
    let contact: Vec<bool> = run.steps.iter().map(|step| step.taken == ["impact"]).collect();
    assert!(run.events() > 1 && run.events() == contact.iter().filter(|c| **c).count());
    let plan = Samples { position: &x, velocity: &v, acceleration: &a, contact: &contact };
    let surface = Surface::bounce(Restitution::new(0.5).unwrap());
    let scene = Scene::new(0.1)
        .with_body(Body::new("ball", [Interval::new(-1e3, 1e3)], 1e3, 9.0))
        .with_obstacle(Solid::halfspace("wall", [1.0], 0.0, surface))
        .with_estimate(ImpactEstimate::EndOfStep);
    let (_, replay) = replay_line(&scene, &plan).unwrap();
    assert!(replay.largest_residual <= 1e-12 && replay.drift <= 1e-12, "{replay:?}");
}

#[test]
fn ties_and_dead_ends_say_by_how_much() {
    // The flight ends exactly at the wall.
    let run = wall().simulate(&[0.25, -2.5], &[[0.0]]).unwrap();
    assert_eq!(run.ambiguous_steps(), [0]);
    let candidates = &run.steps[0].candidates[0];
    assert!(candidates.iter().all(|c| c.is_possible && c.slack.abs() < 1e-12));
    assert_eq!(run.steps[0].taken, ["flight"]);
    let other = wall().simulate_with(&[0.25, -2.5], &[[0.0]], &planned(&["impact"])).unwrap();
    assert_eq!(other.last(), [0.0, 1.25]);

    // It ends behind the wall while moving away.
    let stuck = wall().simulate(&[0.0, -0.075], &[[1.0]]).unwrap();
    let Some(DeadEnd::Choice { step: 0, choice, candidates }) = &stuck.dead_end else {
        panic!("{stuck}")
    };
    assert_eq!(choice, "mode");
    assert!((candidates[0].slack + 0.0025).abs() < 1e-12 && !candidates[0].is_possible);
    let name = "moves towards it".to_owned();
    assert_eq!(candidates[1].tightest, Some(Condition::PredictionGuard { name }));
    assert!((candidates[1].slack + 0.025).abs() < 1e-12);
    let text = stuck.to_string();
    assert!(text.contains("no transition of `mode` is possible in step 0: `flight` violates"));

    // The plan is not possible.
    let wrong = wall().simulate_with(&[5.0, 0.0], &[[0.0]; 3], &planned(&["flight", "impact"]));
    let Some(DeadEnd::Planned { step: 1, candidate: Some(c), .. }) = wrong.unwrap().dead_end else {
        panic!()
    };
    assert!((c.slack + 5.0).abs() < 1e-12);
    // The start and the inputs are not allowed.
    let outside = wall().simulate(&[-1.0, 0.0], &[[0.0]]).unwrap();
    let Some(DeadEnd::Sample { step: 0, condition, violation }) = outside.dead_end else {
        panic!()
    };
    assert_eq!((condition, violation), (Condition::Domain { state: "x".into() }, 1.0));
    let strong = wall().simulate(&[5.0, 0.0], &[[3.0]]).unwrap();
    assert!(strong.to_string().contains("`flight` violates the range of `a` by 2.000e0"));
}

#[test]
fn modes_dwell_times_and_events_are_kept() {
    let on = first_possible().with_mode("heater", "on");
    let none: &[[f64; 0]] = &[[]; 6];
    // The first possible: off may last for ever.
    let run = heater().simulate_with(&[20.0], none, &first_possible()).unwrap();
    assert!(run.steps.iter().all(|step| step.taken == ["idle"] && step.events == 0));
    assert_eq!(run.modes[0], [Some("off".to_owned())]);
    // On may last for three samples: two steps stay, the third leaves.
    let run = heater().simulate_with(&[20.0], none, &on).unwrap();
    let taken: Vec<&str> = run.steps.iter().map(|step| step.taken[0].as_str()).collect();
    assert_eq!(taken, ["heat", "heat", "stop", "idle", "idle", "idle"]);
    // A start in the mode may have lasted before, so it may be left at once; an entry may not.
    let mut plan = planned(&["stop", "start", "stop"]);
    plan.memory = on.memory.clone();
    let run = heater().simulate_with(&[20.0], none, &plan).unwrap();
    let Some(DeadEnd::Planned { step: 2, candidate: Some(c), .. }) = run.dead_end else { panic!() };
    assert_eq!(c.tightest, Some(Condition::LeastDwell { mode: "on".into() }));
    assert_eq!(c.slack, -1.0);
    let run = heater().simulate_with(&[20.0], none, &planned(&["start", "heat", "heat", "heat"]));
    let Some(DeadEnd::Planned { step: 3, candidate: Some(c), .. }) = run.unwrap().dead_end else {
        panic!()
    };
    assert_eq!(c.tightest, Some(Condition::MostDwell { mode: "on".into() }));
    // One event: the heater cannot be stopped, and it may not stay on.
    let run = heater().with_most_events(1).simulate_with(
        &[20.0],
        none,
        &planned(&["start", "heat", "heat"]),
    );
    let run = run.unwrap();
    assert_eq!((run.events(), run.dead_end.as_ref().map(DeadEnd::step)), (1, Some(3)));
    assert!(run.to_string().contains("`stop` violates the limit on the number of events by 1"));
}

#[test]
fn choices_add_and_are_possible_together() {
    let flow = |push: [f64; 2]| {
        let eye = [[1.0, 0.0], [0.0, 1.0]];
        LinearSystem::new(eye, [[1.0], [0.0]], push).unwrap()
    };
    let thruster = |name: &str, push: [f64; 2]| {
        Choice::new(name)
            .with_transition(Transition::event("fire", flow(push)))
            .with_transition(Transition::new("rest", flow([0.0, 0.0])))
    };
    let system = HybridSystem::new(1.0)
        .with_state("x", Interval::new(-3.0, 3.0))
        .with_state("y", Interval::new(-3.0, 3.0))
        .with_input("u", Interval::new(-1.0, 1.0))
        .with_flow(flow([0.0, 0.0]))
        .with_choice(thruster("east", [2.0, 0.0]))
        .with_choice(thruster("north", [1.0, 1.0]));
    let inputs = [[-0.5], [0.25], [0.0]];
    let run = system.simulate_with(&[0.0, 0.0], &inputs, &first_possible()).unwrap();
    assert_eq!(run.taken(), [["fire", "fire"], ["rest", "rest"], ["rest", "rest"]]);
    assert_eq!(run.states[1], [2.5, 1.0]);
    let moves: Vec<usize> = run.steps.iter().map(|step| step.moves).collect();
    assert_eq!(moves, [4, 1, 1]);
    // Each alone would be too much.
    assert!(!run.steps[1].candidates[1][0].is_possible);
    assert!((run.steps[1].candidates[1][0].slack + 0.75).abs() < 1e-12);

    let few = system.clone().with_most_events(1);
    let few = few.simulate_with(&[0.0, 0.0], &[[0.0]; 3], &first_possible()).unwrap();
    assert_eq!(few.taken()[0], ["fire", "rest"]);
    assert_eq!((few.events(), few.is_complete()), (1, true));
    // No combination stays inside.
    let stuck = system.simulate(&[3.0, 0.0], &[[1.0]]).unwrap();
    let Some(DeadEnd::Combination { condition, violation, .. }) = stuck.dead_end else { panic!() };
    assert_eq!((condition, violation), (Condition::Domain { state: "x".into() }, 1.0));
}

#[test]
fn limits_by_step_disturbances_and_outputs() {
    let flow = LinearSystem::new([[1.0]], [[1.0]], [0.0]).unwrap();
    let step = Transition::new("step", flow.clone()).with_output("twice", [2.0], 1.0);
    let system = HybridSystem::new(1.0)
        .with_state("x", Interval::new(-9.0, 9.0))
        .with_input("u", vec![Interval::new(-1.0, 1.0), Interval::new(-2.0, 2.0)])
        .with_limit(Halfspace::new("door", [1.0], vec![9.0, 9.0, 2.0, 9.0]))
        .with_limit(Halfspace::new("power", [1.0, 1.0], 4.0))
        .with_disturbance([Interval::new(-0.5, 0.5)])
        .with_transition(step);
    let run = system.simulate(&[0.0], &[[1.0], [1.0], [2.0], [1.0]]).unwrap();
    assert_eq!(run.states, [[0.0], [1.0], [2.0], [4.0]]);
    assert_eq!(run.steps[2].outputs, [("twice".to_owned(), 9.0)]);
    let Some(DeadEnd::Sample { step: 3, condition, violation }) = &run.dead_end else { panic!() };
    assert_eq!((condition, *violation), (&Condition::Limit { name: "power".into() }, 1.0));
    let run = system.simulate(&[0.0], &[[1.0], [2.0]]).unwrap();
    assert!(run.to_string().contains("`step` violates the limit `door` by 1"), "{run}");

    let shaken = |w: f64| {
        let options = SimulationOptions::default().with_disturbances(vec![vec![w]]);
        system.simulate_with(&[0.0], &[[1.0], [0.5]], &options)
    };
    assert_eq!(shaken(0.25).unwrap().last(), [1.75]);
    let error = shaken(0.75).unwrap_err();
    assert_eq!(error.to_string(), "the disturbance of `x` is 0.75; it must be from -0.5 to 0.5");
}

#[test]
fn what_does_not_fit_is_refused() {
    let kind =
        |run: Result<_, carom::Error>| run.map(|_: carom::hybrid::Simulation| ()).unwrap_err();
    let error = kind(wall().simulate(&[1.0], &[[0.0]]));
    assert!(matches!(error.kind(), ErrorKind::Length { found: 1, expected: 2, .. }));
    let error = kind(wall().simulate(&[1.0, 0.0], &[[f64::NAN]]));
    assert!(matches!(error.kind(), ErrorKind::NotFinite { .. }));
    let options = SimulationOptions::default().with_mode("heater", "warm");
    let error = kind(heater().simulate_with(&[20.0], &[[]; 1], &options));
    assert!(matches!(error.kind(), ErrorKind::UnknownName { name, .. } if name == "warm"));
    let options = SimulationOptions::default().with_tolerance(-1.0);
    let error = kind(heater().simulate_with(&[20.0], &[[]; 1], &options));
    assert!(matches!(error.kind(), ErrorKind::OutOfRange { .. }));
    let names = planned(&["fly"]);
    let run = wall().simulate_with(&[1.0, 0.0], &[[0.0]], &names).unwrap();
    assert!(run.to_string().contains("there is no transition `fly`"));
}

#[test]
fn a_run_is_a_table() {
    let run = wall().simulate(&[0.25, -2.5], &[[0.5], [0.0]]).unwrap();
    let csv = run.to_run().to_csv();
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines[..2], ["time,x,v,a,impact speed,mode", "0,0.25,-2.5,0.5,0,flight"]);
    assert!(lines[3].ends_with(",,") && lines.len() == 4);
    assert_eq!(run.to_string().lines().count(), 4);
}

/// Twelve digits, exponents for what is small, no sign before a zero, and 0 for what a solve leaves
/// of it.
#[test]
fn numbers_of_a_table_are_readable() {
    let run = wall().simulate(&[1.0 / 3.0, -0.0], &[[1.4997e-11], [-0.0], [0.0], [1e-25]]).unwrap();
    let csv = run.to_run().to_csv();
    let lines: Vec<&str> = csv.lines().collect();
    assert!(lines[1].starts_with("0,0.333333333333,0,1.4997e-11,"), "{csv}");
    assert!(lines[2].starts_with("0.1,0.333333333333,"), "{csv}");
    assert!(lines[4].starts_with("0.3,0.33333333333") && !csv.contains("e-25"), "{csv}");
    for cell in csv.lines().skip(1).flat_map(|line| line.split(',')) {
        assert!(cell != "-0" && cell.len() < 18, "{csv}");
    }
}
