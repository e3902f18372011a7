//! A hybrid system, stated once: an elevator with two gears that must stop at a floor.
//!
//! `cargo run --release --example elevator [-- PICTURE.svg]`
//!
//! High gear is stronger but allowed only above 0.4 m/s. The gear is chosen in each step. How soon
//! can the cabin be at rest at 12 m? Rows, reach sets and the check of the plan all come from one
//! statement of the system.

use carom::picture::Chart;
use carom::prelude::*;

const TIME_STEP: f64 = 0.1; // s

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut lift = HybridSystem::new(TIME_STEP);
    let x = lift.state("x", 0.0, 15.0)?; // m
    let v = lift.state("v", -2.5, 2.5)?; // m/s
    let u = lift.input("u", -1.0, 1.0)?;
    lift.mode("low gear")?.rates([x.is(v), v.is(0.6 * u)])?;
    let high = lift.mode("high gear")?.rates([x.is(v), v.is(1.5 * u)])?;
    let high = high.limit("the least speed of high gear", v.ge(0.4))?.taken(); // m/s

    let (start, goal) = ([x.equals(0.0), v.equals(0.0)], [x.equals(12.0), v.equals(0.0)]);
    let mut found = lift.shortest(start, goal, &mut BranchAndBound::default())?;
    let (Some(steps), Some(tube), Some(plan)) = (found.steps, &found.tube, &found.plan) else {
        return Err(format!("no horizon found: {}", found.status).into());
    };
    println!("shortest horizon: {steps} steps of {TIME_STEP} s ({})", found.status);
    let refuted = found.refutations().count();
    println!("refuted: {refuted} horizons, with {} solves in all", found.solves());
    println!("presolve: {}", lift.program(steps)?.tighten(tube)?);
    println!("waiting: {}", found.monotonicity.reason());
    println!("the plan takes high gear in {} of {steps} steps", plan.count(high)?);

    if let Some(path) = std::env::args().nth(1) {
        let chart = tube.chart(0, 1, Some(&plan.run))?.with_labels("position (m)", "speed (m/s)");
        let title = format!(
            "An elevator with two gears\n{:.1} s from floor to floor; all shorter horizons are refuted by \
             sets like these.",
            steps as f64 * TIME_STEP
        );
        std::fs::write(&path, Chart::to_svg(&[chart], &title))?;
        println!("wrote {path}");
    }
    if let Some(sets) = &mut found.sets
        && let Some(reason) = sets.explain(steps - 1)?
    {
        println!("{reason}");
    }
    Ok(())
}
