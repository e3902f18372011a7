//! The program that the page shows for a task.

use carom::collision_tolerant::{Endpoint, Scenario};
use carom::hybrid::scene::DamageRule;
use carom::prelude::*;

fn main() -> Result<(), Error> {
    // Plans begin and end without acceleration.
    let at = |position: f64| Endpoint::at_rest(position).with_acceleration(0.0);
    let scenario = Scenario::paper()
        .with_start(at(4.0).with_velocity(-10.0)) // m, m/s
        .with_goal(at(0.3)) // m
        .with_acceleration(-6.0..=6.0) // m/s²
        .with_max_speed(15.0) // m/s
        .with_time_step(0.05) // s
        .with_damage(DamageRule::default().with_per_hit(9.5)) // m/s
        .with_restitution(0.3)?;
    let options = ShortestOptions::default().with_max_steps(600);
    let plans = scenario.compare(&options, &mut BranchAndBound::default())?;
    println!("without collisions: {}", plans.free);
    println!("with collisions: {}", plans.tolerant);
    Ok(())
}
