//! A hybrid system, stated once: an elevator with two gears that must stop at a floor.
//!
//! `cargo run --release --example elevator [-- PICTURE.svg]`
//!
//! High gear is stronger but allowed only above 0.4 m/s. The gear is chosen in each step. How soon
//! can the cabin be at rest at 12 m? Rows, reach sets and the check of the plan all come from one
//! statement of the system.

use std::error::Error as StdError;

use carom::hybrid::{
    Halfspace, Horizon, HybridSystem, LinearSystem, Region, ShortestOptions, Transition,
};
use carom::interval::Interval;
use carom::prelude::*;

const TIME_STEP: f64 = 0.1; // s

fn elevator() -> Result<HybridSystem, Error> {
    let integrator = [[0.0, 1.0], [0.0, 0.0]];
    let gear = |strength: f64| {
        // m/s² at full input
        LinearSystem::zero_order_hold(integrator, [[0.0], [strength]], [0.0, 0.0], TIME_STEP)
    };
    let fast = Halfspace::limit("the least speed of high gear", [0.0, -1.0], -0.4); // m/s
    Ok(HybridSystem::new()
        .with_state("x", Interval::new(0.0, 15.0)) // m
        .with_state("v", Interval::new(-2.5, 2.5)) // m/s
        .with_input("u", Interval::new(-1.0, 1.0))
        .with_transition(Transition::new("low gear", gear(0.6)?))
        .with_transition(Transition::new("high gear", gear(1.5)?).with_guard(fast)))
}

fn main() -> Result<(), Box<dyn StdError>> {
    let (start, goal) = (Region::point([0.0, 0.0]), Region::point([12.0, 0.0]));
    let (options, mut solver) = (ShortestOptions::default(), BranchAndBound::default());
    let system = elevator()?;
    let found = system.shortest_run(&start, &goal, TIME_STEP, &options, &mut solver)?;
    let mut search = found.search;
    let (Some(steps), Some(tube), Some(run)) = (search.steps, &search.tube, &found.run) else {
        return Err(format!("no horizon found: {}", search.status).into());
    };
    println!("shortest horizon: {steps} steps of {TIME_STEP} s ({})", search.status);
    let solves = search.attempts.iter().filter(|attempt| attempt.is_solve()).count();
    println!("refuted: {} horizons, with {solves} solves in all", search.refutations().count());
    let mut model = Model::new("elevator");
    let program = system.write(&mut model, "", &Horizon::new(steps, TIME_STEP)?)?;
    println!("presolve: {}", tube.tighten(&mut model, &program.horizon_variables())?);
    println!("waiting: {}", found.waiting.reason());
    let high = run.transitions("mode")?.iter().filter(|name| *name == "high gear").count();
    println!("the plan takes high gear in {high} of {steps} steps");

    if let Some(path) = std::env::args().nth(1) {
        std::fs::write(&path, tube.to_svg(0, 1, Some(run))?)?;
        println!("wrote {path}");
    }
    if let Some(sets) = &mut search.sets
        && let Some(reason) = sets.explain(steps - 1)?
    {
        println!("{reason}");
    }
    Ok(())
}
