//! Windows, rows and reformulations of searches for the shortest horizon.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::common::config;
use carom::collision_tolerant::Scenario;
use carom::hybrid::scene::{Body, Scene, Solid, Surface};
use carom::hybrid::{
    HorizonModel, HybridSystem, Monotonicity, Region, ShortestOptions, State, When,
    shortest_horizon,
};
use carom::interval::Interval;
use carom::model::{Method, Reformulation};
use carom::prelude::*;
use proptest::prelude::*;

/// A cart that moves by at most 1 a step.
fn cart() -> (HybridSystem, State, Input) {
    let mut cart = HybridSystem::new(1.0);
    let x = cart.state("x", -9.0, 9.0).unwrap();
    let v = cart.input("v", -1.0, 1.0).unwrap();
    cart.mode("roll").unwrap().next([(x, x + v)]).unwrap();
    (cart, x, v)
}

/// Whether a cart reaches the goal in so many steps through a region at the samples of a window.
fn reaches(goal: f64, region: Interval, when: &When, steps: usize) -> bool {
    let (first, last) = match when {
        When::At(sample) => (*sample, *sample),
        When::Throughout(window) | When::OnceIn(window) => (*window.start(), *window.end()),
        _ => unreachable!(),
    };
    if first > steps {
        return false;
    }
    let at = |sample: usize, once: Option<usize>| match once {
        Some(chosen) => sample == chosen,
        None => (first..=last).contains(&sample),
    };
    let arrives = |once: Option<usize>| {
        let (mut lower, mut upper) = (0.0_f64, 0.0_f64);
        for sample in 0..=steps {
            if sample > 0 {
                (lower, upper) = ((lower - 1.0).max(-9.0), (upper + 1.0).min(9.0));
            }
            if at(sample, once) {
                (lower, upper) = (lower.max(region.lower), upper.min(region.upper));
            }
            if lower > upper {
                return false;
            }
        }
        lower <= goal && goal <= upper
    };
    match when {
        When::OnceIn(_) => (first..=last.min(steps)).any(|sample| arrives(Some(sample))),
        _ => arrives(None),
    }
}

proptest! {
    #![proptest_config(config(60, "tests/regressions/horizon_statements.txt"))]

    /// The shortest run through a window is that of intervals pushed forward.
    #[test]
    fn windows_mean_what_they_say(
        goal in -4_i32..=4,
        lower in -6_i32..=5,
        width in 0_i32..3,
        first in 0_usize..7,
        length in 0_usize..4,
        kind in 0..3,
        sets in any::<bool>(),
        hull in any::<bool>(),
    ) {
        let region = Interval::new(f64::from(lower) / 2.0, f64::from(lower + width) / 2.0);
        let when = match kind {
            0 => When::At(first),
            1 => When::Throughout(first..=first + length),
            _ => When::OnceIn(first..=first + length),
        };
        let goal = f64::from(goal);
        let (cart, x, v) = cart();
        let method = if hull { Method::Hull } else { Method::BigM };
        let options = ShortestOptions::default()
            .with_max_steps(16)
            .with_reach_sets(sets)
            .with_reformulation(Reformulation::default().with_method(method))
            .with_window("window", [x.within(region.lower, region.upper)], when.clone());
        let (start, end) = ([x.equals(0.0)], [x.equals(goal)]);
        let mut solver = BranchAndBound::default();
        let found = cart.shortest_with(start, end, &options, &mut solver).unwrap();
        let wanted = (1..=16).find(|&steps| reaches(goal, region, &when, steps));
        prop_assert_eq!(found.steps, wanted, "{:?} in {:?} to {}", when, region, goal);
        prop_assert_eq!(found.plan.is_some(), wanted.is_some());
        if let (Some(steps), Some(plan)) = (wanted, &found.plan) {
            prop_assert!(!found.monotonicity.is_monotone());
            prop_assert_eq!(found.refuted_steps.unwrap_or(0), steps - 1);
            prop_assert_eq!(plan.values(x).unwrap().len(), steps + 1);
            prop_assert_eq!(plan.values(v).unwrap().len(), steps);
        }
    }
}

/// Rows without a window: a row over all steps, counted by hand.
#[test]
fn rows_are_in_every_program() {
    let called = Arc::new(AtomicUsize::new(0));
    let counter = Arc::clone(&called);
    let (cart, x, v) = cart();
    let hull = Reformulation::default().with_method(Method::Hull);
    let options = ShortestOptions::default().with_reformulation(hull).with_rows(move |program| {
        counter.fetch_add(1, Ordering::Relaxed);
        let steps = program.steps();
        assert_eq!(program.model().reformulation().method(), Method::Hull);
        // Half of the steps at rest.
        let moves = program.model_mut().binary_family("moves", steps)?;
        for t in 0..steps {
            program.add(("rest", t), moves[t].off().implies(program.at(v.equals(0.0), t)?))?;
        }
        let count = moves.iter().map(|z| 1.0 * z).sum::<Affine>();
        program.add("tired", count.le(steps as f64 / 2.0))?;
        Ok(())
    });
    let mut solver = BranchAndBound::default();
    let found =
        cart.shortest_with([x.equals(0.0)], [x.equals(3.0)], &options, &mut solver).unwrap();
    assert_eq!(found.steps, Some(6));
    assert!(found.is_found());
    assert!(!found.monotonicity.is_monotone());
    // The sets have refuted the first two without a program.
    assert_eq!(called.load(Ordering::Relaxed), 4);
}

