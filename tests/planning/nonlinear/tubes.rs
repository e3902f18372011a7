//! Tubes for the differential equations, beside disturbed motions that are integrated here.

use carom::hybrid::{Discretization, SimulationOptions};
use carom::prelude::*;
use carom_model::internals::random::SplitMix;
use proptest::prelude::*;

use super::fields::{FIELDS, STATES, Stated, declared, rates, step, value};
use crate::common::config;

/// Length of a step (s).
const STEP: f64 = 0.2;

/// A field whose first state is disturbed by `by`.
fn disturbed(field: usize, by: f64) -> Stated {
    let mut own = declared(field, STEP, Discretization::Midpoint);
    let rates = rates(field, &own.states, own.input);
    own.system.disturbance(own.states[0], -by, by).unwrap();
    own.system.mode("only").unwrap().rates(rates).unwrap();
    own
}

/// The number of disturbed motions from starts within a box that leave the tube of a plan; every
/// second disturbance is at an end of its range.
fn leave(field: usize, start: &[f64], inputs: &[f64], by: f64, wide: f64, runs: usize) -> usize {
    let own = disturbed(field, by);
    let list: Vec<[f64; 1]> = inputs.iter().map(|u| [*u]).collect();
    let run = own.system.simulate(start, &list).unwrap().to_run();
    let tube = own.system.motion_tube(&run, &vec![wide; start.len()]).unwrap();
    assert!(tube.holds(), "{:?}", tube.tightest);
    let plan: Vec<Vec<f64>> = ["a", "b", "c"][..start.len()]
        .iter()
        .map(|name| run.state(name).unwrap().to_vec())
        .collect();
    let mut random = SplitMix(field as u64 + 7);
    // From -1 to 1.
    let mut number = || 2.0 * random.part() - 1.0;
    let is_out = |t: usize, x: &[f64]| {
        // The formula here errs by some 1e-9.
        (0..x.len()).any(|i| (x[i] - plan[i][t]).abs() > tube.radii[t][i] + 1e-8)
    };
    let leaves = |_: &usize| {
        let mut x: Vec<f64> = start.iter().map(|x| x + wide * number()).collect();
        for t in 0..inputs.len() {
            let u = tube.input(t, &x).unwrap()[0];
            assert!((-1.0..=1.0).contains(&u));
            for _ in 0..20 {
                x = step(Discretization::RungeKutta4, &|x| value(field, x, u), STEP / 20.0, &x, &x);
            }
            let push = number();
            x[0] += by * if number() > 0.0 { push } else { push.signum() };
            if is_out(t + 1, &x) {
                return true;
            }
        }
        false
    };
    (0..runs).filter(leaves).count()
}

#[test]
fn no_disturbed_motion_leaves_the_tube() {
    let inputs = [0.4, 0.4, -0.2, -0.4, 0.1, 0.3, 0.0, 0.2];
    for (field, start) in [(1, &[0.0, 0.0, 0.3][..]), (2, &[1.0]), (3, &[0.5, -0.3])] {
        assert_eq!(leave(field, start, &inputs, 0.005, 0.02, 10_000), 0);
    }
}

proptest! {
    #![proptest_config(config(20, "tests/regressions/nonlinear_tubes.txt"))]

    #[test]
    fn tubes_hold_every_disturbed_motion(
        field in 1..FIELDS,
        start in prop::array::uniform3(-1.0..1.0_f64),
        inputs in prop::collection::vec(-0.3..0.3_f64, 1..6),
        by in 0.0..0.005_f64,
    ) {
        prop_assert_eq!(leave(field, &start[..STATES[field]], &inputs, by, 0.01, 100), 0);
    }
}

#[test]
fn uncertain_rebounds_are_part_of_the_tube() {
    // A ball without drag, whose restitution is from 0.4 to 0.6.
    let mut ball = HybridSystem::new(0.1); // s
    let height = ball.state("height", -1.0, 5.0).unwrap(); // m
    let speed = ball.state("speed", -9.0, 9.0).unwrap(); // m/s
    ball.rates([height.is(speed), speed.is(-9.81)]).unwrap();
    ball.mode("flight").unwrap().guard(height.predicted().ge(-0.5)).unwrap();
    ball.event("bounce")
        .unwrap()
        .guard(speed.predicted().le(0.0))
        .unwrap()
        .reset([speed.is(-0.5 * speed.predicted())])
        .unwrap()
        .uncertain(-0.1, 0.1, [speed.is(speed.predicted())])
        .unwrap();
    let options = SimulationOptions::default()
        .with_transitions(["flight", "bounce", "flight"].map(|own| vec![own.to_owned()]).to_vec());
    let none: [[f64; 0]; 3] = [[], [], []];
    let run = ball.simulate_with(&[1.0, -3.0], &none, &options).unwrap().to_run();
    let tube = ball.motion_tube(&run, &[0.0, 0.0]).unwrap();
    assert!(tube.holds());
    // 4.962 m/s before the rebound, of which up to a tenth is not known.
    assert!((tube.radii[2][1] - 0.4962).abs() < 1e-9, "{:?}", tube.radii);
    assert!((tube.radii[3][0] - 0.04962).abs() < 1e-9, "{:?}", tube.radii);
}

#[test]
fn a_tube_says_where_it_does_not_hold() {
    let own = disturbed(1, 0.01);
    let run = own.system.simulate(&[5.3, 0.0, 0.0], &[[0.0], [0.0]]);
    let run = run.unwrap().to_run();
    let tube = own.system.motion_tube(&run, &[0.1, 0.1, 0.1]).unwrap();
    assert!(!tube.holds());
    let (sample, condition, room) = tube.tightest.clone().unwrap();
    assert_eq!((sample, condition.to_string().contains("`a`")), (2, true));
    assert!(room < 0.0);
    assert!(tube.input(2, &[0.0, 0.0, 0.0]).is_err());
    assert!(tube.input(0, &[0.0]).is_err());
    assert!(own.system.motion_tube(&run, &[0.1]).is_err());
    assert!(own.system.motion_tube(&run, &[-0.1, 0.0, 0.0]).is_err());
}
