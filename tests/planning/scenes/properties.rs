//! Laws that hold in every scene.

use carom::hybrid::scene::{Body, DamageMeasure, DamageRule, Scene, Solid, Surface};
use carom::hybrid::{ImpactEstimate, Region, Restitution};
use carom::interval::Interval;
use carom::model::Affine;
use carom::prelude::*;
use proptest::prelude::*;

use super::seeded_numbers::Numbers;
use crate::common::config;

const TIME_STEP: f64 = 0.05;

/// When and how fast a step of constant acceleration enters a wall at 0, from a gap above it.
fn first_impact(gap: f64, speed: f64, push: f64) -> Option<f64> {
    let roots = {
        let root = (speed * speed - 2.0 * push * gap).sqrt();
        // Stable for both signs.
        let q = -(speed + speed.signum() * root);
        [2.0 * gap / q, q / push]
    };
    let inside = |t: &f64| *t > 0.0 && *t < TIME_STEP;
    let first = roots.into_iter().filter(inside).fold(f64::INFINITY, f64::min);
    let rate = speed + push * first;
    (first.is_finite() && rate < -1e-9).then_some(-rate)
}

#[test]
fn no_impact_is_faster_than_its_damage_and_none_is_missed() {
    let wall = Surface::bounce(Restitution::new(0.4).unwrap());
    let system = |estimate| {
        let body = Body::new("p", [Interval::new(0.0, 1.0)], 4.0, 6.0);
        let wall = Solid::halfspace("wall", [1.0], 0.0, wall);
        let scene = Scene::new(TIME_STEP).with_body(body).with_obstacle(wall);
        scene.with_estimate(estimate).hybrid_system().unwrap()
    };
    let (sound, paper) = (system(ImpactEstimate::Sound), system(ImpactEstimate::EndOfStep));
    let mut numbers = Numbers(7);
    let (mut hits, mut under_reported, mut dips) = (0, 0, 0);
    while hits < 58_000 {
        let state = [numbers.within(0.0, 0.15), numbers.within(-3.0, 1.0)];
        let push = numbers.within(-6.0, 6.0);
        let impact = first_impact(state[0], state[1], push);
        let run = paper.simulate(&state, &[[push]]).unwrap();
        if !run.is_complete() {
            continue;
        }
        let is_hit = run.events() == 1;
        if !is_hit && impact.is_some() {
            // A step that dips is none of a sound scene.
            dips += 1;
            let run = sound.simulate(&state, &[[push]]).unwrap();
            assert!(!run.is_complete(), "{state:?}, {push}");
        }
        if is_hit {
            hits += 1;
            let (start, end) = (-state[1], -(state[1] + TIME_STEP * push));
            if let Some(speed) = impact {
                assert!(speed <= start.max(end) + 1e-9, "{state:?}, {push}");
                under_reported += usize::from(speed > end + 1e-9);
            }
        }
    }
    // About half of the impacts are faster than at the end of their step, and some steps dip.
    assert!(under_reported > hits / 3 && dips > 0, "{under_reported} of {hits}, {dips} dips");
}

/// A scene in a room, and an objective.
#[derive(Debug, Clone)]
struct Case {
    axes: usize,
    restitution: f64,
    friction: u8,
    is_sound: bool,
    start: Vec<f64>,
    wish: Vec<f64>,
}

fn case() -> impl Strategy<Value = Case> {
    let numbers = |count| prop::collection::vec(-1.0..1.0_f64, count);
    (1..=3_usize, 0.0..1.0_f64, 0..3_u8, any::<bool>(), numbers(6), numbers(6)).prop_map(
        |(axes, restitution, friction, is_sound, start, wish)| Case {
            axes,
            restitution,
            friction,
            is_sound,
            start,
            wish,
        },
    )
}

fn build(case: &Case) -> Scene {
    let axes = case.axes;
    let room = vec![Interval::new(0.0, 0.5); axes];
    let surface = Surface::bounce(Restitution::new(case.restitution).unwrap());
    let surface = match (case.friction, axes) {
        (0, _) | (_, 1) => surface,
        (1, 3) => surface.with_friction_along(0.3, 4),
        (1, _) => surface.with_friction(0.3),
        _ => surface.with_linear_map(0.6, 0.0),
    };
    let position = case.start[..axes].iter().map(|s| 0.25 + 0.2 * s);
    let velocity = case.start[3..3 + axes].iter().map(|s| 2.0 * s);
    let start: Vec<f64> = position.chain(velocity).collect();
    let body = Body::new("p", room.clone(), 4.0, 3.0).with_start(Region::point(start));
    let estimate = if case.is_sound { ImpactEstimate::Sound } else { ImpactEstimate::EndOfStep };
    // In space, one wall with friction is enough.
    let scene = Scene::new(0.1).with_body(body).with_estimate(estimate);
    match case.friction == 1 && axes == 3 {
        true => scene.with_obstacle(Solid::halfspace("wall", [0.0, 0.6, 0.8], 0.1, surface)),
        false => scene.with_room("wall", &room, surface),
    }
}

