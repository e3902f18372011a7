//! Random scenarios: the crate agrees with brute force, brute force agrees with roll-outs, and the
//! scenarios are of the kinds that matter.

use proptest::prelude::*;
use proptest::sample::select;
use proptest::strategy::ValueTree;
use proptest::test_runner::{Config, RngSeed, TestRunner};

use super::brute_force::{HorizonVerdict, Horizons, ShortestHorizon, shortest};
use super::scenes::{RollOut, Scene, place, scene};
use super::{REGRESSIONS, answer_with, any_answer, compare, options};
use crate::common::config;

/// The largest horizon of most tests.
const MAX_STEPS: usize = 10;

/// The largest gap at the start of most tests, see [`scene`].
const REACH: i32 = 6;

proptest! {
    #![proptest_config(config(300, REGRESSIONS))]

    #[test]
    fn the_crate_agrees_with_brute_force(scene in scene(REACH), (at, side) in place()) {
        compare(&scene.beside(at, side), MAX_STEPS)?;
    }

    /// Brute force itself: where accelerations lead can be reached, with no more impacts.
    #[test]
    fn brute_force_finds_what_was_rolled_out(
        scene in scene(REACH),
        shares in prop::collection::vec(select(vec![0.0, 0.3, 0.5, 1.0]), 1..7),
    ) {
        let (lower, upper) = scene.limits;
        let mut pulls: Vec<f64> = shares.iter().map(|s| lower + s * (upper - lower)).collect();
        if let Some(pull) = scene.start.pull {
            pulls[0] = pull;
        }
        let out = RollOut::new(&scene, pulls);
        prop_assume!(!out.states.is_empty());
        let mut scene = Scene { domain: None, max_speed: 64.0, collisions: true, ..scene };
        scene.goal.gap = out.states[out.states.len() - 1].0;
        scene.goal.rate = out.states[out.states.len() - 1].1;
        scene.per_impact = Some(out.impacts.iter().copied().fold(0.0, f64::max));
        scene.cumulative = Some(out.impacts.iter().sum());
        let scenario = scene.plain();
        match Horizons::new(&scenario).nth(out.states.len() - 1) {
            Some(HorizonVerdict::Feasible { impacts }) => prop_assert!(impacts <= out.impacts.len()),
            // With fewer impacts it almost works.
            Some(HorizonVerdict::TooClose) => prop_assume!(false),
            verdict => prop_assert!(false, "{verdict:?}"),
        }
    }
}

proptest! {
    #![proptest_config(config(60, REGRESSIONS))]

    #[test]
    fn over_longer_horizons_too(scene in scene(12), (at, side) in place()) {
        compare(&scene.beside(at, side), 12)?;
    }
}

proptest! {
    #![proptest_config(config(100, REGRESSIONS))]

    #[test]
    fn hints_and_minimal_impacts_do_not_change_the_horizon(
        scene in scene(REACH),
        hint in 1..=MAX_STEPS + 2,
        fewest_impacts in any::<bool>(),
    ) {
        let scenario = scene.plain();
        let expected = shortest(&scenario, MAX_STEPS);
        prop_assume!(expected != ShortestHorizon::TooClose);
        let options = options(MAX_STEPS).with_upper_hint(hint);
        let found = match fewest_impacts {
            true => answer_with(&scenario, &options),
            false => any_answer(&scenario, &options),
        };
        let found = found.map_err(TestCaseError::fail)?;
        match (found, expected) {
            (ShortestHorizon::Found { steps, impacts }, ShortestHorizon::Found { steps: least, impacts: few })
                if !fewest_impacts =>
            {
                prop_assert_eq!(steps, least);
                prop_assert!(impacts >= few);
            }
            _ => prop_assert_eq!(found, expected),
        }
    }
}

/// The first random scenes of a seed.
fn sample(count: usize) -> Vec<(Scene, ShortestHorizon)> {
    let config = Config { rng_seed: RngSeed::Fixed(1), failure_persistence: None, ..config(1, "") };
    let mut runner = TestRunner::new(config);
    let mut draw = || scene(REACH).new_tree(&mut runner).expect("a scene").current();
    let scenes = (0..count).map(|_| draw());
    scenes.map(|scene| (scene, shortest(&scene.plain(), MAX_STEPS))).collect()
}

