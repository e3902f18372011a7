//! A quadrotor in the plane, past three posts and perhaps off a wall, in the least time and with
//! the least fuel: speed and thrust are limited by discs, or by the octagons in them.
//!
//! `cargo run --release --example quadrotor_plane`

use carom::model::norm;
use carom::prelude::*;
use std::f64::consts::{FRAC_PI_4, FRAC_PI_8};

const POSTS: [[f64; 4]; 3] = [[1.0, 1.5, 0.0, 1.2], [1.8, 2.4, 0.9, 2.0], [2.6, 3.0, 0.0, 0.9]]; // m

/// The plan of least fuel in some steps, replayed, with its fuel in m/s and its bounces.
fn plan(steps: usize, octagon: bool) -> Result<(f64, usize), Error> {
    let mut drone = HybridSystem::new(0.25);
    let (x, y) = (drone.state("x", -1.0, 4.0)?, drone.state("y", 0.0, 2.0)?);
    let (v, w) = (drone.state("v", -1.8, 1.8)?, drone.state("w", -1.8, 1.8)?);
    let (a, b) = (drone.input("a", -4.0, 4.0)?, drone.input("b", -4.0, 4.0)?);
    drone.rates([x.is(v), y.is(w), v.is(a), w.is(b)])?; // at most 1.8 m/s and 4 m/s²
    drone.limit("speed", norm([v, w]).le(1.8))?;
    drone.limit("thrust", norm([a, b]).le(4.0))?;
    for side in (0..8).filter(|_| octagon) {
        let (sin, cos) = (f64::from(side) * FRAC_PI_4).sin_cos();
        let share = FRAC_PI_8.cos();
        drone.limit(&format!("speed side {side}"), (cos * v + sin * w).le(1.8 * share))?;
        drone.limit(&format!("thrust side {side}"), (cos * a + sin * b).le(4.0 * share))?;
    }
    // The wall is at 3.4 m and gives back 0.8 of the speed.
    drone.mode("fly")?.guard(x.predicted().le(3.4))?;
    let back = [x.is(3.4 - 0.8 * (x.predicted() - 3.4)), v.is(-0.8 * v.predicted())];
    let bounce = drone.event("bounce")?.guard(x.predicted().ge(3.4))?;
    let bounce = bounce.guard(v.predicted().ge(0.0))?.reset(back)?.taken();
    let mut program = drone.program(steps)?;
    program.start([x.equals(0.0), y.equals(0.3), v.equals(0.0), w.equals(0.0)])?;
    program.goal([x.equals(3.2), y.equals(0.3), v.equals(0.0), w.equals(0.0)])?;
    for k in 0..steps {
        let (x, y) = (program.at(x, k)?, program.at(y, k)?);
        for (post, [left, right, low, high]) in POSTS.into_iter().enumerate() {
            let beside = either(x.le(left)).or(x.ge(right)).or(y.le(low)).or(y.ge(high));
            program.add((format!("post {post}"), k), beside)?;
        }
    }
    let fuel = 0.25 * program.sum_norm("fuel", [a, b])?;
    program.minimize(&fuel)?;
    let plan = program.solve(&mut BranchAndBound::default())?;
    Ok((plan.solution.value(&fuel)?, plan.count(bounce)?))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for (name, octagon) in [("discs", false), ("octagons", true)] {
        let least = (6..20).find(|&steps| plan(steps, octagon).is_ok()).ok_or("no plan")?;
        for steps in [least, 14] {
            let (fuel, bounces) = plan(steps, octagon)?;
            println!("{name}: {fuel:.4} m/s of fuel in {steps} steps, {bounces} bounces");
        }
    }
    Ok(())
}
