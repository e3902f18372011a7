//! Missions whose rows are nonlinear functions: true of a run if the test's own reading says so.

use carom::hybrid::Mission;
use carom::prelude::*;
use proptest::prelude::*;

/// A craft with a heading, whose steps are `x⁺ = x + Δt v cos θ` and so on.
struct Craft {
    system: HybridSystem,
    x: State,
    y: State,
    heading: State,
    speed: Input,
    turn: Input,
}

const STEP: f64 = 0.5;

fn craft() -> Craft {
    let mut system = HybridSystem::new(STEP);
    let x = system.state("x", -9.5, 9.5).unwrap();
    let y = system.state("y", -9.5, 9.5).unwrap();
    let heading = system.state("heading", -11.0, 11.0).unwrap();
    let speed = system.input("speed", 0.0, 2.0).unwrap();
    let turn = system.input("turn", -1.5, 1.5).unwrap();
    system.discretization(carom::hybrid::Discretization::Euler).unwrap();
    let rates = [x.is(speed * heading.cos()), y.is(speed * heading.sin()), heading.is(turn)];
    system.mode("drive").unwrap().rates(rates).unwrap();
    Craft { system, x, y, heading, speed, turn }
}

/// A mission: never in a pond, within some samples heads south, and on a ring at some time.
fn mission(craft: &Craft) -> Mission {
    let radius = (craft.x.square() + craft.y.square()).sqrt();
    let pond = Mission::holds("in the pond", [radius.le(0.8)]);
    let ring = Mission::holds("on the ring", [radius.within(1.0, 1.6)]);
    let south = Mission::holds("heads south", [craft.heading.sin().le(-0.8)]);
    (!pond).always(0..) & (south | ring.always(0..=1)).eventually(0..=5)
}

/// By how much a run does it, read without the crate.
fn robustness(samples: &[[f64; 3]]) -> f64 {
    let radius = |k: usize| samples[k][0].hypot(samples[k][1]);
    let all = (0..samples.len()).map(|k| radius(k) - 0.8).fold(f64::INFINITY, f64::min);
    let ring = |k: usize| (radius(k) - 1.0).min(1.6 - radius(k));
    let either = |k: usize| (-0.8 - samples[k][2].sin()).max(ring(k).min(ring(k + 1)));
    all.min((0..=5).map(either).fold(f64::NEG_INFINITY, f64::max))
}

#[test]
fn the_least_detour_around_a_pond() {
    let craft = craft();
    let mission = mission(&craft);
    let mut program = craft.system.program(6).unwrap();
    let start = [craft.x.equals(-1.5), craft.y.equals(0.0), craft.heading.equals(0.0)];
    program.start(start).unwrap();
    program.require_mission("mission", &mission).unwrap();
    program.maximize(program.end(craft.x).unwrap()).unwrap();
    let plan = program.solve(&mut BranchAndBound::default()).unwrap();
    let states: Vec<&[f64]> =
        ["x", "y", "heading"].map(|name| plan.run.state(name).unwrap()).to_vec();
    let samples: Vec<[f64; 3]> =
        (0..=6).map(|k| [states[0][k], states[1][k], states[2][k]]).collect();
    assert!(robustness(&samples) > -1e-6);
    assert!((plan.robustness(&mission).unwrap() - robustness(&samples)).abs() < 1e-9);
    // It cannot head south at once and go straight past the pond: without the mission it is faster.
    let best = samples[6][0];
    let mut free = craft.system.program(6).unwrap();
    free.start([craft.x.equals(-1.5), craft.y.equals(0.0), craft.heading.equals(0.0)]).unwrap();
    free.maximize(free.end(craft.x).unwrap()).unwrap();
    let straight = free.solve(&mut BranchAndBound::default()).unwrap().run.state("x").unwrap()[6];
    assert!((straight - 4.5).abs() < 1e-6 && best < straight - 1e-3, "{best}");
}

#[test]
fn margins_of_functions_are_maximised() {
    let craft = craft();
    let ring = (craft.x.square() + craft.y.square()).sqrt().within(1.0, 1.6);
    let mission = Mission::holds("on the ring", [ring]).always(1..=3);
    let mut program = craft.system.program(3).unwrap();
    let start = [craft.x.equals(-1.3), craft.y.equals(0.0), craft.heading.equals(1.5)];
    program.start(start).unwrap();
    let margin = program.mission_margin("margin", &mission, 0.0).unwrap();
    program.maximize(margin).unwrap();
    let plan = program.solve(&mut BranchAndBound::default()).unwrap();
    // It may stand still, in the middle of the ring.
    assert!((plan.value(margin, 0).unwrap() - 0.3).abs() < 1e-5);
    assert!((plan.robustness(&mission).unwrap() - 0.3).abs() < 1e-5);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn a_run_does_it_if_it_is_read_so(
        start in [-3.0..3.0_f64, -3.0..3.0_f64, -6.0..6.0_f64],
        inputs in prop::collection::vec([0.0..2.0_f64, -1.5..1.5_f64], 6),
    ) {
        let mut samples = vec![start];
        for [speed, turn] in &inputs {
            let [x, y, heading] = samples[samples.len() - 1];
            let (sin, cos) = heading.sin_cos();
            samples.push([x + STEP * speed * cos, y + STEP * speed * sin, heading + STEP * turn]);
        }
        let wanted = robustness(&samples);
        prop_assume!(wanted.abs() > 1e-3);
        let craft = craft();
        let [x, y, heading] = start;
        let mut program = craft.system.program(6).unwrap();
        let start = [craft.x.equals(x), craft.y.equals(y), craft.heading.equals(heading)];
        program.start(start).unwrap();
        for (t, [speed, turn]) in inputs.iter().enumerate() {
            let near = |own: Input, value: f64| own.within(value - 1e-7, value + 1e-7);
            let rows = [near(craft.speed, *speed), near(craft.turn, *turn)];
            program.require(&format!("inputs {t}"), rows, When::At(t)).unwrap();
        }
        program.require_mission("mission", &mission(&craft)).unwrap();
        let found = program.solve(&mut BranchAndBound::default());
        prop_assert_eq!(found.is_ok(), wanted > 0.0, "{}", wanted);
        if let Ok(plan) = found {
            let mission = mission(&craft);
            prop_assert!((plan.robustness(&mission).unwrap() - wanted).abs() < 1e-4);
            let run = craft.system.robustness(&mission, &plan.run).unwrap();
            prop_assert!((run - wanted).abs() < 1e-4);
        }
    }
}
