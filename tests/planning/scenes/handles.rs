//! Handles of bodies and obstacles: in expressions of programs, in rules, in clones of a scene.

use carom::hybrid::scene::{Body, DamageMeasure, DamageRule, Scene, ScenePlan, Solid, Surface};
use carom::hybrid::{Restitution, ShortestHorizon, ShortestOptions, State};
use carom::prelude::*;

fn bounce() -> Surface {
    Surface::bounce(Restitution::new(0.5).unwrap())
}

/// A fast puck before a wall, and another one far behind it.
fn scene() -> Scene {
    let mut scene = Scene::new(0.1);
    let body = |name: &str, x, v| {
        let body = Body::new(name, [-1.0..=4.0, 0.0..=1.0], 3.0, 1.0);
        body.with_start([x, 0.5, v, 0.2])
    };
    let near = scene.body(body("near", 0.3, -2.0)).unwrap();
    let far = scene.body(body("far", 3.0, 0.1)).unwrap();
    scene.pair(near, far, bounce()).unwrap();
    scene.obstacle(Solid::halfspace("wall", [1.0, 0.0], 0.0, bounce())).unwrap();
    scene
}

#[test]
fn handles_stand_for_the_bodies_of_the_plan() {
    let scene = scene();
    let mut program = scene.program(6).unwrap();
    let effort = program.effort().unwrap();
    program.minimize(effort).unwrap();
    let solution = BranchAndBound::default().solve(program.model()).unwrap();
    let plan = program.plan(&solution).unwrap();
    let value = |expression: Affine| solution.value(expression).unwrap();
    for (path, name) in plan.bodies.iter().zip(["near", "far"]) {
        let body = scene.body_named(name).unwrap();
        assert_eq!(path.name, name);
        for axis in 0..2 {
            for t in 0..=6 {
                let [x, v] = [body.position(axis), body.velocity(axis)]
                    .map(|state| value(program.at(state, t).unwrap()));
                assert_eq!((x, v), (path.position[t][axis], path.velocity[t][axis]));
            }
            for t in 0..6 {
                let a = value(program.at(body.acceleration(axis), t).unwrap());
                assert_eq!(a, path.acceleration[t][axis]);
            }
        }
    }
}

#[test]
fn rows_of_ones_own_and_soft_limits_are_stated_with_handles() {
    // A clone has the same handles, and so has the scene of a later step.
    let scene = scene().from_step(1);
    let far = scene.body_named("far").unwrap();
    let mut program = scene.program(6).unwrap();
    program.require("slow", [far.velocity(0).le(0.0)], When::Throughout(3..=6)).unwrap();
    program.add("moved", program.at(far.position(1), 6).unwrap().ge(0.7)).unwrap();
    let low = program.program_mut().soften("low", far.position(1).le(0.6), 1.0, 0.0).unwrap();
    program.minimize(low.cost.clone()).unwrap();
    let plan = program.solve(&mut BranchAndBound::default()).unwrap();
    let path = plan.body("far").unwrap();
    assert!(path.velocity[3..].iter().all(|v| v[0] <= 1e-6));
    assert!(path.position[6][1] >= 0.7 - 1e-6);
}

#[test]
fn shortest_plans_take_rows_about_bodies() {
    let mut scene = Scene::new(0.1);
    let puck = Body::new("puck", [0.0..=4.0, 0.0..=1.0], 3.0, 3.0).with_start([0.5, 0.5, 0.0, 0.0]);
    let goal = |x: &[State], v: &[State]| [x[0].ge(2.0), v[0].le(x[0] - 2.0)];
    let puck = scene.body(puck.with_goal_where(goal).unwrap()).unwrap();
    let mut solver = BranchAndBound::default();
    let free = scene.shortest(&mut solver).unwrap();
    let end = |found: &ShortestHorizon<ScenePlan>| {
        let path = &found.plan.as_ref().unwrap().bodies[0];
        (path.position.last().unwrap()[0], path.velocity.last().unwrap()[0])
    };
    let (x, v) = end(&free);
    assert!(x >= 2.0 - 1e-6 && v <= x - 2.0 + 1e-6, "{x}, {v}");
    let slow = move |program: &mut HybridProgram| {
        let steps = program.steps();
        program.require("slow", [puck.velocity(0).le(1.0)], When::Throughout(0..=steps))
    };
    let options = ShortestOptions::default().with_rows(slow);
    let slow = scene.shortest_with(&options, &mut solver).unwrap();
    assert!(slow.steps > free.steps);
    let path = &slow.plan.as_ref().unwrap().bodies[0];
    assert!(path.velocity.iter().all(|v| v[0] <= 1.0 + 1e-6));
}

#[test]
fn rules_count_the_hits_of_their_place_alone() {
    // The puck cannot but hit the wall.
    let scene = scene();
    let [near, far] = ["near", "far"].map(|name| scene.body_named(name).unwrap());
    let wall = scene.obstacle_named("wall").unwrap();
    let none = || DamageRule::new("none", DamageMeasure::ImpactSpeed).with_count(0);
    let has_plan = |rule: DamageRule| {
        let program = scene.clone().with_rule(rule).program(6).unwrap();
        let plan = program.solve(&mut BranchAndBound::default());
        if let Ok(plan) = &plan {
            assert_eq!(plan.hits.len(), 1);
        }
        plan.is_ok()
    };
    assert!(!has_plan(none()));
    assert!(!has_plan(none().with_body(near)));
    assert!(!has_plan(none().with_obstacle(wall)));
    assert!(!has_plan(none().with_face(wall, 0)));
    assert!(!has_plan(none().with_body(near).with_obstacle(wall)));
    assert!(has_plan(none().with_body(far)));
    assert!(has_plan(none().with_pair(near, far)));
    assert!(has_plan(none().with_body(far).with_obstacle(wall)));
}

#[cfg(feature = "serde")]
#[test]
fn a_rule_about_a_place_is_not_stored_without_its_scene() {
    let scene = scene();
    let rule = DamageRule::new("soft", DamageMeasure::NormalImpulse).with_per_hit(2.0);
    let text = serde_json::to_string(&rule).unwrap();
    assert_eq!(serde_json::from_str::<DamageRule>(&text).unwrap(), rule);
    let there = rule.with_obstacle(scene.obstacle_named("wall").unwrap());
    let error = serde_json::to_string(&there).unwrap_err().to_string();
    assert!(error.contains("belongs to its scene"), "{error}");
}
