//! A pendulum swings up and comes to rest against a wall that it may lean on, or without it.
//!
//! `cargo run --release --example pendulum [PICTURE.svg]`
//!
//! The motor is too weak to lift it at once. Both least numbers of steps are proved: without the
//! wall the pendulum has to brake, and against it it may hit, up to a speed.

use std::f64::consts::PI;

use carom::hybrid::{Discretization, HybridPlan};
use carom::picture::{Chart, SOLID, WITH_COLLISION, WITHOUT_COLLISION};
use carom::prelude::*;

/// Length of a step (s), the largest acceleration by the motor (rad/s²), and the place of the wall
/// (rad from hanging).
const STEP: f64 = 0.15;
const MOTOR: f64 = 5.5;
const WALL: f64 = 0.85 * PI;

/// The largest speed at which it may hit the wall (rad/s).
const IMPACT: f64 = 3.5;

/// The pendulum, with or without the chance to lean on the wall.
fn pendulum(leans: bool) -> Result<HybridSystem, Error> {
    let mut pendulum = HybridSystem::new(STEP);
    let angle = pendulum.state("angle", -PI, WALL)?; // rad
    let rate = pendulum.state("rate", -8.0, 8.0)?; // rad/s
    let torque = pendulum.input("torque", -MOTOR, MOTOR)?; // rad/s²
    pendulum.discretization(Discretization::Midpoint)?;
    pendulum.mode("swing")?.rates([angle.is(rate), rate.is(torque - 9.81 * angle.sin())])?;
    if leans {
        // It would be at the wall within the step, and stops there.
        pendulum
            .event("lean")?
            .guard((angle + STEP * rate).ge(WALL))?
            .guard(rate.within(0.0, IMPACT))?
            .next([angle.is(WALL), rate.is(0.0)])?;
    }
    Ok(pendulum)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut plans = Vec::new();
    for (name, leans) in [("braking", false), ("leaning", true)] {
        let system = pendulum(leans)?;
        let [angle, rate] = [system.state_named("angle")?, system.state_named("rate")?];
        let start = [angle.equals(0.0), rate.equals(0.0)];
        let goal = [angle.equals(WALL), rate.equals(0.0)];
        let found = system.shortest(start, goal, &mut BranchAndBound::default())?;
        println!("{name}: {found}");
        let Some(plan) = found.plan else { return Err("no plan".into()) };
        let motion = system.enclose_motion(&plan.run)?;
        println!("  its motion leaves the samples by at most {:.3} rad, proved", motion.errors[0]);
        plans.push((name, plan));
    }
    if let Some(path) = std::env::args().nth(1) {
        std::fs::write(path, picture(&plans)?)?;
    }
    Ok(())
}

fn picture(plans: &[(&str, HybridPlan)]) -> Result<String, Error> {
    let mut chart = Chart::new("time (s)", "angle (rad)").with_size(760.0, 320.0);
    let last = plans.iter().map(|(_, plan)| plan.run.state("angle").map(<[f64]>::len));
    let last = last.collect::<Result<Vec<usize>, Error>>()?.into_iter().max().unwrap_or(1) - 1;
    chart.line("wall", SOLID, [[0.0, WALL], [last as f64 * STEP, WALL]]);
    let mut steps = Vec::new();
    for ((name, plan), colour) in plans.iter().zip([WITHOUT_COLLISION[0], WITH_COLLISION[0]]) {
        let angles = plan.run.state("angle")?;
        let points = angles.iter().enumerate().map(|(t, angle)| [t as f64 * STEP, *angle]);
        chart.line(*name, colour, points);
        steps.push(angles.len() - 1);
    }
    let title = format!(
        "Rest at the wall after {} steps by braking, after {} by leaning; both are the least",
        steps[0], steps[1]
    );
    Ok(Chart::to_svg(&[chart], &title))
}
