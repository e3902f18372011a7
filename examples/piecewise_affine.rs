//! A piecewise-affine system under a controller with a receding horizon.
//!
//! `cargo run --release --example piecewise_affine [-- PICTURE.svg]`
//!
//! The rotation of Bemporad and Morari ("Control of systems integrating logic, dynamics, and
//! constraints", Automatica 35, 1999) turns by 60° a step: to the left where x1 >= 0, to the right
//! where x1 <= 0. Each move plans ten steps, applies the first input, and simulates the system.

use std::f64::consts::FRAC_PI_3;

use carom::interval::Interval;
use carom::picture::{COLOURS, Chart, GOAL_COLOUR};
use carom::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut system = HybridSystem::new(1.0);
    let [x1, x2] = [system.state("x1", -10.0, 10.0)?, system.state("x2", -10.0, 10.0)?];
    let u = system.input("u", -1.0, 1.0)?;
    for (name, angle, half) in
        [("right half", FRAC_PI_3, x1.ge(0.0)), ("left half", -FRAC_PI_3, x1.le(0.0))]
    {
        let (s, c) = (0.8 * angle.sin(), 0.8 * angle.cos());
        system
            .mode(name)?
            .next([x1.is(c * x1 - s * x2), x2.is(s * x1 + c * x2 + u)])?
            .guard(half)?;
    }

    let mut program = system.program(10)?;
    let cost = program.sum(x1.square() + x2.square() + u.square())?;
    program.minimize(cost + program.end(x1.square() + x2.square())?)?;
    let first = [program.variable(x1, 0)?, program.variable(x2, 0)?];

    let (mut solver, mut states) = (BranchAndBound::default(), vec![vec![5.0, 5.0]]);
    println!("step      x1      x2       u      cost  nodes  mode");
    for step in 0..15 {
        let now = states[step].clone();
        for (variable, value) in first.into_iter().zip(&now) {
            program.model_mut().fix(variable, *value)?;
        }
        let plan = program.solve(&mut solver)?;
        let (u, mode) = (plan.value(u, 0)?, &plan.run.transitions("mode")?[0]);
        let cost = plan.solution.objective().unwrap_or(f64::NAN);
        let nodes = plan.solution.statistics().nodes;
        println!(
            "{step:>4} {:>7.3} {:>7.3} {u:>7.3} {cost:>9.5} {nodes:>6}  {mode}",
            now[0], now[1]
        );
        states.push(system.simulate(&now, &[[u]])?.end()?);
    }
    if let Some(path) = std::env::args().nth(1) {
        draw(&states, &path)?;
        println!("wrote {path}");
    }
    Ok(())
}

/// The states in their plane; the modes meet at x1 = 0.
fn draw(states: &[Vec<f64>], path: &str) -> Result<(), Box<dyn std::error::Error>> {
    let (x1, x2) = (Interval::new(-2.6, 5.8), Interval::new(-0.8, 5.8));
    let mut chart = Chart::new("x1 (no unit)", "x2 (no unit)")
        .with_size(640.0, 520.0)
        .with_equal_axes()
        .with_ranges(x1, x2);
    let half = |edge: f64| [[0.0, x2.lower], [edge, x2.lower], [edge, x2.upper], [0.0, x2.upper]];
    chart.area("", COLOURS[5], 0.12, half(x1.lower));
    chart.area("", COLOURS[4], 0.12, half(x1.upper));
    chart.label("x1 <= 0: turns right", COLOURS[0], [-1.4, 5.4]);
    chart.label("x1 >= 0: turns left", COLOURS[1], [1.4, 5.4]);
    let points = || states.iter().map(|state| [state[0], state[1]]);
    for (from, to) in points().zip(points().skip(1)) {
        chart.arrow("black", from, to);
    }
    for (step, at) in points().enumerate() {
        match step {
            0 => chart.start("start: (5, 5)", "black", at),
            _ => chart.dots("", "black", 3.0, [at]),
        }
        if (1..=5).contains(&step) {
            chart.label(format!("step {step}"), "black", at);
        }
    }
    chart.goal("goal: the origin", GOAL_COLOUR, [0.0, 0.0]);
    let last = states.last().map_or(0.0, |state| state[0].hypot(state[1]));
    let title = format!(
        "A rotation that changes its sense, under a receding horizon\n{} steps, then {last:.4} from \
         the origin.",
        states.len() - 1
    );
    std::fs::write(path, Chart::to_svg(&[chart], &title))?;
    Ok(())
}
