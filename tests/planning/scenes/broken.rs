//! Plans that are not what their scene allows are refused by its replay.

use carom::ErrorKind;
use carom::hybrid::scene::{
    Body, DamageMeasure, DamageRule, Scene, SceneError, ScenePlan, Solid, Surface,
};
use carom::hybrid::{ImpactEstimate, Region, Restitution};
use carom::interval::Interval;
use carom::prelude::*;
use carom_hybrid::internals::Halfspace;

/// A limit, and a rule with it.
type Case = (f64, Box<dyn Fn(f64) -> DamageRule>);

/// Thrown along a floor and against a wall, with a mass of 2 kg and e = 0.5: two hits.
fn scene() -> Scene {
    let room = [Interval::new(0.0, 4.0), Interval::new(0.0, 1.0)];
    let body = Body::new("p", room, 4.0, 0.0)
        .with_mass(2.0)
        .with_start(Region::point([0.5, 0.45, -1.8, -1.5]));
    Scene::new(0.1).with_body(body).with_room("side", room, bounce())
}

fn bounce() -> Surface {
    Surface::bounce(Restitution::new(0.5).unwrap())
}

fn plan(scene: &Scene) -> ScenePlan {
    let program = scene.program(6).unwrap();
    let solution = BranchAndBound::default().solve(program.model()).unwrap();
    program.plan(&solution).unwrap()
}

/// What the replay says against a plan.
fn refused(scene: &Scene, plan: &ScenePlan) -> String {
    let error = scene.replay(plan).unwrap_err();
    match error.kind() {
        ErrorKind::Scene(SceneError::Replay { what, .. }) => what.clone(),
        _ => panic!("{error}"),
    }
}

#[test]
fn a_plan_that_keeps_everything_is_replayed_as_it_was() {
    let (scene, plan) = (scene(), plan(&scene()));
    assert_eq!(plan.hits.len(), 2);
    assert_eq!(scene.replay(&plan).unwrap(), plan);
}

#[test]
fn every_kind_of_rule_is_checked_without_its_rows() {
    let scene = scene();
    let plan = plan(&scene);
    let p = scene.body_named("p").unwrap();
    let [left, right, below] =
        ["side 0", "side 1", "side 2"].map(|name| scene.obstacle_named(name).unwrap());
    let (x, y) = (1.8, 1.5);
    fn rule(measure: DamageMeasure) -> DamageRule {
        DamageRule::new("rule", measure)
    }
    fn speed() -> DamageRule {
        rule(DamageMeasure::ImpactSpeed)
    }
    let energy = |v: f64| 0.75 * v * v;
    let convex = || rule(DamageMeasure::Convex(vec![(1.0, 0.0), (3.0, -3.6)]));
    // Each at its limit, and a little below it.
    let cases: Vec<Case> = vec![
        (x, Box::new(move |most| speed().with_per_hit(most))),
        (y, Box::new(move |most| speed().with_face(below, 0).with_per_hit(most))),
        (x, Box::new(move |most| speed().with_obstacle(left).with_per_hit(most))),
        (3.0 * x, Box::new(move |m| rule(DamageMeasure::NormalImpulse).with_per_hit(m))),
        (energy(x), Box::new(move |m| rule(DamageMeasure::DissipatedEnergy).with_per_hit(m))),
        (1.8, Box::new(move |most| convex().with_per_hit(most))),
        (x + y, Box::new(move |most| speed().with_total(most))),
        (x + y, Box::new(move |most| speed().with_body(p).with_total(most).with_window(3))),
        (
            energy(x) + energy(y),
            Box::new(move |most| rule(DamageMeasure::DissipatedEnergy).with_total(most)),
        ),
        ((y / x).atan(), Box::new(move |most| speed().with_obstacle(left).with_incidence(most))),
    ];
    for (k, (limit, rule)) in cases.into_iter().enumerate() {
        assert!(scene.clone().with_rule(rule(limit + 1e-9)).replay(&plan).is_ok(), "{k}");
        let found = refused(&scene.clone().with_rule(rule(0.99 * limit)), &plan);
        assert!(found.contains("`rule`"), "{k}: {found}");
    }
    let count = |most| speed().with_count(most);
    assert!(scene.clone().with_rule(count(2)).replay(&plan).is_ok());
    assert!(refused(&scene.clone().with_rule(count(1)), &plan).contains("more hits"));
    // The hits are not in one step, so that this heals in time.
    let steps: Vec<usize> = plan.hits.iter().map(|hit| hit.step).collect();
    assert!(
        scene.clone().with_rule(count(1).with_window(steps[1] - steps[0])).replay(&plan).is_ok()
    );
    let window = steps[1] - steps[0] + 1;
    assert!(scene.clone().with_rule(count(1).with_window(window)).replay(&plan).is_err());
    // Rules of others, and prices, refuse nothing.
    let other = speed().with_obstacle(right).with_per_hit(0.0).with_price(2.0);
    assert!(scene.clone().with_rule(other).replay(&plan).is_ok());
}

