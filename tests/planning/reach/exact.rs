//! Sets that are known exactly.

use crate::common::config;
use crate::rows::wall::reflecting;
use carom::collision_tolerant::Wall;
use carom::hybrid::reach::{ReachSet, ReachSets, SetOptions};
use carom::hybrid::{HybridSystem, LinearSystem, Matrix};
use carom::interval::Interval;
use carom_hybrid::internals::{Halfspace, Transition};
use proptest::prelude::*;

fn points(state: &[f64]) -> Vec<Interval> {
    state.iter().map(|&x| Interval::point(x)).collect()
}

/// A mass on each of `axes` lines, within ±1000, pushed with at most 1 m/s².
fn masses(axes: usize, dt: f64) -> HybridSystem {
    let n = 2 * axes;
    let a = Matrix::from_fn(n, n, |i, j| match (i, j) {
        _ if i == j => 1.0,
        _ if i % 2 == 0 && j == i + 1 => dt,
        _ => 0.0,
    });
    let b = Matrix::from_fn(n, axes, |i, j| match i {
        _ if i == 2 * j => 0.5 * dt * dt,
        _ if i == 2 * j + 1 => dt,
        _ => 0.0,
    });
    let flow = LinearSystem::new(a, b, vec![0.0; n]).unwrap();
    let mut system = HybridSystem::new(1.0).with_transition(Transition::new("flight", flow));
    for k in 0..axes {
        system = system.with_state(format!("x{k}"), Interval::new(-1e3, 1e3));
        system = system.with_state(format!("v{k}"), Interval::new(-1e3, 1e3));
        system = system.with_input(format!("a{k}"), Interval::new(-1.0, 1.0));
    }
    system
}

/// The largest value of `p x + q v` that a mass can have after some steps from rest at 0: each
/// step's push has its own sign.
fn support(p: f64, q: f64, steps: usize, dt: f64) -> f64 {
    (0..steps)
        .map(|k| {
            let left = (steps - 1 - k) as f64 * dt;
            (p * (0.5 * dt * dt + dt * left) + q * dt).abs()
        })
        .sum()
}

proptest! {
    #![proptest_config(config(96, "tests/regressions/reach.txt"))]

    #[test]
    fn a_mass_is_where_pushing_can_bring_it(
        p in -1.0..1.0_f64, q in -1.0..1.0_f64, steps in 1..60_usize, axes in 1..=3_usize,
    ) {
        let dt = 0.25;
        let options = SetOptions::default().with_margin(0.0);
        let rest = points(&vec![0.0; 2 * axes]);
        let mut sets = ReachSets::new(&masses(axes, dt), &rest, &rest, options).unwrap();
        let set = sets.forward(steps).unwrap().swap_remove(0).unwrap();
        // Every axis of a decoupled system is exact.
        let direction: Vec<f64> = (0..axes).flat_map(|_| [p, q]).collect();
        let expected = axes as f64 * support(p, q, steps, dt);
        let found = set.support(&direction).unwrap();
        prop_assert!(found >= expected - 1e-12 && found - expected <= 1e-9 * (1.0 + expected));
        // A state just inside and one just outside, along the direction.
        let inside: Vec<f64> = set.bounding_box().iter().map(|_| 0.0).collect();
        prop_assert!(set.contains(&inside).unwrap());
        let size = p * p + q * q;
        prop_assume!(size > 1e-3);
        let reach = support(p, q, steps, dt) / size + 1e-6;
        let mut outside = vec![0.0; 2 * axes];
        (outside[0], outside[1]) = (p * reach, q * reach);
        prop_assert!(!set.contains(&outside).unwrap());
    }
}

