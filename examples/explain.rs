//! Why is there no plan? A vehicle has 40 steps to reach a goal next to a wall, which is too few.
//!
//! Run with `cargo run --release --example explain`.

use carom::collision_tolerant::Scenario;
use carom::explain::{
    ElasticOptions, ExplainOptions, elastic_relaxation, infeasibility, violations,
};
use carom::hybrid::scene::DamageRule;
use carom::prelude::*;

fn main() -> Result<(), Error> {
    let mut solver = BranchAndBound::default();

    // The paper's vehicle in 40 steps of 0.06 s. Braking against the wall is fast enough, but no
    // impact may be faster than 3 m/s.
    let limits = DamageRule::default().with_per_hit(3.0);
    let scenario = Scenario::paper().with_time_step(0.06).with_damage(limits);
    let program = scenario.explainable_program(40)?;

    let why = infeasibility(program.model(), &ExplainOptions::default(), &mut solver)?;
    println!("{why}\n");
    for group in why.groups() {
        let Some(point) = group.without() else { continue };
        let found = violations(program.model(), point.as_slice(), 1e-6)?;
        let own = found.iter().filter(|v| Name::from(v.name.as_str()).family() == group.name());
        if let Some(worst) = own.clone().next() {
            println!(
                "without {}: a plan that violates {worst}, {} in all",
                group.name(),
                own.count()
            );
        }
    }

    // If nothing else may change: how far from the goal would the vehicle end, or how hard would it
    // have to hit? A metre from the goal costs as much as 10 m/s of damage.
    let options = ElasticOptions::default()
        .with_background(["start", "acceleration", "speed", "goal_velocity"])
        .with_weight("goal_position", 10.0);
    println!(
        "\nthe least that has to give: {}",
        elastic_relaxation(program.model(), &options, &mut solver)?
    );
    Ok(())
}
