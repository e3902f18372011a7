//! A pendulum next to an elastic wall, planned again after every step.
//!
//! `cargo run --release --example receding_horizon -- [FILE]`
//!
//! Each plan looks 20 steps ahead, and its first input is applied. The state is then disturbed a
//! little, 40 times. FILE gets a picture (SVG).

use carom::hybrid::{
    Cost, Disturbance, Halfspace, Horizon, HybridSystem, LinearSystem, Move, RecedingHorizon,
    Transition,
};
use carom::interval::Interval;
use carom::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (step, gap) = (0.01, 0.1);
    let flow = |spring: f64| {
        let a = [[1.0, step], [10.0 * step - step * spring, 1.0]];
        LinearSystem::new(a, [[0.0], [step]], [0.0, step * spring * gap])
    };
    let apart = Halfspace::new("apart", [1.0, 0.0], gap);
    let touching = Halfspace::new("touching", [-1.0, 0.0], -gap);
    let pendulum = HybridSystem::new()
        .with_state("angle", Interval::new(-2.0 * gap, 2.0 * gap))
        .with_state("rate", Interval::new(-1.5, 1.5))
        .with_input("u", Interval::new(-4.0, 4.0))
        .with_transition(Transition::new("free", flow(0.0)?).with_guard(apart))
        .with_transition(Transition::new("pushed", flow(100.0)?).with_guard(touching));

    let mut model = Model::new("pendulum");
    let program = pendulum.write(&mut model, "", &Horizon::new(20, step)?)?;
    let unit = [[1.0, 0.0], [0.0, 1.0]];
    let cost = Cost::quadratic(unit, [[1.0]]).with_terminal([[30.0, 0.0], [0.0, 30.0]]);
    let cost = program.add_cost(&mut model, "cost", &cost)?;
    model.minimize(cost)?;

    let mut solver = BranchAndBound::default();
    let mut controller = RecedingHorizon::new(&program, model, &mut solver)?;
    let mut push = Disturbance::new(vec![Interval::new(0.0, 0.0), Interval::new(-0.02, 0.02)], 1);
    let plant = |state: &[f64], next: &Move| {
        let run = pendulum.simulate(state, &[&next.input])?;
        Ok(run.last().iter().zip(push.next_value()).map(|(x, w)| x + w).collect())
    };
    let run = controller.run(&[0.0, 0.8], 40, plant)?;
    println!("{}{run}", run.to_csv());
    if let Some(file) = std::env::args().nth(1) {
        std::fs::write(file, run.to_svg("A pendulum next to a wall, disturbed"))?;
    }
    Ok(())
}
