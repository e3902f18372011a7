//! Hybrid control programs of the field, as plain rows: a wall, a pendulum beside an elastic wall, a
//! flight among boxes, a puck between four walls. Statuses and optima were agreed on by other
//! solvers (HiGHS and SCIP, for quadratic costs CPLEX or Gurobi); here they are found with one and
//! with two threads, from the model and from its MPS file, and verified row by row.

mod generators;

use carom::model::mps;
use carom::prelude::*;
use generators::{boxes, pendulum, puck, wall};

/// Solves a model in both ways; `None` is infeasible.
fn check(model: &Model, optimum: Option<f64>) {
    let text = mps::write(model).unwrap();
    let again = mps::read(&text).unwrap();
    for (model, threads) in [(model, 1), (&again, 2)] {
        let options = Options::default().with_threads(threads);
        let solution = BranchAndBound::new(options).solve(model).unwrap();
        let Some(optimum) = optimum else {
            assert!(solution.is_infeasible(), "{threads} threads: {:?}", solution.termination());
            continue;
        };
        assert!(solution.is_optimal(), "{threads} threads: {:?}", solution.termination());
        let found = solution.objective().unwrap();
        let scale = optimum.abs().max(1.0);
        assert!((found - optimum).abs() <= 2e-6 * scale, "{found} instead of {optimum}");
        assert!(solution.bound() <= found && found - solution.bound() <= 2e-6 * scale);
        let point = solution.point().unwrap().as_slice();
        for row in model.constraints() {
            let sum: f64 = row.terms().iter().map(|&(v, a)| a * point[v.index()]).sum();
            let limits = row.limits();
            assert!(sum >= limits.lower - 1e-6 && sum <= limits.upper + 1e-6, "{}", row.name());
        }
        for variable in model.variables().filter(|v| v.kind().is_integral()) {
            let value = point[variable.id().index()];
            assert_eq!(value, value.round());
        }
    }
}

#[test]
fn walls_with_steps_of_20_ms() {
    check(&wall(122, 0.02, 0.5, false), None);
    check(&wall(123, 0.02, 0.5, false), Some(0.0));
}

#[test]
fn walls_with_steps_of_12_ms() {
    check(&wall(194, 0.0125, 0.5, false), None);
    check(&wall(195, 0.0125, 0.5, false), Some(0.0));
}

#[test]
fn plastic_walls_with_steps_of_5_ms() {
    check(&wall(456, 0.005, 0.0, false), None);
    check(&wall(457, 0.005, 0.0, false), Some(0.0));
}

#[test]
fn walls_with_steps_of_5_ms() {
    check(&wall(484, 0.005, 0.5, false), None);
    check(&wall(485, 0.005, 0.5, false), Some(0.0));
}

#[test]
fn a_wall_and_the_least_fuel() {
    check(&wall(60, 0.05, 0.5, true), Some(33.605465));
}

#[test]
fn pendulums() {
    check(&pendulum(20, [0.0, 0.8]), Some(210.85804));
    check(&pendulum(40, [-0.05, 1.0]), Some(28.912257));
}

#[test]
fn flights_among_boxes() {
    check(&boxes(20, 4, false), Some(8.6969115));
    check(&boxes(20, 4, true), Some(4.1085127));
    check(&boxes(30, 4, false), Some(5.6235617));
    check(&boxes(30, 3, true), Some(1.2218645));
}

#[test]
fn pucks() {
    check(&puck(15, 0.33), Some(8.0782823));
    check(&puck(25, 0.2), Some(12.428306));
}
