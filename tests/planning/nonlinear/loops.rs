//! Controllers of nonlinear systems.

use carom::hybrid::{HybridProgram, MoveSource, RecedingHorizon};
use carom::model::Quadratic;
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

/// A car, and its program of some steps with a smooth cost: off a line, and not far along it.
fn car_to_a_line(steps: usize) -> HybridProgram {
    let mut car = HybridSystem::new(0.2); // s
    let x = car.state("x", -10.0, 10.0).unwrap(); // m
    let y = car.state("y", -3.0, 3.0).unwrap(); // m
    let heading = car.state("heading", -2.0, 2.0).unwrap(); // rad
    let speed = car.input("speed", 0.0, 2.0).unwrap(); // m/s
    let turn = car.input("turn", -1.5, 1.5).unwrap(); // rad/s
    let rates = [x.is(speed * heading.cos()), y.is(speed * heading.sin()), heading.is(turn)];
    car.mode("drive").unwrap().rates(rates).unwrap();
    let mut program = car.program(steps).unwrap();
    let mut cost = Quadratic::from(0.0);
    for t in 1..=steps {
        let at = |state: State| program.at(state, t).unwrap();
        cost = cost + 10.0 * at(y).square() + at(heading).square() - at(x);
    }
    program.minimize(cost).unwrap();
    program
}

#[test]
fn a_loop_improves_its_last_plan() {
    let mut local = BranchAndBound::default();
    // No box is searched: the last plan is improved, and there is no bound.
    local.options_mut().node_limit = Some(0);
    let mut controller = RecedingHorizon::new(car_to_a_line(8), &mut local).unwrap();
    let mut solver = BranchAndBound::default();
    solver.options_mut().relative_gap = 1e-3;
    let mut prover = RecedingHorizon::new(car_to_a_line(8), &mut solver).unwrap();
    let mut state = [-5.0, 1.5, 0.0];
    for _ in 0..6 {
        let (quick, proved) = (controller.step(&state).unwrap(), prover.step(&state).unwrap());
        assert_eq!((quick.nodes, quick.bound), (0, None));
        let (found, bound) = (quick.objective.unwrap(), proved.bound.unwrap());
        assert!(found <= bound + 2e-3 * bound.abs().max(1.0), "{found} {bound}");
        // The plant, in small steps.
        let (speed, turn) = (quick.input[0], quick.input[1]);
        for _ in 0..200 {
            state[0] += 0.001 * speed * state[2].cos();
            state[1] += 0.001 * speed * state[2].sin();
            state[2] += 0.001 * turn;
        }
    }
    assert!(state[1] < 0.3);
}