#[test]
fn simplified_polygons_only_grow() {
    let (dt, rest) = (0.05, points(&[0.0, 0.0]));
    let sets = |vertices| {
        let options = SetOptions::default().with_margin(0.0).with_vertices(vertices);
        ReachSets::new(&masses(1, dt), &rest, &rest, options).unwrap()
    };
    let (mut fine, mut coarse) = (sets(1000), sets(16));
    let mut last = 0.0;
    for steps in [5, 20, 80] {
        let (fine, coarse) = (fine.forward(steps).unwrap(), coarse.forward(steps).unwrap());
        let (fine, coarse) = (fine[0].as_ref().unwrap(), coarse[0].as_ref().unwrap());
        assert!(coarse.outline(0, 1).unwrap().len() <= 18);
        for k in 0..32 {
            let angle = f64::from(k) * std::f64::consts::PI / 16.0;
            let direction = [angle.cos(), angle.sin()];
            let (a, b) = (fine.support(&direction).unwrap(), coarse.support(&direction).unwrap());
            assert!(b >= a - 1e-12, "{b} < {a} after {steps} steps");
            last = f64::max(last, b - a);
        }
    }
    assert!(last > 1e-6, "the coarse polygon is not simplified at all");
}

#[test]
fn one_state_is_an_interval() {
    // x⁺ = x/2 + u, |u| <= 1, from [3, 4]: the ends are geometric series.
    let flow = LinearSystem::new(
        Matrix::from_fn(1, 1, |_, _| 0.5),
        Matrix::from_fn(1, 1, |_, _| 1.0),
        vec![0.0],
    );
    let system = HybridSystem::new(1.0)
        .with_state("x", Interval::new(-50.0, 50.0))
        .with_input("u", Interval::new(-1.0, 1.0))
        .with_transition(Transition::new("step", flow.unwrap()));
    let options = SetOptions::default().with_margin(0.0);
    let (start, goal) = ([Interval::new(3.0, 4.0)], [Interval::new(-2.0, -1.9)]);
    let mut sets = ReachSets::new(&system, start, goal, options).unwrap();
    let after = |t: i32| (3.0 + 2.0) / 2.0_f64.powi(t) - 2.0;
    for t in 0..=8 {
        let set = sets.forward(t).unwrap().swap_remove(0).unwrap();
        let range = set.bounding_box()[0];
        assert!((range.lower - after(t as i32)).abs() < 1e-12, "{range:?} at {t}");
    }
    // 5/2^t - 2 <= -1.9 from t = 6 on.
    assert!(!sets.may_finish(5).unwrap() && sets.may_finish(6).unwrap());
    let before = sets.backward(1).unwrap().swap_remove(0).unwrap().bounding_box()[0];
    assert!((before.lower - -6.0).abs() < 1e-12 && (before.upper - -1.8).abs() < 1e-12);
}

#[test]
fn three_coupled_states_are_bounded_tightly_along_the_axes() {
    // A chain of integrators: jerk, acceleration, velocity.
    let dt = 0.5;
    let a = faer_chain(dt);
    let b = Matrix::from_fn(3, 1, |i, _| [dt * dt * dt / 6.0, dt * dt / 2.0, dt][i]);
    let flow = LinearSystem::new(a, b, vec![0.0; 3]).unwrap();
    let mut system = HybridSystem::new(1.0)
        .with_input("jerk", Interval::new(-1.0, 1.0))
        .with_transition(Transition::new("flight", flow));
    for name in ["x", "v", "a"] {
        system = system.with_state(name, Interval::new(-1e3, 1e3));
    }
    let rest = points(&[0.0; 3]);
    let options = SetOptions::default().with_margin(0.0);
    let mut plain = ReachSets::new(&system, &rest, &rest, options.clone()).unwrap();
    let steps = 6;
    // Directions that the position's limit is pulled back through make it exact.
    let mut options = options;
    for k in 1..steps {
        let s = k as f64 * dt;
        options = options.with_direction([1.0, s, 0.5 * s * s]);
    }
    let mut sharp = ReachSets::new(&system, &rest, &rest, options).unwrap();
    let exact: f64 = (0..steps)
        .map(|k| {
            let s = (steps - 1 - k) as f64 * dt;
            dt * dt * dt / 6.0 + s * dt * dt / 2.0 + 0.5 * s * s * dt
        })
        .sum();
    let position = |sets: &mut ReachSets| {
        sets.forward(steps).unwrap()[0].as_ref().unwrap().support(&[1.0, 0.0, 0.0]).unwrap()
    };
    let (plain, sharp) = (position(&mut plain), position(&mut sharp));
    assert!(plain >= exact - 1e-12 && plain <= 1.5 * exact, "{plain} against {exact}");
    assert!((sharp - exact).abs() <= 1e-9 * exact, "{sharp} against {exact}");
}

