//! A piecewise-affine system under a controller with a receding horizon.
//!
//! `cargo run --release --example piecewise_affine [-- PICTURE.svg]`
//!
//! The rotation of Bemporad and Morari ("Control of systems integrating logic, dynamics, and
//! constraints", Automatica 35, 1999) turns by 60° a step: to the left where x1 >= 0, to the right
//! where x1 <= 0. Each move plans ten steps, applies the first input, and simulates the system.

use std::error::Error as StdError;
use std::f64::consts::FRAC_PI_3;

use carom::hybrid::{Cost, Horizon, HybridSystem, LinearSystem};
use carom::interval::Interval;
use carom::picture::{COLOURS, Chart};
use carom::prelude::*;

fn rotation() -> Result<HybridSystem, Error> {
    let turn = |angle: f64| {
        let (s, c) = angle.sin_cos();
        LinearSystem::new([[0.8 * c, -0.8 * s], [0.8 * s, 0.8 * c]], [[0.0], [1.0]], [0.0, 0.0])
    };
    let domain = Interval::new(-10.0, 10.0);
    HybridSystem::piecewise_affine(
        [("x1", domain), ("x2", domain)],
        [("u", Interval::new(-1.0, 1.0))],
        [
            ("right half", turn(FRAC_PI_3)?, [[-1.0, 0.0]], [0.0]),
            ("left half", turn(-FRAC_PI_3)?, [[1.0, 0.0]], [0.0]),
        ],
    )
}

fn main() -> Result<(), Box<dyn StdError>> {
    let system = rotation()?;
    let mut model = Model::new("rotation");
    let program = system.write(&mut model, "", &Horizon::new(10, 1.0)?)?;
    let identity = [[1.0, 0.0], [0.0, 1.0]];
    let cost = Cost::quadratic(identity, [[1.0]]).with_terminal(identity);
    let cost = program.add_cost(&mut model, "cost", &cost)?;
    model.minimize(cost)?;

    let (mut solver, mut states) = (BranchAndBound::default(), vec![vec![5.0, 5.0]]);
    println!("step      x1      x2       u      cost  nodes  mode");
    for step in 0..15 {
        let now = states[step].clone();
        for (family, value) in program.states().iter().zip(&now) {
            model.fix(family[0], *value)?;
        }
        let solution = solver.solve(&model)?;
        let (plan, _) = program.certified(&solution)?;
        let (u, mode) = (plan.input("u")?[0], &plan.transitions("mode")?[0]);
        let cost = solution.objective().unwrap_or(f64::NAN);
        let nodes = solution.statistics().nodes;
        println!(
            "{step:>4} {:>7.3} {:>7.3} {u:>7.3} {cost:>9.5} {nodes:>6}  {mode}",
            now[0], now[1]
        );
        states.push(system.simulate(&now, &[[u]])?.last().to_vec());
    }
    if let Some(path) = std::env::args().nth(1) {
        draw(&states, &path)?;
        println!("wrote {path}");
    }
    Ok(())
}

/// The states in their plane; the modes meet at x1 = 0.
fn draw(states: &[Vec<f64>], path: &str) -> Result<(), Box<dyn StdError>> {
    let range = Interval::new(-6.0, 6.0);
    let mut chart = Chart::new("x1", "x2").with_size(480.0, 480.0).with_ranges(range, range);
    let points = || states.iter().map(|state| [state[0], state[1]]);
    chart.line("where the modes meet", COLOURS[1], [[0.0, -6.0], [0.0, 6.0]]);
    chart.line("the states of 15 steps", "black", points());
    chart.dots("", COLOURS[0], 3.0, points());
    std::fs::write(path, Chart::to_svg(&[chart], ""))?;
    Ok(())
}
