//! Rules about damage: windows, incidence, measures; objectives in turn.

use carom::hybrid::scene::{
    Body, DamageMeasure, DamageRule, Scene, ScenePlan, SceneProgram, Solid, Surface,
};
use carom::hybrid::{ImpactEstimate, Region, Restitution};
use carom::interval::Interval;
use carom::model::Affine;
use carom::prelude::*;

fn bounce(e: f64) -> Surface {
    Surface::bounce(Restitution::new(e).unwrap())
}

fn solved(program: &SceneProgram) -> Option<ScenePlan> {
    let solution = BranchAndBound::default().solve(program.model()).unwrap();
    solution.point().map(|_| program.plan(&solution).unwrap())
}

/// Between two walls, 0.4 m apart, in 10 steps of 0.1 s: the most hits that a rule allows.
fn most_hits(rule: DamageRule) -> ScenePlan {
    let lane = [Interval::new(0.0, 0.4)];
    let body = Body::new("p", lane, 4.0, 12.0).with_start(Region::point([0.2, -1.5]));
    let scene = Scene::new(0.1).with_body(body).with_room("end", lane, bounce(0.9));
    // Without such a limit, a body at rest at a wall "hits" it in every step.
    let touch = vec![0.05; 10];
    let mut program = scene.with_rule(rule).program(10).unwrap();
    let outputs = program.program().variables().output("impact speed").unwrap().to_vec();
    let reward: Affine = outputs.iter().cloned().zip(touch).map(|(f, w)| w * f).sum();
    let goal = program.hits() + reward;
    program.maximize(goal).unwrap();
    solved(&program).unwrap()
}

#[test]
fn a_window_heals() {
    let rule = || DamageRule::new("r", DamageMeasure::ImpactSpeed);
    // One hit within any 4 steps: at most 3 in 10 steps.
    let plan = most_hits(rule().with_count(1).with_window(4));
    assert_eq!(plan.hits.len(), 3);
    assert!(plan.hits.windows(2).all(|pair| pair[1].step >= pair[0].step + 4));
    // Without the window it is one in all.
    assert_eq!(most_hits(rule().with_count(1)).hits.len(), 1);
    let plan = most_hits(rule().with_total(1.5).with_window(3));
    for first in 0..8 {
        let hits = plan.hits.iter().filter(|hit| (first..first + 3).contains(&hit.step));
        assert!(hits.map(|hit| hit.damage).sum::<f64>() <= 1.5 + 1e-4);
    }
    assert!(plan.hits.iter().map(|hit| hit.damage).sum::<f64>() > 1.6);
}

#[test]
fn a_convex_measure_is_the_largest_of_its_pieces() {
    let pieces = vec![(0.5, 0.1), (2.0, -1.4)];
    let measure = |f: f64| (0.5 * f + 0.1).max(2.0 * f - 1.4);
    let rule = DamageRule::new("r", DamageMeasure::Convex(pieces));
    let plan = most_hits(rule.clone().with_per_hit(0.8));
    assert!(plan.hits.iter().all(|hit| measure(hit.damage) <= 0.8 + 1e-5));
    let plan = most_hits(rule.with_total(1.3));
    assert!(plan.hits.iter().map(|hit| measure(hit.damage)).sum::<f64>() <= 1.3 + 1e-4);
    assert!(plan.hits.len() > 1);
}

/// Thrown along a floor: the most sliding speed of a hit within an angle from the normal.
fn steep(estimate: ImpactEstimate, angle: f64) -> Option<ScenePlan> {
    let room = [Interval::new(0.0, 4.0), Interval::new(0.0, 1.0)];
    let body = Body::new("p", room, 4.0, 12.0).with_start(Region::point([0.5, 0.45, 1.8, -1.5]));
    let floor = Solid::halfspace("floor", [0.0, 1.0], 0.0, bounce(0.5));
    let rule = DamageRule::new("r", DamageMeasure::ImpactSpeed).with_incidence(angle);
    let scene = Scene::new(0.1).with_body(body).with_obstacle(floor).with_rule(rule);
    let mut program = scene.with_estimate(estimate).program(4).unwrap();
    let hits = program.hits();
    program.add("once", hits.equals(1.0)).unwrap();
    let place = program.program().variables().state("p x").unwrap()[4];
    program.maximize(place).unwrap();
    solved(&program)
}

#[test]
fn incidence_is_limited_where_the_impact_is() {
    for angle in [0.2, 0.5, 1.0] {
        let plan = steep(ImpactEstimate::Sound, angle).unwrap();
        let hit = &plan.hits[0];
        let (v, a) = (&plan.bodies[0].velocity, &plan.bodies[0].acceleration);
        let time = hit.time - 0.1 * hit.step as f64;
        let at: Vec<f64> = (0..2).map(|i| v[hit.step][i] + time * a[hit.step][i]).collect();
        assert!(at[0].abs() <= -at[1] * angle.tan() + 1e-5, "{at:?}");
    }
    // At the end of the step it is enough where only this counts, so that plans get farther.
    let end = |estimate| steep(estimate, 0.5).unwrap().bodies[0].position[4][0];
    assert!(end(ImpactEstimate::EndOfStep) >= end(ImpactEstimate::Sound) - 1e-6);
}

