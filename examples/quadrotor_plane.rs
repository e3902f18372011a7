//! A quadrotor in the plane, past three posts and perhaps off a wall: least fuel and least time, with speed and
//! thrust limited by discs and by the octagons in them.
//!
//! `cargo run --release --example quadrotor_plane`

use carom::ErrorKind;
use carom::model::norm;
use carom::prelude::*;

const POSTS: [[f64; 4]; 3] = [[1.0, 1.5, 0.0, 1.2], [1.8, 2.4, 0.9, 2.0], [2.6, 3.0, 0.0, 0.9]]; // m: x, x, y, y
const SPEED: f64 = 2.0; // m/s
const THRUST: f64 = 4.0; // m/s²
const STEP: f64 = 0.25; // s

/// The least fuel of a plan in some steps, in m/s, and its bounces; `None` if there is no plan.
fn plan(steps: usize, octagon: bool) -> Result<Option<(f64, usize)>, Error> {
    let mut drone = HybridSystem::new(STEP);
    let (x, y) = (drone.state("x", -1.0, 4.0)?, drone.state("y", 0.0, 2.0)?);
    let (v, w) = (drone.state("v", -SPEED, SPEED)?, drone.state("w", -SPEED, SPEED)?);
    let (a, b) = (drone.input("a", -THRUST, THRUST)?, drone.input("b", -THRUST, THRUST)?);
    drone.rates([x.is(v), y.is(w), v.is(a), w.is(b)])?;
    // The wall is at 3.4 m and gives back 0.8 of the speed.
    drone.mode("fly")?.guard(x.predicted().le(3.4))?;
    let back = [x.is(3.4 - 0.8 * (x.predicted() - 3.4)), v.is(-0.8 * v.predicted())];
    let bounce =
        drone.event("bounce")?.guard(x.predicted().ge(3.4))?.guard(v.predicted().ge(0.0))?;
    let bounce = bounce.reset(back)?.taken();

    let mut program = drone.program(steps)?;
    program.start([x.equals(0.0), y.equals(0.3), v.equals(0.0), w.equals(0.0)])?;
    program.goal([x.equals(3.2), y.equals(0.3), v.equals(0.0), w.equals(0.0)])?;
    let mut fuel = Affine::zero();
    for k in 0..=steps {
        let input = k.min(steps - 1);
        let thrust = [program.at(a, input)?, program.at(b, input)?];
        let speed = [program.at(v, k)?, program.at(w, k)?];
        for (name, vector, most) in [("speed", speed, SPEED), ("thrust", thrust.clone(), THRUST)] {
            program.add((format!("{name} disc"), k), norm(vector.clone()).le(most))?;
            for side in (0..8).filter(|_| octagon) {
                let (sin, cos) = (f64::from(side) * std::f64::consts::FRAC_PI_4).sin_cos();
                let along = cos * &vector[0] + sin * &vector[1];
                let within = most * std::f64::consts::FRAC_PI_8.cos();
                program.add((format!("{name} side {side}"), k), along.le(within))?;
            }
        }
        let (x, y) = (program.at(x, k)?, program.at(y, k)?);
        for (post, [left, right, below, above]) in POSTS.iter().enumerate() {
            let beside = either(x.le(*left)).or(x.ge(*right)).or(y.le(*below)).or(y.ge(*above));
            program.add((format!("post {post}"), k), beside)?;
        }
        if k < steps {
            let burnt = program.model_mut().continuous(("fuel", k), 0.0, THRUST)?;
            program.add(("fuel", k), norm(thrust).le(burnt))?;
            fuel += STEP * burnt;
        }
    }
    program.minimize(fuel.clone())?;
    match program.solve(&mut BranchAndBound::default()) {
        // A plan was replayed by code that does not know the program.
        Ok(plan) => Ok(Some((plan.solution.value(&fuel)?, plan.count(bounce)?))),
        Err(error) if matches!(error.kind(), ErrorKind::NoPlan { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for (name, octagon) in [("discs", false), ("octagons", true)] {
        let mut steps = 8;
        while plan(steps, octagon)?.is_none() {
            steps += 1;
        }
        println!("{name}: least time {:.2} s", steps as f64 * STEP);
        for steps in [steps, 14] {
            let (fuel, bounces) = plan(steps, octagon)?.ok_or("no plan")?;
            println!("{name}: {fuel:.4} m/s in {:.2} s, {bounces} bounces", steps as f64 * STEP);
        }
    }
    Ok(())
}
