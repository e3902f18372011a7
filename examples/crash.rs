//! An unavoidable crash, with and without mitigation, and a planner that interrupts a primary
//! controller only when it must.
//!
//! `cargo run --release --example crash [-- PICTURE.svg]`

use carom::ErrorKind;
use carom::hybrid::scene::{Avoidable, ScenePlan};
use carom::interval::Interval;
use carom::prelude::*;

const TIME_STEP: f64 = 0.1; // s

/// A vehicle in the plane before a building, which it may scrape along, and a soft barrier.
fn scene(state: [f64; 4]) -> Result<Scene, Error> {
    let ground = [-10.0..=30.0, -10.0..=10.0];
    let building = [12.0..=20.0, -4.0..=5.0];
    let hard = Surface::bounce(Restitution::new(0.1)?);
    Ok(Scene::new(TIME_STEP)
        .with_body(Body::new("vehicle", ground, 20.0, 5.0).with_start(state))
        .with_obstacle(Solid::cuboid("building", &building, hard)))
}

/// The primary controller keeps its course and hits whatever is there.
fn carry_on(
    state: [f64; 4],
    steps: usize,
    solver: &mut dyn Solver,
) -> Result<Option<ScenePlan>, Error> {
    let mut scene = scene(state)?;
    for body in &mut scene.bodies {
        body.acceleration = vec![Interval::point(0.0); 2];
    }
    match scene.program(steps)?.solve(solver) {
        Err(error) if matches!(error.kind(), ErrorKind::NoPlan { .. }) => Ok(None),
        plan => plan.map(Some),
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut solver = BranchAndBound::default();
    let steps = 15;

    // Too late: 12 m/s, 6 m before the wall, 4 m from the nearer corner.
    let late = [6.0, 1.0, 12.0, 0.0];
    match scene(late)?.avoidable(steps, &mut solver)? {
        Avoidable::Yes(_) => println!("the crash can be avoided"),
        Avoidable::No(reason) => {
            println!("the crash cannot be avoided");
            reason.iter().for_each(|reason| println!("  {reason}"));
        }
        _ => println!("the solver stopped before it could tell"),
    }
    if let Some(plan) = carry_on(late, steps, &mut solver)? {
        println!("carrying on: {:.2} m/s", plan.hits.iter().map(|h| h.damage).fold(0.0, f64::max));
    }
    let mitigated = scene(late)?.mitigate(steps, &mut solver)?;
    println!(
        "mitigated: {:.2} m/s, proved least above {:.2} m/s",
        mitigated.largest, mitigated.bound
    );
    if let (Some(plan), Some(path)) = (&mitigated.plan, std::env::args().nth(1)) {
        let hit = plan.hits.iter().map(|hit| hit.speed).fold(0.0, f64::max);
        let title = format!(
            "A crash that cannot be avoided\n12 m/s, 6 m before a building. The hit at {hit:.2} m/s counts as {:.2}, \
             as much as at the worse end of its step.\nNothing less is possible, proved.",
            mitigated.largest
        );
        std::fs::write(path, plan.picture(&scene(late)?)?.with_title(title).to_svg())?;
    }

    // In closed loop: at every sample, the primary controller drives on if the vehicle can still
    // get away after the next step; otherwise the planner takes over for good.
    let mut state = [-4.0, 1.0, 10.0, 0.0];
    let mut taken_over = None;
    for t in 0..25 {
        let next = [state[0] + TIME_STEP * state[2], state[1], state[2], state[3]];
        if matches!(scene(next)?.avoidable(steps, &mut solver)?, Avoidable::Yes(_)) {
            state = next;
            continue;
        }
        taken_over = Some(t);
        break;
    }
    if let Some(t) = taken_over
        && let Avoidable::Yes(plan) = scene(state)?.avoidable(steps, &mut solver)?
    {
        println!(
            "interrupted at {:.1} s, {:.1} m before the building",
            f64::from(t) * TIME_STEP,
            12.0 - state[0]
        );
        println!("  then {:.1} s without a hit", plan.duration());
    }
    Ok(())
}
