//! Three tanks with two valves: levels follow a reference at the least sum of deviations.
//!
//! `cargo run --release --example three_tanks`
//!
//! Pumps fill the first two tanks, and each valve lets one of them run into the third. With each
//! pair of valve positions the tanks follow other linear dynamics. The figures are those of
//! `AffineModel.m`, `Threetank.hys` and `main.m` in github.com/A-Safi/ThreeTank-HYSDEL-MPC (commit
//! c9a0d3a9), rounded to nine digits, with flows in 1e-5 m³/s. That controller looks one step
//! ahead, this one HORIZON.

use carom::hybrid::{
    Cost, Horizon, HybridSystem, IntoMatrix, LinearSystem, Region, Transition, When,
};
use carom::interval::Interval;
use carom::prelude::*;

const HORIZON: usize = 3;
const REFERENCE: [f64; 3] = [0.444, 0.35, 0.2]; // m

fn tanks() -> Result<HybridSystem, Error> {
    // Levels to levels, flows to levels, and constant part.
    let both = LinearSystem::new(
        [
            [0.969338678, 0.000478701215, 0.0300751081],
            [0.000478701215, 0.969338678, 0.0300751081],
            [0.0300751081, 0.0300751081, 0.933058914],
        ],
        [[8.00414018e-3, 1.31175326e-6], [1.31175326e-6, 8.00414018e-3], [1.24335545e-4; 2]],
        [-0.00819687799, -0.0126948813, 0.0204578679],
    )?;
    let first = LinearSystem::new(
        [[0.969343693, 0.0, 0.0305476709], [0.0, 1.0, 0.0], [0.0305476709, 0.0, 0.962555322]],
        [[8.00415048e-3, 0.0], [0.0, 8.13008130e-3], [1.25634698e-4, 0.0]],
        [-0.0116548403, 0.0, 0.0114937126],
    )?;
    let second = LinearSystem::new(
        [[1.0, 0.0, 0.0], [0.0, 0.969343693, 0.0305476709], [0.0, 0.0305476709, 0.962555322]],
        [[8.13008130e-3, 0.0], [0.0, 8.00415048e-3], [0.0, 1.25634698e-4]],
        [0.0, -0.0061816552, 0.00580026915],
    )?;
    let closed = LinearSystem::new(
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.992994613]],
        [[8.13008130e-3, 0.0], [0.0, 8.13008130e-3], [0.0, 0.0]],
        [0.0, 0.0, -1.19828989e-4],
    )?;
    let (level, flow) = (Interval::new(0.0, 0.66), Interval::new(0.0, 2.0)); // m, 1e-5 m³/s
    let tanks = ["level 1", "level 2", "level 3"];
    let system = tanks.iter().fold(HybridSystem::new(), |s, name| s.with_state(*name, level));
    Ok(system
        .with_input("flow 1", flow)
        .with_input("flow 2", flow)
        .with_transition(Transition::new("both open", both))
        .with_transition(Transition::new("first open", first))
        .with_transition(Transition::new("second open", second))
        .with_transition(Transition::new("closed", closed)))
}

fn main() -> Result<(), Error> {
    let system = tanks()?;
    let levels = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].into_matrix();
    let cost = Cost::one_norm(&levels, [[1e-5, 0.0], [0.0, 1e-5]])
        .with_terminal(&levels)
        .with_state_reference(REFERENCE.to_vec())
        .with_transition_cost("mode", "both open", 0.002)
        .with_transition_cost("mode", "first open", 0.001)
        .with_transition_cost("mode", "second open", 0.001);

    let (mut solver, mut now) = (BranchAndBound::default(), vec![0.0; 3]);
    println!("step  level 1  level 2  level 3  valves       nodes");
    for step in 0..60 {
        let mut model = Model::new("tanks");
        let program = system.write(&mut model, "", &Horizon::new(HORIZON, 1.0)?)?;
        program.require(&mut model, "start", &Region::point(&now), When::At(0))?;
        let cost = program.add_cost(&mut model, "cost", &cost)?;
        model.minimize(cost)?;
        let solution = solver.solve(&model)?;
        let (plan, _) = program.certified(&solution)?;
        let valves = &plan.transitions("mode")?[0];
        if step % 5 == 0 {
            let nodes = solution.statistics().nodes;
            let [a, b, c] = [now[0], now[1], now[2]];
            println!("{step:>4} {a:>8.3} {b:>8.3} {c:>8.3}  {valves:<12} {nodes:>5}");
        }
        now = plan.states.iter().map(|(_, values)| values[1]).collect();
    }
    Ok(())
}
