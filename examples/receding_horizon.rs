//! A pendulum next to an elastic wall, planned again after every step.
//!
//! `cargo run --release --example receding_horizon -- [FILE]`
//!
//! Each plan looks 20 steps ahead, and its first input is applied. The state is then disturbed a
//! little, 40 times. FILE gets a picture (SVG).

use carom::picture::{COLOURS, Chart, SOLID, WITH_COLLISION};
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
    let plant = |state: &[f64], next: &ControlMove| {
        let run = pendulum.simulate(state, next)?;
        Ok(run.end()?.iter().zip(push.next_value()).map(|(x, w)| x + w).collect())
    };
    let run = controller.run(&[0.0, 0.8], 40, plant)?;
    println!("{}{run}", run.to_csv());
    if let Some(file) = std::env::args().nth(1) {
        let labels = ["angle (rad)", "rate (rad/s)", "input (rad/s²)"];
        let mut charts = run.charts(step, "time (s)", &labels);
        let end = step * run.moves.len() as f64;
        let angles = || run.states.iter().map(|state| state[0]).enumerate();
        let wall = [[0.0, gap], [end, gap], [end, 3.0 * gap], [0.0, 3.0 * gap]];
        charts[0].area("", SOLID, 0.4, wall);
        charts[0].label("in the elastic wall", COLOURS[6], [0.02 * end, 1.5 * gap]);
        charts[0] = charts[0].clone().with_ranges((0.0..=end).into(), (-0.01..=0.22).into());
        charts[0].start("start", "black", [0.0, 0.0]);
        let most = angles()
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .map_or([0.0; 2], |(t, x)| [step * t as f64, x]);
        charts[0].label(format!("turns around at {:.2} rad", most[1]), COLOURS[0], most);
        let hit = angles().find(|(_, x)| *x >= gap).map_or(0, |(t, _)| t);
        let (at, rate) = ([step * hit as f64, run.states[hit][0]], run.states[hit][1]);
        charts[0].dots("", WITH_COLLISION[0], 4.5, [at]);
        charts[0].label(format!("touches the wall at {rate:.2} rad/s"), WITH_COLLISION[0], at);
        charts[1].line_of_width(1.0, "", COLOURS[6], [[0.0, 0.0], [end, 0.0]]);
        charts[2].line_of_width(1.0, "", COLOURS[6], [[0.0, 0.0], [end, 0.0]]);
        let title = "A pendulum next to an elastic wall, planned again after every step\nThe rate is \
                     disturbed by up to 0.02 rad/s in each of 40 steps.";
        std::fs::write(file, Chart::to_svg(&charts, title))?;
    }
    Ok(())
}