proptest! {
    #![proptest_config(config(24, "tests/regressions/scenes.txt"))]

    #[test]
    fn plans_are_what_their_scenes_do(case in case()) {
        let scene = build(&case);
        // A start behind the slanted wall is refused.
        let Ok(mut program) = scene.program(4) else { return Ok(()) };
        let states = program.program().variables().states().to_vec();
        let wish: Affine = states.iter().zip(&case.wish).map(|(s, w)| *w * s[4]).sum();
        program.minimize(wish).unwrap();
        let solution = BranchAndBound::default().solve(program.model()).unwrap();
        if solution.point().is_some() {
            let plan = program.plan(&solution).unwrap();
            let certificate = &plan.certificate;
            prop_assert!(certificate.largest_residual <= 1e-6);
            prop_assert!(certificate.energy_gain <= 1e-5 && certificate.cone_excess <= 1e-5);
            if case.is_sound {
                prop_assert!(certificate.missed == 0 && certificate.unreported <= 3e-6);
            }
        }
    }
}

#[test]
fn errors_within_a_step_shrink_with_its_length() {
    // Thrown at the floor, far from edges and not grazing.
    let floor = Surface::bounce(Restitution::new(0.7).unwrap());
    let error = |time_step: f64| {
        let sides = [Interval::new(0.0, 4.0), Interval::new(0.0, 2.0)];
        let ball = Body::new("ball", sides, 8.0, 0.0)
            .with_gravity([0.0, -9.81])
            .with_start(Region::point([0.2, 1.0, 1.0, -2.0]));
        let floor = Solid::halfspace("floor", [0.0, 1.0], 0.0, floor);
        let scene = Scene::new(time_step).with_body(ball).with_obstacle(floor);
        let program = scene.program((0.4 / time_step).round() as usize).unwrap();
        let solution = BranchAndBound::default().solve(program.model()).unwrap();
        let plan = program.plan(&solution).unwrap();
        assert_eq!(plan.hits.len(), 1);
        plan.certificate.step_error / (9.81 * time_step * time_step)
    };
    // Of the order of g Δt².
    for time_step in [0.1, 0.05, 0.025, 0.0125] {
        assert!(error(time_step) < 2.0);
    }
}

#[test]
fn rules_limit_hits_sums_and_numbers() {
    let cushion = Surface::bounce(Restitution::new(0.8).unwrap());
    let lane = [Interval::new(0.0, 1.0)];
    let body = Body::new("p", lane, 4.0, 4.0).with_mass(2.0).with_start(Region::point([0.5, -1.5]));
    let scene = Scene::new(0.1).with_body(body).with_room("end", lane, cushion);
    // Towards the largest sum of impact speeds that the rules allow, in 12 steps.
    let most = |rules: Vec<DamageRule>| {
        let scene = rules.into_iter().fold(scene.clone(), Scene::with_rule);
        let mut program = scene.program(12).unwrap();
        let outputs = program.program().variables().output("impact speed").unwrap().to_vec();
        program.maximize(outputs.into_iter().sum::<Affine>()).unwrap();
        let solution = BranchAndBound::default().solve(program.model()).unwrap();
        solution.point().map(|_| program.plan(&solution).unwrap())
    };
    let speed = |rule: DamageRule| rule.with_per_hit(1.0);
    let free = most(Vec::new()).unwrap();
    assert!(free.hits.len() > 1 && free.hits.iter().any(|hit| hit.damage > 1.2));
    let limited = most(vec![speed(DamageRule::new("r", DamageMeasure::ImpactSpeed))]).unwrap();
    assert!(limited.hits.iter().all(|hit| hit.damage <= 1.0 + 1e-5));
    // (1 - e²) m f²/2 <= 0.2 J, and (1 + e) m f <= 3 N s.
    let energy = DamageRule::new("r", DamageMeasure::DissipatedEnergy).with_per_hit(0.2);
    let allowed = (0.2_f64 / 0.36).sqrt();
    assert!(most(vec![energy]).unwrap().hits.iter().all(|hit| hit.damage <= allowed + 1e-5));
    let impulse = DamageRule::new("r", DamageMeasure::NormalImpulse).with_per_hit(3.0);
    let impulse = most(vec![impulse]).unwrap();
    assert!(impulse.hits.iter().all(|hit| hit.impulse[0].abs() <= 3.0 + 1e-5));
    let once = most(vec![DamageRule::new("r", DamageMeasure::ImpactSpeed).with_count(1)]).unwrap();
    assert_eq!(once.hits.len(), 1);
    let total = most(vec![DamageRule::new("r", DamageMeasure::ImpactSpeed).with_total(1.5)]);
    assert!(total.unwrap().hits.iter().map(|hit| hit.damage).sum::<f64>() <= 1.5 + 1e-4);
    // Chords never count less energy than there is.
    let budget = DamageRule::new("r", DamageMeasure::DissipatedEnergy).with_total(0.5);
    let spent: f64 = most(vec![budget]).unwrap().hits.iter().map(|h| 0.36 * h.damage.powi(2)).sum();
    assert!(spent <= 0.5 + 1e-5);
    // The brakes are good enough for no hit at all.
    let none = DamageRule::new("r", DamageMeasure::ImpactSpeed).with_count(0);
    assert_eq!(most(vec![none]).map_or(0, |plan| plan.hits.len()), 0);
}
