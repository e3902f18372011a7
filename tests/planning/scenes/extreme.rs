//! Extreme plans: inputs at the ends of their range, where many plans are as good.

use carom::collision_tolerant::Scenario;
use carom::hybrid::scene::{Body, DamageMeasure, DamageRule, Scene, Surface};
use carom::hybrid::{Region, Restitution};
use carom::interval::Interval;
use carom::prelude::*;

#[test]
fn plans_of_the_paper_switch_instead_of_turning() {
    let mut solver = BranchAndBound::default();
    let limits = DamageRule::default().with_per_hit(5.0);
    for (restitution, limits) in [(0.0, None), (0.3, None), (0.3, Some(limits)), (0.9, None)] {
        let mut scenario = Scenario::paper().with_restitution(restitution).unwrap();
        scenario = scenario.with_time_step(0.02);
        if let Some(limits) = limits.clone() {
            scenario = scenario.with_damage(limits);
        }
        let found = scenario.shortest(&mut solver).unwrap();
        let plan = found.plan.unwrap();
        let extreme = plan.extreme(&scenario, &mut solver).unwrap();
        let (old, new) = (&plan.trajectory, &extreme.trajectory);
        assert_eq!((old.steps(), &old.contact), (new.steps(), &new.contact));
        let between = new.acceleration[1..new.steps()].iter().filter(|a| a.abs() < 6.0 - 1e-5);
        // Goal, wall and limit are at most five equations.
        assert!(between.count() <= 5, "{restitution}: {:?}", new.acceleration);
        assert!(new.damage.iter().all(|d| *d <= limits.as_ref().map_or(15.0, |_| 5.0) + 1e-5));
    }
}

#[test]
fn scenes_keep_their_hits_and_the_least_price() {
    let table = [Interval::new(0.0, 2.0), Interval::new(0.0, 1.0)];
    let puck = Body::new("puck", table, 3.0, 3.0)
        .with_start(Region::point([1.2, 0.2, 2.0, 2.0]))
        .with_goal(Region::point([0.4, 0.2, 0.0, 0.0]));
    let cushion = Surface::bounce(Restitution::new(0.9).unwrap());
    let rule = DamageRule::new("wear", DamageMeasure::ImpactSpeed).with_price(1.0);
    let scene = Scene::new(0.1).with_body(puck).with_room("cushion", table, cushion);
    let mut solver = BranchAndBound::default();
    for scene in [scene.clone(), scene.with_rule(rule)] {
        let found = scene.shortest(&mut solver).unwrap();
        let plan = found.plan.unwrap();
        let extreme = plan.extreme(&scene, &mut solver).unwrap();
        let hits = |plan: &carom::hybrid::scene::ScenePlan| {
            plan.hits.iter().map(|hit| (hit.step, hit.contact.clone())).collect::<Vec<_>>()
        };
        assert_eq!(hits(&plan), hits(&extreme));
        let inside = |plan: &carom::hybrid::scene::ScenePlan| {
            let inputs = plan.bodies[0].acceleration.iter().flatten();
            inputs.filter(|a| a.abs() < 3.0 - 1e-5).count()
        };
        assert!(inside(&extreme) <= inside(&plan));
        let damage = |plan: &carom::hybrid::scene::ScenePlan| {
            plan.hits.iter().map(|hit| hit.damage).sum::<f64>()
        };
        // With the price, at most what any plan with these hits needs.
        assert!(scene.rules.is_empty() || damage(&extreme) <= damage(&plan) + 1e-4);
    }
}