fn faer_chain(dt: f64) -> Matrix {
    Matrix::from_fn(3, 3, |i, j| match j as i32 - i as i32 {
        0 => 1.0,
        1 => dt,
        2 => 0.5 * dt * dt,
        _ => 0.0,
    })
}

#[test]
fn layers_tell_bounces_apart() {
    // A ball from 5 m at 0 m/s, no input to speak of: each bounce halves its speed.
    let [flight, impact] = reflecting(Wall::default(), 0.5, 0.1, None);
    let system = HybridSystem::new(1.0)
        .with_state("x", Interval::new(0.0, 9.0))
        .with_state("v", Interval::new(-15.0, 15.0))
        .with_input("a", Interval::point(-10.0))
        .with_transition(flight)
        .with_transition(impact);
    let start = points(&[5.0, 0.0]);
    let mut sets = ReachSets::new(&system, &start, &start, SetOptions::default()).unwrap();
    let alive = |sets: &mut ReachSets, t| -> Vec<bool> {
        sets.forward(t).unwrap().iter().map(Option::is_some).collect()
    };
    assert_eq!(alive(&mut sets, 9), [true, false, false, false]);
    // It meets the floor in the step from 1 s (0 m, within the margin of touching without one).
    assert_eq!(alive(&mut sets, 12), [false, true, false, false]);
    let set: ReachSet = sets.forward(12).unwrap().swap_remove(1).unwrap();
    assert!(set.bounding_box()[1].lower > 0.0, "it moves up after the bounce");
    assert!((15..60).any(|t| alive(&mut sets, t)[3]), "three bounces and more share a layer");
}

#[test]
fn a_limit_between_states_links_their_blocks() {
    let independent = masses(2, 0.5);
    let linked = independent.clone().with_limit(Halfspace::limit(
        "the two stay close",
        [1.0, 0.0, -1.0, 0.0],
        0.1,
    ));
    let rest = points(&[0.0; 4]);
    for (system, expected) in [(independent, 1.0), (linked, 0.1)] {
        let mut sets = ReachSets::new(&system, &rest, &rest, SetOptions::default()).unwrap();
        let set = sets.forward(2).unwrap().swap_remove(0).unwrap();
        let apart = set.support(&[1.0, 0.0, -1.0, 0.0]).unwrap();
        assert!((apart - expected).abs() < 1e-4, "{apart}, expected {expected}");
    }
}

#[test]
fn sets_that_grow_no_more_are_recognised() {
    // v decays to 2 at most; x is not there: from 0 the velocity 3 is never reached.
    let flow = LinearSystem::new(
        Matrix::from_fn(1, 1, |_, _| 0.5),
        Matrix::from_fn(1, 1, |_, _| 1.0),
        vec![0.0],
    );
    let system = HybridSystem::new(1.0)
        .with_state("v", Interval::new(-50.0, 50.0))
        .with_input("u", Interval::new(-1.0, 1.0))
        .with_transition(Transition::new("step", flow.unwrap()));
    let goal = points(&[3.0]);
    let mut sets = ReachSets::new(&system, points(&[0.0]), &goal, SetOptions::default()).unwrap();
    assert!(!sets.may_finish(20_000).unwrap());
    assert!(sets.settled().is_some_and(|steps| steps < 100));
    let text = sets.explain(20_000).unwrap().unwrap().to_string();
    let reason = "at the end, v is at most 2, and 3 is needed";
    assert!(text.starts_with(&format!("no plan has 20000 steps (20000 s): {reason}")), "{text}");
}
