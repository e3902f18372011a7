//! Three tanks with two valves: levels follow a reference at the least sum of deviations.
//!
//! `cargo run --release --example three_tanks`
//!
//! Pumps fill the first two tanks, and each valve lets one of them run into the third. With each
//! pair of valve positions the tanks follow other linear dynamics. The figures are those of
//! `AffineModel.m`, `Threetank.hys` and `main.m` in github.com/A-Safi/ThreeTank-HYSDEL-MPC (commit
//! c9a0d3a9), rounded to nine digits, with flows in 1e-5 m³/s. That controller looks one step
//! ahead, this one HORIZON.

use carom::prelude::*;

const HORIZON: usize = 3;
const REFERENCE: [f64; 3] = [0.444, 0.35, 0.2]; // m

/// Levels to levels, flows to levels and constant part, with both valves open, the first, the
/// second, none.
fn flows() -> Result<[LinearSystem; 4], Error> {
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
    Ok([both, first, second, closed])
}

fn main() -> Result<(), Error> {
    let mut tanks = HybridSystem::new(1.0);
    let levels = ["level 1", "level 2", "level 3"].map(|name| tanks.state(name, 0.0, 0.66)); // m
    let levels = levels.into_iter().collect::<Result<Vec<_>, _>>()?;
    let pumps = [tanks.input("flow 1", 0.0, 2.0)?, tanks.input("flow 2", 0.0, 2.0)?]; // 1e-5 m³/s
    let mut price = Affine::zero();
    let valves =
        [("both open", 0.002), ("first open", 0.001), ("second open", 0.001), ("closed", 0.0)];
    for (flow, (name, cost)) in flows()?.into_iter().zip(valves) {
        price += cost * tanks.mode(name)?.flow(flow)?.taken();
    }

    let mut program = tanks.program(HORIZON)?;
    let mut cost = Affine::zero();
    for t in 0..=HORIZON {
        for (k, (level, wanted)) in levels.iter().zip(REFERENCE).enumerate() {
            cost += program.abs(&format!("off {k}"), level - wanted, t)?;
        }
    }
    for (k, flow) in pumps.iter().enumerate() {
        cost += program.sum_abs(&format!("pump {k}"), 1e-5 * flow)?;
    }
    program.minimize(cost + program.sum(price)?)?;

    let (mut solver, mut now) = (BranchAndBound::default(), vec![0.0; 3]);
    println!("step  level 1  level 2  level 3  valves       nodes");
    for step in 0..60 {
        for (level, value) in levels.iter().zip(&now) {
            let first = program.variable(*level, 0)?;
            program.model_mut().fix(first, *value)?;
        }
        let plan = program.solve(&mut solver)?;
        let valves = &plan.run.transitions("mode")?[0];
        if step % 5 == 0 {
            let nodes = plan.solution.statistics().nodes;
            let [a, b, c] = [now[0], now[1], now[2]];
            println!("{step:>4} {a:>8.3} {b:>8.3} {c:>8.3}  {valves:<12} {nodes:>5}");
        }
        now = levels.iter().map(|level| plan.value(level, 1)).collect::<Result<_, _>>()?;
    }
    Ok(())
}