/// How a scene, or an answer, of some kind is recognised.
type Is<T> = fn(T) -> bool;

/// A scene with one limit less.
type Without = fn(Scene) -> Scene;

#[test]
fn the_scenarios_are_of_all_kinds() {
    let scenes = sample(250);
    let count = |kind: &dyn Fn(&Scene, ShortestHorizon) -> bool| {
        scenes.iter().filter(|(scene, answer)| kind(scene, *answer)).count()
    };
    // By the answer: how many at least, how many at most.
    let answers: [(&str, usize, usize, Is<ShortestHorizon>); 5] = [
        ("hits", 84, 250, |answer| matches!(answer, ShortestHorizon::Found { impacts: 1.., .. })),
        ("bounces", 5, 250, |answer| matches!(answer, ShortestHorizon::Found { impacts: 2.., .. })),
        ("3 to 10 steps", 125, 250, |answer| {
            matches!(answer, ShortestHorizon::Found { steps: 3.., .. })
        }),
        ("no plan", 25, 87, |answer| matches!(answer, ShortestHorizon::NoneWithin { .. })),
        ("passed over", 0, 2, |answer| answer == ShortestHorizon::TooClose),
    ];
    for (name, least, most, kind) in answers {
        let found = count(&|_, answer| kind(answer));
        assert!((least..=most).contains(&found), "{name}: {found}");
    }

    // By the scenario.
    let kinds: [(&str, usize, Is<Scene>); 9] = [
        ("plastic", 40, |scene| scene.restitution == 0.0),
        ("elastic", 40, |scene| scene.restitution == 1.0),
        ("pinned first acceleration", 50, |scene| scene.start.pull.is_some()),
        ("zero is no acceleration", 40, |s| s.limits.0 > 0.0 || s.limits.1 < 0.0),
        ("waiting is not free", 50, |scene| !scene.plain().monotonicity().is_monotone()),
        ("waiting is free", 50, |scene| scene.plain().monotonicity().is_monotone()),
        ("goal in motion", 75, |scene| scene.goal.rate != 0.0),
        ("starts at the wall", 20, |scene| scene.start.gap == 0.0),
        ("collisions forbidden", 5, |scene| !scene.collisions),
    ];
    for (name, least, kind) in kinds {
        let found = count(&|scene, _| kind(*scene));
        assert!(found >= least, "{name}: {found}");
    }

    // By what decides: without the limit the answer is another one.
    let limits: [(&str, usize, Without); 4] = [
        ("speed", 5, |scene| Scene { max_speed: 64.0, ..scene }),
        ("per impact", 5, |scene| Scene { per_impact: None, ..scene }),
        ("cumulative", 3, |scene| Scene { cumulative: None, ..scene }),
        ("domain", 3, |scene| Scene { domain: None, ..scene }),
    ];
    for (name, least, without) in limits {
        let found = count(&|scene, answer| {
            let other = without(*scene);
            other != *scene && shortest(&other.plain(), MAX_STEPS) != answer
        });
        assert!(found >= least, "{name}: {found}");
    }
}

#[test]
fn feasibility_is_not_monotone_in_many_scenarios() {
    // A feasible horizon with an infeasible one after it: only refuting one by one is sound.
    let broken = |scene: &Scene| {
        let scenario = scene.plain();
        let mut later =
            Horizons::new(&scenario).take(8).skip_while(|v| *v == HorizonVerdict::Infeasible);
        later.any(|verdict| verdict == HorizonVerdict::Infeasible)
    };
    let scenes = sample(100);
    let of = |free: bool| {
        let some =
            scenes.iter().filter(|(scene, _)| scene.plain().monotonicity().is_monotone() == free);
        some.filter(|(scene, _)| broken(scene)).count()
    };
    assert!(of(false) >= 5, "{}", of(false));
    assert_eq!(of(true), 0);
}
