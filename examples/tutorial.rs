//! The whole program of the tutorial: a robot in an aisle with a crossing, and the same robot in a
//! room.
//!
//! `cargo run --release --example tutorial [-- PICTURE.svg [PICTURE.svg]]`

use carom::explain::{ElasticOptions, ExplainOptions, elastic_relaxation, infeasibility};
use carom::picture::Chart;
use carom::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut paths = std::env::args().skip(1);
    let mut robot = HybridSystem::new(0.25); // s
    let x = robot.state("x", 0.0, 12.0)?; // m
    let v = robot.state("v", -2.0, 2.0)?; // m/s
    let a = robot.input("a", -1.0, 1.0)?; // m/s²
    robot.rates([x.is(v), v.is(a)])?;
    robot.mode("before")?.invariant(x.le(5.0))?;
    robot
        .mode("crossing")?
        .invariant(x.within(5.0, 7.0))?
        .limit("slow", v.le(0.5))?
        .limit("slow_end", v.predicted().le(0.5))?;
    robot.mode("after")?.invariant(x.ge(7.0))?;

    // The shortest plan, with its proof.
    let start = [x.equals(1.0), v.equals(0.0)];
    let goal = [x.equals(11.0), v.equals(0.0)];
    let mut solver = BranchAndBound::default();
    let mut found = robot.shortest(start.clone(), goal.clone(), &mut solver)?;
    println!("{found}");
    println!("{} horizons refuted, {} solved", found.refutations().count(), found.solves());
    if let Some(sets) = &mut found.sets
        && let Some(reason) = sets.explain(45)?
    {
        println!("{reason}");
    }
    if let (Some(plan), Some(tube), Some(path)) = (&found.plan, &found.tube, paths.next()) {
        let chart = tube.chart(0, 1, Some(&plan.run))?.with_labels("position (m)", "speed (m/s)");
        std::fs::write(&path, Chart::to_svg(&[chart], "A robot at a crossing"))?;
        println!("wrote {path}");
    }

    // Time to spare, and as little effort as possible.
    let mut program = robot.program(54)?;
    program.start(start.clone())?;
    program.goal(goal.clone())?;
    program.minimize(program.sum(a.square())?)?;
    let plan = program.solve(&mut solver)?;
    let (positions, speeds) = (plan.values(x)?, plan.values(v)?);
    for k in (0..=54).step_by(9) {
        println!("{:5.2} s  {:6.3} m  {:5.3} m/s", 0.25 * k as f64, positions[k], speeds[k]);
    }

    // Too little time.
    let mut hasty = robot.program(40)?;
    hasty.start(start)?;
    hasty.goal(goal)?;
    if let Err(error) = hasty.solve(&mut solver) {
        println!("{error}");
    }
    println!("{}", infeasibility(hasty.model(), &ExplainOptions::default(), &mut solver)?);
    let options = ElasticOptions::default().with_background(["start", "goal"]);
    println!("{}", elastic_relaxation(hasty.model(), &options, &mut solver)?);

    // The same robot in a room, with a rack in its way.
    let room = [0.0..=8.0, 0.0..=5.0]; // m
    let body = Body::new("robot", &room, 2.0, 1.0)
        .with_start([1.0, 1.0, 0.0, 0.0])
        .with_goal([7.0, 1.0, 0.0, 0.0]);
    let scene = Scene::new(0.25)
        .with_body(body)
        .with_room("wall", &room, Surface::avoid())
        .with_obstacle(Solid::cuboid("rack", &[3.0..=5.0, -1.0..=3.0], Surface::avoid()));
    let found = scene.shortest(&mut solver)?;
    println!("{found}");
    if let (Some(plan), Some(path)) = (&found.plan, paths.next()) {
        std::fs::write(&path, plan.to_svg(&scene)?)?;
        println!("wrote {path}");
    }
    Ok(())
}