/// Thrown at a floor in space, in a direction: the largest speed along it that a rule lets hit.
fn slanted(turn: f64, angle: f64, rests: bool) -> f64 {
    let (sin, cos) = turn.sin_cos();
    let room = [Interval::new(-4.0, 4.0), Interval::new(-4.0, 4.0), Interval::new(0.0, 2.0)];
    let body = Body::new("p", room, 6.0, 0.0).with_start(Region::from([
        Interval::point(0.0),
        Interval::point(0.0),
        Interval::point(0.2),
        Interval::new(-6.0, 6.0),
        Interval::new(-6.0, 6.0),
        Interval::point(-3.0),
    ]));
    let surface = if rests { bounce(0.5).with_rest() } else { bounce(0.5) };
    let floor = Solid::halfspace("floor", [0.0, 0.0, 1.0], 0.0, surface);
    let rule = DamageRule::new("r", DamageMeasure::ImpactSpeed).with_incidence(angle);
    let scene = Scene::new(0.1).with_body(body).with_obstacle(floor).with_rule(rule);
    let mut program = scene.program(1).unwrap();
    let hits = program.hits();
    program.add("once", hits.equals(1.0)).unwrap();
    let handle = scene.body_named("p").unwrap();
    let along = program.at(cos * handle.velocity(0) + sin * handle.velocity(1), 0).unwrap();
    program.maximize(along).unwrap();
    let plan = solved(&program).unwrap();
    let v = &plan.bodies[0].velocity[0];
    cos * v[0] + sin * v[1]
}

#[test]
fn incidence_in_space_is_a_cone() {
    for rests in [false, true] {
        for turn in [0.0, 0.1, 0.2, 1.3] {
            let found = slanted(turn, 0.6, rests);
            assert!((found - 3.0 * 0.6_f64.tan()).abs() < 1e-4, "{turn}: {found}");
        }
    }
}

#[test]
fn rules_of_one_face_leave_others_alone() {
    // A pillar to be hit from the left alone.
    let room = [Interval::new(-1.0, 1.0); 2];
    let pillar = [Interval::new(-0.1, 0.1), Interval::new(-0.5, 0.5)];
    let most = |face: usize| {
        let body = Body::new("p", room, 3.0, 3.0).with_start(Region::point([-0.5, 0.0, 1.0, 0.0]));
        let mut scene = Scene::new(0.1).with_body(body);
        let pillar = scene.obstacle(Solid::cuboid("pillar", pillar, bounce(0.5))).unwrap();
        let rule = DamageRule::new("r", DamageMeasure::NormalImpulse).with_face(pillar, face);
        let scene = scene.with_rule(rule.with_per_hit(0.6));
        let mut program = scene.program(5).unwrap();
        let goal = program
            .program()
            .variables()
            .output("impact speed")
            .unwrap()
            .iter()
            .cloned()
            .sum::<Affine>();
        program.maximize(goal).unwrap();
        solved(&program).unwrap().hits.iter().map(|hit| hit.damage).fold(0.0, f64::max)
    };
    // Face 0 is the left one; (1 + e) m f <= 0.6 N s.
    assert!(most(0) <= 0.4 + 1e-5 && most(1) > 1.0);
}

#[test]
fn objectives_in_turn_keep_what_the_first_ones_reached() {
    // A crash that is sure: first the least damage, then the least effort that has it.
    let lane = [Interval::new(0.0, 2.0)];
    let body = Body::new("p", lane, 4.0, 3.0).with_start(Region::point([0.5, -3.0]));
    let wall = Solid::halfspace("wall", [1.0], 0.0, bounce(0.5));
    let scene = Scene::new(0.1).with_body(body).with_obstacle(wall);
    let mut program = scene.program(8).unwrap();
    let damage = program.largest_impact().unwrap();
    let effort = program.effort().unwrap();
    let mut solver = BranchAndBound::default();
    let found = program.minimize_in_turn(&[damage], effort, &mut solver).unwrap();
    assert!(found.is_optimal());
    let plan = program.plan(&found).unwrap();
    let largest = plan.hits.iter().map(|hit| hit.damage).fold(0.0, f64::max);
    let least = scene.mitigate(8, &mut solver).unwrap();
    assert!((largest - least.bound).abs() < 1e-4, "{largest} {}", least.bound);
    let spent = |plan: &ScenePlan| -> f64 {
        plan.bodies[0].acceleration.iter().map(|a| 0.1 * a[0] * a[0]).sum()
    };
    // The rest of the plan needs no push.
    assert!(spent(&plan) <= spent(&least.plan.unwrap()) + 1e-4);
    // A horizon that has no plan has none in turn.
    let goal = Region::point([0.5, 0.0]);
    let mut never = scene.clone();
    never.bodies[0].goal = Some(goal);
    let mut program = never.program(2).unwrap();
    let (hits, effort) = (program.hits(), program.effort().unwrap());
    let found = program.minimize_in_turn(&[hits], effort, &mut solver).unwrap();
    assert_eq!(found.termination(), Termination::Infeasible);
}
