//! Programs whose later steps are relaxed: their bounds, their first moves, and closed loops.

use carom::ErrorKind;
use carom::hybrid::{HybridProgram, MoveSource, When};
use carom::prelude::*;
use carom::tolerance::RELATIVE_GAP;

/// A room of which a heater is off, warms or boosts, and a window that is shut or open.
fn room() -> Result<(HybridSystem, State), Error> {
    let mut room = HybridSystem::new(600.0); // s
    let t = room.state("t", 5.0, 30.0)?; // °C
    let power = room.input_from("power", [0.0, 1.0, 2.5])?;
    let heat = room.input("heat", 0.0, 1.0)?;
    room.mode_of("window", "shut")?.next([t.is(0.95 * t + 0.5 + power + heat)])?;
    room.mode_of("window", "open")?.next([t.is(0.8 * t + 1.0 + power)])?.guard(t.ge(15.0))?;
    Ok((room, t))
}

fn program(steps: usize, start: Option<f64>) -> Result<HybridProgram, Error> {
    let (room, t) = room()?;
    let mut program = room.program(steps)?;
    program.minimize(program.sum((t - 19.3).square())?)?;
    if let Some(start) = start {
        program.require("start", [t.equals(start)], When::At(0))?;
    }
    Ok(program)
}

#[test]
fn bounds_rise_with_the_horizon_to_the_optimum() {
    for start in [6.0, 15.2, 18.0, 24.0] {
        let whole = program(6, Some(start)).unwrap();
        let best = whole.solve(&mut BranchAndBound::default()).unwrap().solution;
        let best = best.objective().unwrap();
        // Solves end within a relative gap.
        let gap = 2.0 * RELATIVE_GAP * best.max(1.0);
        let mut last = f64::NEG_INFINITY;
        for steps in 1..=6 {
            let mut own = whole.clone();
            own.set_integer_horizon(steps).unwrap();
            let found = BranchAndBound::default().solve(own.model()).unwrap();
            assert_eq!(found.relaxed().is_empty(), steps == 6);
            let bound = found.bound();
            assert!(last - gap <= bound && bound <= best + 1e-6, "{last} {bound} {best}");
            last = bound;
        }
        assert!((last - best).abs() <= gap, "{last} {best}");
    }
}

#[test]
fn a_loop_moves_by_the_first_steps() {
    let (room, _) = room().unwrap();
    let mut own = program(8, None).unwrap();
    own.set_integer_horizon(2).unwrap();
    let mut solver = BranchAndBound::default();
    let mut controller = RecedingHorizon::new(own, &mut solver).unwrap();
    let plant = |state: &[f64], next: &ControlMove| room.simulate(state, next)?.end();
    let run = controller.run(&[6.0], 15, plant).unwrap();
    assert_eq!(run.count(MoveSource::IntegerHorizon), 15);
    for (t, next) in run.moves.iter().enumerate() {
        assert_eq!(next.is_admissible, Some(true));
        assert_eq!((next.states.len(), next.inputs.len(), next.objective), (3, 2, None));
        assert!(next.transition("window").is_some());
        // The state that was foreseen is the one that comes.
        assert!((next.states[1][0] - run.states[t + 1][0]).abs() < 1e-6);
        // The bound is one on every plan of the whole program.
        let whole = program(8, Some(next.state[0])).unwrap();
        let best = whole.solve(&mut BranchAndBound::default()).unwrap().solution;
        assert!(next.bound.unwrap() <= best.objective().unwrap() + 1e-6);
    }
    assert!((run.states[15][0] - 19.3).abs() < 1.0, "{:?}", run.states);
}

#[test]
fn programs_of_each_step_may_have_one_too() {
    let (room, _) = room().unwrap();
    let build = |_| {
        let mut own = program(5, None)?;
        own.set_integer_horizon(1)?;
        Ok(own)
    };
    let mut solver = BranchAndBound::default();
    let mut controller = RecedingHorizon::moving(build, &mut solver);
    let plant = |state: &[f64], next: &ControlMove| room.simulate(state, next)?.end();
    let run = controller.run(&[12.0], 6, plant).unwrap();
    assert_eq!(run.count(MoveSource::IntegerHorizon), 6);
    assert!(run.moves.iter().all(|next| next.is_admissible == Some(true)));
}

#[test]
fn plans_of_relaxed_programs_are_refused() {
    let mut own = program(4, Some(18.0)).unwrap();
    for (steps, least) in [(0, 1.0), (5, 1.0)] {
        let error = own.set_integer_horizon(steps).unwrap_err();
        assert!(
            matches!(error.kind(), ErrorKind::OutOfRange { lower: Some(lower), upper: Some(4.0), .. } if *lower == least),
            "{error}"
        );
    }
    own.set_integer_horizon(2).unwrap();
    // What is relaxed does not become whole again.
    assert!(own.set_integer_horizon(3).is_err());
    let solution = BranchAndBound::default().solve(own.model()).unwrap();
    for error in
        [own.plan(&solution).unwrap_err(), own.solve(&mut BranchAndBound::default()).unwrap_err()]
    {
        assert!(error.to_string().contains("integer horizon of 2 steps"), "{error}");
    }
}