#[test]
fn on_a_line_every_approach_is_along_the_normal() {
    // On its way up when the step begins, and pulled into the wall before it ends.
    let body = Body::new("p", [Interval::new(0.0, 1.0)], 4.0, 0.0)
        .with_gravity([-9.0])
        .with_start(Region::point([0.01, 0.1]));
    let rule = DamageRule::new("rule", DamageMeasure::ImpactSpeed).with_incidence(0.3);
    let scene = Scene::new(0.1)
        .with_body(body)
        .with_obstacle(Solid::halfspace("wall", [1.0], 0.0, bounce()))
        .with_rule(rule);
    let program = scene.program(1).unwrap();
    let solution = BranchAndBound::default().solve(program.model()).unwrap();
    assert_eq!(program.plan(&solution).unwrap().hits.len(), 1);
}

#[test]
fn plans_that_are_changed_afterwards() {
    let (scene, plan) = (scene(), plan(&scene()));
    let changed = |change: &dyn Fn(&mut ScenePlan)| {
        let mut other = plan.clone();
        change(&mut other);
        refused(&scene, &other)
    };
    assert!(changed(&|p| p.bodies[0].velocity[3][0] += 1e-3).contains("differs"));
    assert!(changed(&|p| p.bodies[0].acceleration[3][1] = 0.5).contains("pushes"));
    assert!(changed(&|p| p.bodies[0].position[0][0] += 1e-3).contains("misses its start"));
    assert!(changed(&|p| p.bodies[0].position[2][1] = f64::NAN).contains("leaves its domain"));
    assert!(changed(&|p| p.bodies[0].velocity[2][1] = 9.0).contains("too fast"));
    assert!(changed(&|p| drop(p.hits.remove(0))).contains("enters without a hit"));
    assert!(changed(&|p| p.hits[0].contact = "p at nothing".into()).contains("no surface"));
    assert!(changed(&|p| p.hits[0].face = 7).contains("no surface"));
    assert!(changed(&|p| p.hits[0].step = 99).contains("after the last step"));
    assert!(changed(&|p| p.hits.push(p.hits[0].clone())).contains("two faces"));
    let length = |change: &dyn Fn(&mut ScenePlan)| {
        let mut other = plan.clone();
        change(&mut other);
        scene.replay(&other).unwrap_err()
    };
    assert!(matches!(
        length(&|p| drop(p.bodies[0].position.pop())).kind(),
        ErrorKind::Length { .. }
    ));
    assert!(matches!(length(&|p| p.bodies.clear()).kind(), ErrorKind::Length { .. }));
    let renamed = length(&|p| p.bodies[0].name = "q".into());
    assert!(matches!(renamed.kind(), ErrorKind::UnknownName { name, .. } if name == "q"));
}

#[test]
fn goals_with_half_spaces() {
    let (mut scene, plan) = (scene(), plan(&scene()));
    let last: Vec<f64> =
        [&plan.bodies[0].position[6][..], &plan.bodies[0].velocity[6][..]].concat();
    let ranges = last.iter().map(|x| Interval::new(x - 1.0, x + 1.0)).collect::<Vec<_>>();
    let goal = |limit: f64| {
        let side = Halfspace::new("side", [1.0, 1.0, 0.0, 0.0], limit);
        Some(Region::from(ranges.clone()).with_halfspace(side))
    };
    scene.bodies[0].goal = goal(last[0] + last[1]);
    assert!(scene.replay(&plan).is_ok());
    scene.bodies[0].goal = goal(last[0] + last[1] - 0.01);
    assert!(refused(&scene, &plan).contains("misses its goal"));
    // One that fits no body is an error, not a panic.
    let narrow = Halfspace::new("side", [1.0, 1.0], 0.0);
    scene.bodies[0].goal = Some(Region::from(ranges.clone()).with_halfspace(narrow));
    let error = scene.program(6).unwrap_err();
    let ErrorKind::Scene(own) = error.kind() else { panic!("{error}") };
    assert!(matches!(own, SceneError::Axes { found: 2, expected: 4, .. }), "{error}");
}

#[test]
fn hits_of_two_things_in_a_step_need_corners() {
    // Into the corner of the room: both walls in the first step.
    let mut scene = scene().with_corners(true).with_estimate(ImpactEstimate::EndOfStep);
    scene.bodies[0].start = Some(Region::point([0.1, 0.1, -1.8, -1.5]));
    let plan = plan(&scene);
    assert!(plan.hits.len() == 2 && plan.hits[0].step == plan.hits[1].step);
    assert!(scene.replay(&plan).is_ok());
    assert!(refused(&scene.with_corners(false), &plan).contains("more than one thing"));
}
