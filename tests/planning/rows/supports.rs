//! Rows with an M for each transition: the same points and bounds that are never weaker, for random
//! systems; and costs that are tight however they are stated.

use carom::model::Method;
use carom::prelude::*;
use proptest::prelude::*;

use super::properties::{enumerated, set_cost, written};
use super::systems::plain;
use crate::common::config;

const REGRESSIONS: &str = "tests/regressions/supports.txt";

proptest! {
    #![proptest_config(config(150, REGRESSIONS))]

    #[test]
    fn a_step_has_the_points_of_its_transitions(
        plain in plain(5),
        cost in prop::collection::vec(-1.0..1.0_f64, 6),
    ) {
        let expected = enumerated(&plain, 1, &cost);
        let (mut model, program) = written(&plain, 1, None);
        set_cost(&mut model, &program, &cost);
        let solution = BranchAndBound::default().solve(&model).unwrap();
        match (expected, solution.objective()) {
            (None, None) => prop_assert!(solution.is_infeasible()),
            (Some(expected), Some(found)) => {
                prop_assert!((expected - found).abs() <= 1e-5, "{expected} {found}\n{model}");
            }
            (expected, found) => prop_assert!(false, "{expected:?} {found:?}\n{model}"),
        }
    }
}

proptest! {
    #![proptest_config(config(60, REGRESSIONS))]

    #[test]
    fn relaxations_are_never_weaker(
        plain in plain(5),
        cost in prop::collection::vec(-1.0..1.0_f64, 6),
        steps in 1..=3_usize,
    ) {
        let bound = |method: Option<Method>| {
            let (mut model, program) = written(&plain, steps, method);
            set_cost(&mut model, &program, &cost);
            let relaxed = carom::reformulate::relaxed(&model).unwrap();
            let solution = BranchAndBound::default().solve(&relaxed).unwrap();
            let value = solution.objective();
            assert!(value.is_some() || solution.is_infeasible(), "{solution:?}");
            value.unwrap_or(f64::INFINITY)
        };
        let (own, by_big_m) = (bound(None), bound(Some(Method::BigM)));
        prop_assert!(own >= by_big_m - 1e-6, "{own} {by_big_m}\n{plain:?}");
    }
}

/// A car with an engine that is off, on or starting, over 30 s; its fuel is an output of the
/// transitions, or a cost of handles.
fn car(by_output: bool) -> Result<HybridProgram, Error> {
    let steps = 30;
    let mut car = HybridSystem::new(1.0); // s
    let energy = car.state("energy", 0.0, 20.0)?; // kJ
    let power = car.input("power", 0.0, 10.0)?; // kW
    let need = |k: f64| 2.0 + (0.9 * k).sin() + (0.23 * k).cos();
    let need: Vec<f64> = (0..steps).map(|k| need(f64::from(k))).collect();
    let need = car.input("need", need.clone(), need)?; // kW
    car.next([energy.is(energy + power - need)])?;
    let fuel = car.output("fuel")?;
    let [off, on] = car.modes("engine", ["off", "on"])?;
    car.stay(off)?.guard(power.le(0.0))?;
    let stay = car.stay(on)?.guard(power.ge(3.0))?;
    if by_output {
        stay.output(fuel, 2.0 + power)?;
    }
    let mut start = car.switch(off, on)?.guard(power.ge(3.0))?;
    if by_output {
        start = start.output(fuel, 5.0 + power)?;
    }
    let start = start.taken();
    car.switch(on, off)?.guard(power.le(0.0))?;
    let runs = car.acting(on)?;
    let mut program = car.program(steps as usize)?;
    program.start([energy.equals(8.0), off.equals(1.0)])?;
    program.goal([energy.ge(8.0)])?;
    let cost = if by_output {
        program.sum(fuel)?
    } else {
        program.sum(2.0 * runs + power + 3.0 * start)?
    };
    program.minimize(cost)?;
    Ok(program)
}

#[test]
fn outputs_and_handles_state_a_cost_equally_well() -> Result<(), Error> {
    let mut bounds = Vec::new();
    for by_output in [true, false] {
        let program = car(by_output)?;
        let mut solver = BranchAndBound::default();
        let relaxed = solver.solve(&carom::reformulate::relaxed(program.model())?)?;
        bounds.push(relaxed.objective().unwrap());
        let mut solver = BranchAndBound::new(Options::default().with_node_limit(20_000));
        let plan = program.solve(&mut solver)?;
        assert!(plan.solution.is_optimal());
        let optimum = plan.solution.objective().unwrap();
        assert!((optimum - 86.455_273_77).abs() < 1e-3, "{optimum}");
    }
    assert!(bounds.iter().all(|bound| *bound > 76.3), "{bounds:?}");
    assert!((bounds[0] - bounds[1]).abs() < 0.01 * bounds[1], "{bounds:?}");
    Ok(())
}
