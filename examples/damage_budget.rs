//! A plan with a damage budget: the vehicle may hit the wall, but its impact speeds may sum to at
//! most 4 m/s.
//!
//! Run with `cargo run --release --example damage_budget`.

use carom::ErrorKind;
use carom::collision_tolerant::{Objective, Scenario};
use carom::hybrid::scene::DamageRule;
use carom::prelude::*;

fn main() -> Result<(), Error> {
    // The paper's vehicle on a coarser grid, with a wall that returns a third of the speed.
    let scenario = Scenario::paper().with_time_step(0.05).with_restitution(1.0 / 3.0)?;
    let steps = 54; // 2.7 s
    let mut solver = BranchAndBound::default();

    for budget in [None, Some(4.0), Some(0.5)] {
        let total = |most| DamageRule::default().with_total(most);
        let task = scenario.clone().with_damage(budget.map_or_else(DamageRule::default, total));
        let allowed = budget.map_or("no budget".into(), |b| format!("budget {b} m/s"));
        let plan = match task.plan(steps, Objective::Effort, &mut solver) {
            Err(error) if matches!(error.kind(), ErrorKind::NoPlan { .. }) => {
                println!("{allowed}: no plan");
                continue;
            }
            planned => planned?,
        };
        let trajectory = &plan.trajectory;
        println!(
            "{allowed}: effort {:.2} m²/s³ ({}), damage {:.3} m/s in {} impacts",
            plan.solution.objective().unwrap_or(0.0),
            plan.solution.termination(),
            trajectory.total_damage(),
            trajectory.impacts.len()
        );
        for impact in &trajectory.impacts {
            println!(
                "  t = {:.3} s: {:.3} m/s in, {:.3} m/s out",
                impact.time, impact.speed_before, impact.speed_after
            );
        }
        let certificate = &plan.certificate;
        println!(
            "  replay: within {:.0e} m; in continuous time dips {:.1e} m, speed off by {:.1e} m/s",
            certificate.drift, certificate.dip, certificate.step_speed_error
        );
    }
    Ok(())
}
