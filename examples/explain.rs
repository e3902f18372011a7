//! Why is there no plan? A vehicle has 40 steps to get beside a wall, and that is too few.
//!
//! Run with `cargo run --release --example explain`.

use carom::collision_tolerant::{Program, Scenario};
use carom::explain::{ElasticOptions, ExplainOptions, infeasibility, relaxation, violations};
use carom::hybrid::DamageLimits;
use carom::prelude::*;

fn main() -> Result<(), Error> {
    let mut solver = BranchAndBound::default();

    // The paper's vehicle in 40 steps of 0.0575 s. Braking against the wall takes 2.3 s, but no
    // impact may be faster than 3 m/s.
    let limits = DamageLimits::default().with_per_impact(3.0);
    let scenario = Scenario::paper().with_time_step(0.0575).with_damage(limits);
    let program = Program::stated(&scenario, 40)?;

    let why = infeasibility(&program.model, &mut solver, &ExplainOptions::default())?;
    println!("{why}\n");
    for group in why.groups() {
        let Some(point) = group.without() else { continue };
        println!("without {}:", group.name());
        for violation in violations(&program.model, point.as_slice(), 1e-6)?.iter().take(2) {
            println!("  it would do to violate {violation}");
        }
    }

    // Where the vehicle stays as it is: how far from the goal would it end, or how hard would it
    // have to hit? A metre of the goal is as bad as 10 m/s of damage.
    let options = ElasticOptions::default()
        .with_background(["start", "acceleration", "speed", "goal_velocity"])
        .with_weight("goal_position", 10.0);
    println!(
        "\nthe least that has to give: {}",
        relaxation(&program.model, &mut solver, &options)?
    );
    Ok(())
}