#[test]
fn bad_windows_and_failing_rows_end_the_search() {
    let (cart, x, _) = cart();
    let run = |options: ShortestOptions| {
        let mut solver = BranchAndBound::default();
        let (start, goal) = ([x.equals(0.0)], [x.equals(3.0)]);
        cart.shortest_with(start, goal, &options, &mut solver).unwrap_err().to_string()
    };
    let plain = ShortestOptions::default;
    let twice = [Interval::new(0.0, 1.0), Interval::new(0.0, 1.0)];
    for sample in [0, 99] {
        let text = run(plain().with_window("wide", twice, When::At(sample)));
        assert_eq!(text, "the length of the region is 2; it must be 1");
    }
    #[expect(clippy::reversed_empty_ranges, reason = "it is refused")]
    let empty = When::OnceIn(3..=2);
    assert_eq!(
        run(plain().with_window("never", [Interval::new(0.0, 1.0)], empty)),
        "the last sample of `never` is 2; it must be at least 3, the first sample"
    );
    let text = run(plain().with_rows(|program| program.system().input_named("w").map(|_| ())));
    assert!(text.contains("`w`"), "{text}");
    // Handles of another system, before and behind the end of the run.
    let (_, stranger, _) = self::cart();
    for sample in [0, 99] {
        let text = run(plain().with_window("mine", [stranger.ge(0.0)], When::At(sample)));
        assert!(text.contains("belongs to another model"), "{text}");
    }
    let other = Model::new("other").continuous("x", 0.0, 1.0).unwrap();
    let text =
        run(plain().with_rows(move |program| program.add("mine", other.le(0.5)).map(|_| ())));
    assert!(text.contains("`mine` belongs to another model or system"), "{text}");
}

/// A search over programs that have no hybrid system.
struct Bare;

impl HorizonModel for Bare {
    type Program = Model;

    fn build(&self, steps: usize) -> Result<Model, Error> {
        let mut model = Model::new("bare");
        let n = model.integer("n", 0.0, steps as f64)?;
        model.add("enough", n.ge(2.5))?;
        model.add("side", either(n.le(0.5)).or(n.ge(1.5)))?;
        Ok(model)
    }

    fn monotonicity(&self) -> Monotonicity {
        Monotonicity::Monotone("more is more".into())
    }
}

#[test]
fn programs_without_a_system_take_a_reformulation_only() {
    let hull = Reformulation::default().with_method(Method::Hull);
    let options = ShortestOptions::default().with_reformulation(hull);
    let found = shortest_horizon(&Bare, &options, &mut BranchAndBound::default()).unwrap();
    assert_eq!(found.steps, Some(3));
    assert_eq!(found.plan.unwrap().program.reformulation().method(), Method::Hull);
    let options = options.with_rows(|_| Ok(()));
    let error = shortest_horizon(&Bare, &options, &mut BranchAndBound::default()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "a search over programs without a hybrid system does not take windows and rows; add them \
         in `HorizonModel::build`, or implement `HorizonModel::with_hybrid`"
    );
}

/// A puck that must be beside the wall, which it avoids, at some time.
#[test]
fn scenes_take_windows_and_rows() {
    let puck = Body::new("puck", [Interval::new(0.0, 4.0), Interval::new(0.0, 2.0)], 2.0, 2.0)
        .with_start(Region::point([0.5, 0.5, 0.0, 0.0]))
        .with_goal(Region::point([3.5, 0.5, 0.0, 0.0]));
    let wall = [Interval::new(1.5, 2.5), Interval::new(0.0, 1.0)];
    let scene = Scene::new(0.25).with_body(puck).with_obstacle(Solid::cuboid(
        "wall",
        wall,
        Surface::avoid(),
    ));
    let mut solver = BranchAndBound::default();
    let plain = scene.shortest(&mut solver).unwrap();
    let steps = plain.steps.unwrap();
    let far = [
        Interval::new(0.0, 4.0),
        Interval::new(1.8, 2.0),
        Interval::new(-2.0, 2.0),
        Interval::new(-2.0, 2.0),
    ];
    let options = ShortestOptions::default().with_max_steps(3 * steps).with_window(
        "far",
        far,
        When::OnceIn(2..=3 * steps),
    );
    let window = scene.shortest_with(&options, &mut solver).unwrap();
    assert!(window.is_found());
    assert!(window.steps.unwrap() >= steps);
    let heights = window.plan.unwrap().bodies[0].position.iter().map(|p| p[1]).fold(0.0, f64::max);
    assert!(heights >= 1.8 - 1e-6);
    let slow = ShortestOptions::default().with_max_steps(3 * steps).with_rows(|program| {
        let v = program.system().state_named("puck vx")?;
        program.require("slow", [v.le(1.0)], When::Throughout(0..=program.steps()))
    });
    let slow = scene.shortest_with(&slow, &mut solver).unwrap();
    assert!(slow.is_found() && slow.steps.unwrap() > steps);
}

/// Rows of one's own also hold where the impacts are minimised afterwards.
#[test]
fn the_planner_of_the_paper_takes_rows() {
    let scenario = Scenario::paper().with_time_step(0.05);
    let mut solver = BranchAndBound::default();
    let plain = scenario.shortest(&mut solver).unwrap();
    let fastest = |velocity: &[f64]| velocity.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let limit = 0.8 * fastest(&plain.plan.as_ref().unwrap().trajectory.velocity);
    let options = ShortestOptions::default().with_max_steps(400).with_rows(move |program| {
        let v = program.system().state_named("vehicle vx")?;
        let calm = [v.within(-limit, limit)];
        program.require("calm", calm, When::Throughout(0..=program.steps()))
    });
    let calm = scenario.shortest_with(&options, &mut solver).unwrap();
    assert!(calm.is_found() && calm.steps > plain.steps, "{:?} {:?}", calm.steps, plain.steps);
    assert!(fastest(&calm.plan.unwrap().trajectory.velocity) <= limit + 1e-5);
}
