//! Plans, bounds and refutations beside enumeration and simulation.

use carom::hybrid::Discretization;
use carom::prelude::*;
use proptest::prelude::*;

use super::fields::{FIELDS, METHODS, STATES, declared, lead, rates, stated, step, value};
use crate::common::config;

/// The values that an input takes in programs that are enumerated.
const LEVELS: [f64; 3] = [-1.0, 0.0, 1.0];

const STEP: f64 = 0.2;

/// The best end of all sequences of modes and inputs: the first mode has the field, the second one
/// a field with the opposite input, and is possible only from `b` (or `a`) on. `None` if a
/// condition is too close to be told.
fn best(
    field: usize,
    method: Discretization,
    start: &[f64],
    steps: usize,
    gain: f64,
) -> Option<f64> {
    let last = start.len() - 1;
    let mut ends = vec![(start.to_vec(), 0.0)];
    for _ in 0..steps {
        let mut next = Vec::new();
        for (x, cost) in &ends {
            for u in LEVELS {
                for sign in [1.0, -1.0] {
                    if sign < 0.0 && x[last].abs() < 1e-4 {
                        return None;
                    }
                    if sign < 0.0 && x[last] < 0.0 {
                        continue;
                    }
                    let to = lead(method, &|x| value(field, x, sign * u), STEP, x);
                    if to.iter().any(|x| (x.abs() - 6.0).abs() < 1e-4) {
                        return None;
                    }
                    if to.iter().all(|x| x.abs() <= 6.0) {
                        next.push((to, cost + 0.1 * u * u));
                    }
                }
            }
        }
        ends = next;
    }
    let value = |(x, cost): &(Vec<f64>, f64)| gain * x[0].cos() + x[last] - cost;
    ends.iter().map(value).reduce(f64::max)
}

proptest! {
    #![proptest_config(config(24, "tests/regressions/nonlinear_claims.txt"))]

    #[test]
    fn optima_are_those_of_enumeration(
        field in 0..FIELDS,
        method in 0..METHODS.len(),
        start in prop::array::uniform3(-1.5..1.5_f64),
        steps in 1..3_usize,
        gain in -1.0..1.0_f64,
    ) {
        let method = METHODS[method].0;
        let start = &start[..STATES[field]];
        let mut own = declared(field, STEP, method);
        let mut system = HybridSystem::new(STEP);
        let names = ["a", "b", "c"];
        own.states =
            names[..start.len()].iter().map(|name| system.state(name, -6.0, 6.0).unwrap()).collect();
        let u = system.input_from("u", LEVELS).unwrap();
        let opposite = system.input_from("w", LEVELS).unwrap();
        system.discretization(method).unwrap();
        let last = start.len() - 1;
        system.invariant((u + opposite).equals(0.0)).unwrap();
        system.mode("first").unwrap().rates(rates(field, &own.states, u)).unwrap();
        system
            .mode("second")
            .unwrap()
            .rates(rates(field, &own.states, opposite))
            .unwrap()
            .guard(own.states[last].ge(0.0))
            .unwrap();
        let Some(expected) = best(field, method, start, steps, gain) else { return Ok(()) };
        let mut program = system.program(steps).unwrap();
        let at = own.states.iter().zip(start).map(|(x, value)| x.equals(*value));
        program.start(at.collect::<Vec<_>>()).unwrap();
        let effort = program.sum(u.square()).unwrap();
        let end = gain * own.states[0].cos() + own.states[last];
        let end = program.end(end).unwrap();
        program.maximize(end - 0.1 * effort).unwrap();
        let plan = program.solve(&mut BranchAndBound::default()).unwrap();
        prop_assert!(plan.solution.is_optimal());
        let found = plan.solution.objective().unwrap();
        prop_assert!((found - expected).abs() < 1e-4, "{found} instead of {expected}");
    }

    #[test]
    fn plans_satisfy_the_formulas(
        field in 0..FIELDS,
        method in 0..METHODS.len(),
        start in prop::array::uniform3(-1.5..1.5_f64),
        weight in -1.0..1.0_f64,
    ) {
        let method = METHODS[method].0;
        let own = stated(field, STEP, method);
        let (steps, last) = (2, STATES[field] - 1);
        let mut program = own.system.program(steps).unwrap();
        let at = own.states.iter().zip(&start).map(|(x, value)| x.equals(*value));
        program.start(at.collect::<Vec<_>>()).unwrap();
        program.maximize(program.end(weight * own.states[0] + own.states[last]).unwrap()).unwrap();
        let mut solver = BranchAndBound::default();
        solver.options_mut().node_limit = Some(200);
        let plan = match program.solve(&mut solver) {
            Ok(plan) => plan,
            Err(error) => {
                prop_assert!(matches!(error.kind(), carom::ErrorKind::NoPlan { .. }), "{error}");
                return Ok(());
            }
        };
        let values: Vec<Vec<f64>> = own.states.iter().map(|x| plan.values(*x).unwrap()).collect();
        let inputs = plan.values(own.input).unwrap();
        for (t, u) in inputs.iter().enumerate() {
            let sample = |t: usize| values.iter().map(|own| own[t]).collect::<Vec<f64>>();
            let (x, next) = (sample(t), sample(t + 1));
            let led = step(method, &|x| value(field, x, *u), STEP, &x, &next);
            for (own, expected) in next.iter().zip(&led) {
                prop_assert!((own - expected).abs() < 2e-6, "{own} instead of {expected}");
            }
        }
    }

    #[test]
    fn no_horizon_with_a_run_is_refuted(
        field in 0..FIELDS,
        method in 0..METHODS.len(),
        start in prop::array::uniform3(-1.5..1.5_f64),
        inputs in prop::collection::vec(-1.0..1.0_f64, 1..4),
    ) {
        let method = METHODS[method].0;
        let own = stated(field, STEP, method);
        let start = &start[..STATES[field]];
        let list: Vec<[f64; 1]> = inputs.iter().map(|u| [*u]).collect();
        let run = own.system.simulate(start, &list).unwrap();
        prop_assume!(run.is_complete());
        let at = own.states.iter().zip(start).map(|(x, value)| x.equals(*value));
        let end = own.states.iter().zip(run.last());
        let goal = end.map(|(x, value)| x.within(value - 1e-3, value + 1e-3));
        let (at, goal): (Vec<_>, Vec<_>) = (at.collect(), goal.collect());
        let mut solver = BranchAndBound::default();
        let found = own.system.shortest(at, goal, &mut solver).unwrap();
        let steps = found.steps.expect("a run leads to the goal");
        prop_assert!(steps <= inputs.len());
    }
}
