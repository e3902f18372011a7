//! Controllers of nonlinear systems.

use carom::hybrid::{MoveSource, RecedingHorizon};
use carom::prelude::*;

#[test]
fn a_fallback_gives_the_inputs_without_functions() {
    let mut car = HybridSystem::new(0.4); // s
    let y = car.state("y", -1.0, 1.0).unwrap(); // m
    let heading = car.state("heading", -1.0, 1.0).unwrap(); // rad
    car.rates([y.is(heading.sin())]).unwrap();
    car.input("turn", -1.0, 1.0).unwrap(); // rad
    car.mode("drive").unwrap();
    let mut program = car.program(2).unwrap();
    program.goal([y.equals(0.0)]).unwrap();
    let mut solver = BranchAndBound::default();
    // No plan leads to the goal, because the heading stays.
    let mut controller =
        RecedingHorizon::new(program, &mut solver).unwrap().with_fallback(|_| vec![0.25]);
    let next = controller.step(&[0.5, 0.5]).unwrap();
    assert_eq!(next.source, MoveSource::Given);
    // The sine of the heading is an input before it.
    assert_eq!((next.input.len(), next.input[1]), (2, 0.25));
}

#[test]
fn a_controller_drives_a_nonlinear_plant() {
    // A car with constant speed returns to a line.
    let mut car = HybridSystem::new(0.4); // s
    let y = car.state("y", -2.0, 2.0).unwrap(); // m
    let heading = car.state("heading", -1.4, 1.4).unwrap(); // rad
    let turn = car.input("turn", -1.0, 1.0).unwrap(); // rad/s
    car.rates([y.is(heading.sin()), heading.is(turn)]).unwrap();
    car.mode("drive").unwrap();
    let mut program = car.program(4).unwrap();
    let cost = program.sum_abs("off", y).unwrap();
    let last = program.end(y).unwrap();
    let end = program.model_mut().absolute("end", last).unwrap();
    program.minimize(cost + 3.0 * end).unwrap();
    let mut solver = BranchAndBound::default();
    solver.options_mut().relative_gap = 0.05;
    let mut controller = RecedingHorizon::new(program, &mut solver).unwrap();
    // The plant is the motion, which is not that of the steps.
    let plant = |state: &[f64], next: &ControlMove| {
        let run = car.simulate(state, next)?;
        Ok(car.motion(&run.to_run())?.samples[1].clone())
    };
    let run = controller.run(&[0.8, 0.0], 10, plant).unwrap();
    let last = &run.states[10];
    assert!(last[0].abs() < 0.05, "{last:?}");
    assert!(run.moves.iter().all(|own| own.source == MoveSource::Optimal));
}
