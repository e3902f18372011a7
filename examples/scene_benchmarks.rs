//! Scenes that equal programs written by hand: same optimum, and the time that both take.
//!
//! `cargo run --release --example scene_benchmarks`

#[path = "../tests/instances/mod.rs"]
mod instances;

use std::error::Error as StdError;
use std::time::Instant;

use carom::collision_tolerant::{PlanningOptions, Scenario, shortest_plan};
use carom::hybrid::scene::{Body, Scene, Solid, Surface};
use carom::hybrid::{ImpactEstimate, Region, Restitution, ShortestOptions};
use carom::interval::Interval;
use carom::prelude::*;

/// Left, right, below, above, in m; as in the instances `boxes_*`.
const BOXES: [[f64; 4]; 4] = [
    [4.355602058025833, 5.786257438377247, 6.343862620245817, 9.061701735665407],
    [2.608826637006559, 5.133150787119266, 3.6125993847401245, 5.467318002930782],
    [4.0947516390985115, 6.500372612978202, 1.1348400288829876, 3.195869330033833],
    [3.135834435561237, 4.820946162427869, 5.767773908985905, 7.6933705321549475],
];

fn room() -> Scene {
    let room = [Interval::new(0.0, 10.0); 2];
    let point = Body::new("p", room, 2.0, 1.5)
        .with_start(Region::point([0.5, 0.5, 0.0, 0.0]))
        .with_goal(Region::point([9.5, 9.5, 0.0, 0.0]));
    let scene = Scene::new(0.5).with_body(point).with_estimate(ImpactEstimate::EndOfStep);
    BOXES.iter().enumerate().fold(scene, |scene, (k, [left, right, below, above])| {
        let sides = [Interval::new(*left, *right), Interval::new(*below, *above)];
        scene.with_obstacle(Solid::cuboid(format!("b{k}"), &sides, Surface::avoid()))
    })
}

fn puck() -> Result<Scene, Error> {
    let table = [Interval::new(0.0, 6.0), Interval::new(0.0, 4.0)];
    let puck = Body::new("puck", table, 3.0, 0.8)
        .with_start(Region::point([1.0, 3.0, -1.2, 0.6]))
        .with_goal(Region::point([5.0, 1.0, 0.0, 0.0]));
    let cushion = Surface::bounce(Restitution::new(0.7)?);
    let scene = Scene::new(0.2).with_body(puck).with_room("c", &table, cushion);
    Ok(scene.with_estimate(ImpactEstimate::EndOfStep).with_corners(true))
}

/// The median time of five solves, and the objective.
fn solve(model: &Model) -> Result<(f64, f64, u64), Error> {
    let mut times = Vec::new();
    let (mut objective, mut nodes) = (f64::NAN, 0);
    for _ in 0..5 {
        let start = Instant::now();
        let solution = BranchAndBound::default().solve(model)?;
        times.push(start.elapsed().as_secs_f64());
        objective = solution.objective().unwrap_or(f64::NAN);
        nodes = solution.statistics().nodes;
    }
    times.sort_by(f64::total_cmp);
    Ok((times[2], objective, nodes))
}

fn compare(name: &str, by_hand: &Model, scene: &Model) -> Result<(), Error> {
    let ((t1, o1, n1), (t2, o2, n2)) = (solve(by_hand)?, solve(scene)?);
    println!(
        "{name}: by hand {o1:.6} in {t1:.3} s, {n1} nodes; scene {o2:.6} in {t2:.3} s, {n2} nodes"
    );
    Ok(())
}

fn main() -> Result<(), Box<dyn StdError>> {
    for steps in [20, 30, 40] {
        let mut program = room().program(steps)?;
        let fuel = program.fuel()?;
        program.model.minimize(fuel)?;
        let by_hand = instances::generators::boxes(steps, 4, false);
        compare(&format!("boxes, {steps} steps"), &by_hand, &program.model)?;
    }
    let mut program = puck()?.program(25)?;
    let effort = program.effort()?;
    program.model.minimize(5.0 * effort)?;
    let by_hand = instances::generators::puck(25, 0.2);
    compare("puck, 25 steps", &by_hand, &program.model)?;
    let start = Instant::now();
    program.tighten()?;
    println!("sets of each axis: {:.3} s", start.elapsed().as_secs_f64());
    compare("puck, 25 steps, tightened", &by_hand, &program.model)?;

    let (mut by_hand, mut as_scene) = (0.0, 0.0);
    for restitution in [0.0, 0.025, 0.1, 0.25, 0.5, 0.65, 0.8, 1.0] {
        let scenario = Scenario::paper().with_restitution(restitution)?;
        let car = Body::new("car", [Interval::new(0.0, 25.0)], 15.0, 6.0)
            .with_start(Region::point([10.0, 0.0]))
            .with_goal(Region::point([0.3, 0.0]))
            .with_first_acceleration([0.0]);
        let wall = Surface::bounce(scenario.contact.restitution);
        let scene = Scene::new(scenario.time_step)
            .with_body(car)
            .with_obstacle(Solid::halfspace("wall", [1.0], 0.0, wall))
            .with_estimate(ImpactEstimate::EndOfStep);
        let mut solver = BranchAndBound::default();
        let start = Instant::now();
        let plan = shortest_plan(&scenario, &PlanningOptions::default(), &mut solver)?;
        let middle = Instant::now();
        let found = scene.shortest_plan(&ShortestOptions::default(), &mut solver)?;
        let end = Instant::now();
        let (a, b) = ((middle - start).as_secs_f64(), (end - middle).as_secs_f64());
        by_hand += a;
        as_scene += b;
        println!(
            "the paper's wall, e = {restitution}: {:?} steps in {a:.3} s; scene {:?} in {b:.3} s",
            plan.plan.map(|plan| plan.trajectory.steps()),
            found.search.steps
        );
    }
    println!("sum: {by_hand:.2} s; scene {as_scene:.2} s");
    Ok(())
}
