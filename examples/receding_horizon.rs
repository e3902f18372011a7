//! A pendulum next to an elastic wall, planned again after every step.
//!
//! `cargo run --release --example receding_horizon -- [FILE]`
//!
//! Each plan looks 20 steps ahead, and its first input is applied. The state is then disturbed a
//! little, 40 times. FILE gets a picture (SVG).

use carom::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (step, gap) = (0.01, 0.1);
    let mut pendulum = HybridSystem::new(step);
    let angle = pendulum.state("angle", -2.0 * gap, 2.0 * gap)?;
    let rate = pendulum.state("rate", -1.5, 1.5)?;
    let u = pendulum.input("u", -4.0, 4.0)?;
    let flow = |push: Affine| {
        [(angle, angle + step * rate), (rate, rate + step * (10.0 * angle + u + push))]
    };
    pendulum.mode("free")?.next(flow(0.0.into()))?.guard(angle.le(gap))?;
    pendulum.mode("pushed")?.next(flow(100.0 * (gap - angle)))?.guard(angle.ge(gap))?;

    let mut program = pendulum.program(20)?;
    let cost = program.sum(angle.square() + rate.square() + u.square())?;
    program.minimize(cost + 30.0 * program.end(angle.square() + rate.square())?)?;

    let mut solver = BranchAndBound::default();
    let mut controller = RecedingHorizon::new(program, &mut solver)?;
    let mut push = Disturbance::new([0.0..=0.0, -0.02..=0.02], 1);
    let plant = |state: &[f64], next: &Move| {
        let run = pendulum.simulate(state, &[&next.input])?;
        Ok(run.end()?.iter().zip(push.next_value()).map(|(x, w)| x + w).collect())
    };
    let run = controller.run(&[0.0, 0.8], 40, plant)?;
    println!("{}{run}", run.to_csv());
    if let Some(file) = std::env::args().nth(1) {
        std::fs::write(file, run.to_svg("A pendulum next to a wall, disturbed"))?;
    }
    Ok(())
}
