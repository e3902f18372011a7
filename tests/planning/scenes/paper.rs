//! A scene on a line is the paper's program.

use carom::collision_tolerant::{ContactLaw, Objective, Scenario};
use carom::hybrid::scene::{Body, DamageMeasure, DamageRule, Scene, Solid, Surface};
use carom::hybrid::{ImpactEstimate, Region, Restitution};
use carom::interval::Interval;
use carom::prelude::*;

#[test]
fn both_count_damage_alike() {
    // The least largest damage over a horizon, sound and as in the paper.
    let scenario = Scenario::paper().with_restitution(0.3).unwrap().with_time_step(0.1);
    let mut solver = BranchAndBound::default();
    let mut least = Vec::new();
    for estimate in [ImpactEstimate::EndOfStep, ImpactEstimate::Sound] {
        let scenario = scenario.clone().with_estimate(estimate);
        let planned = scenario.plan(24, Objective::LargestDamage, &mut solver).unwrap();
        let mut program = scene(&scenario).with_estimate(estimate).program(24).unwrap();
        let largest = program.largest_impact().unwrap();
        program.minimize(largest).unwrap();
        let solution = solver.solve(program.model()).unwrap();
        let replayed = program.plan(&solution).unwrap();
        let own = solution.objective().unwrap();
        assert!((own - planned.trajectory.largest_damage()).abs() < 1e-4, "{estimate:?}");
        assert!(replayed.hits.iter().all(|hit| hit.damage <= own + 1e-5));
        least.push(own);
    }
    assert!(least[1] >= least[0] - 1e-6);
}

/// The paper's scenario as a scene.
fn scene(scenario: &Scenario) -> Scene {
    let (start, goal) = (scenario.start, scenario.goal);
    let car = Body::new("car", [Interval::new(0.0, 25.0)], scenario.max_speed, 6.0)
        .with_start(Region::point([start.position, start.velocity]))
        .with_goal(Region::point([goal.position, goal.velocity]))
        .with_first_acceleration([0.0]);
    let wall = Surface::bounce(scenario.restitution);
    Scene::new(scenario.time_step)
        .with_body(car)
        .with_obstacle(Solid::halfspace("wall", [1.0], 0.0, wall))
        .with_estimate(ImpactEstimate::EndOfStep)
}

#[test]
fn limits_of_damage_and_other_goals_give_as_many_steps() {
    // As in `scene_benchmarks -- paper`, on a coarser grid.
    let mut solver = BranchAndBound::default();
    let paper = Scenario::paper().with_time_step(0.05);
    let limited = DamageRule::default().with_per_hit(1.5);
    for (scenario, limit) in [
        (paper.clone().collision_free(), None),
        (paper.clone().with_restitution(0.025).unwrap().with_damage(limited), Some(1.5)),
        (paper.clone().with_goal_position(0.6), None),
        (paper.with_goal_position(0.9), None),
    ] {
        let expected = scenario.shortest(&mut solver).unwrap();
        let mut own = scene(&scenario);
        if scenario.law == ContactLaw::Forbidden {
            own.obstacles = vec![Solid::halfspace("wall", [1.0], 0.0, Surface::avoid())];
        }
        if let Some(most) = limit {
            let rule = DamageRule::new("limit", DamageMeasure::ImpactSpeed);
            own = own.with_rule(rule.with_per_hit(most));
        }
        let found = own.shortest(&mut solver).unwrap();
        assert!(expected.steps.is_some());
        assert_eq!(found.steps, expected.steps);
    }
}

#[test]
fn a_scene_on_a_line_needs_as_many_steps_as_the_papers_planner() {
    let mut solver = BranchAndBound::default();
    for (restitution, time_step) in [(0.0, 0.05), (0.025, 0.02), (0.5, 0.025), (0.8, 0.05)] {
        let scenario = Scenario::paper().with_restitution(restitution).unwrap();
        let scenario = scenario.with_time_step(time_step);
        let expected = scenario.shortest(&mut solver).unwrap();
        let found = scene(&scenario).shortest(&mut solver);
        let found = found.unwrap();
        assert!(found.is_found() && found.monotonicity.is_monotone());
        let plan = expected.plan.unwrap();
        assert_eq!(found.steps, Some(plan.trajectory.steps()));
        let replayed = found.plan.unwrap();
        assert!(replayed.certificate.drift < 1e-6);
    }
    assert!(Restitution::new(1.1).is_err());
}
