//! Hybrid control programs of the field, as plain rows: a wall, a pendulum beside an elastic wall,
//! a flight among boxes, a puck between four walls, a cart with a pole between two; and dense
//! random programs. Statuses and optima were agreed on by other solvers (HiGHS and SCIP, for
//! quadratic costs CPLEX or Gurobi); here they are found, by turns, with one thread from the model
//! and with two from its MPS file, and verified row by row.

use crate::instances::generators;
use crate::instances::suite::{Truth, suite};
use carom::model::mps;
use carom::prelude::*;

/// Solves a model; `None` is infeasible.
fn check(model: &Model, threads: usize, optimum: Option<f64>) {
    let options = Options::default().with_threads(threads);
    let solution = BranchAndBound::new(options).solve(model).unwrap();
    let Some(optimum) = optimum else {
        assert!(solution.is_infeasible(), "{threads} threads: {:?}", solution.termination());
        return;
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

/// Every instance whose name begins so.
fn check_all(name: &str) {
    let instances = suite(&[name.to_owned()]);
    assert!(!instances.is_empty());
    for (k, (name, model, truth)) in instances.into_iter().enumerate() {
        println!("{name}");
        let optimum = match truth {
            Truth::Infeasible => None,
            Truth::Optimum(optimum) => Some(optimum),
        };
        let text = mps::write(&model).unwrap();
        let again = mps::read(&text).unwrap().model;
        assert!(mps::write(&again).unwrap() == text, "{name} as a file is another program");
        if k % 2 == 0 {
            check(&model, 1, optimum);
        } else {
            check(&again, 2, optimum);
        }
    }
}

#[test]
fn walls_with_steps_of_20_ms() {
    check_all("wall_dt02_");
}

#[test]
fn walls_with_steps_of_12_ms() {
    check_all("wall_dt0125_");
}

#[test]
fn plastic_walls_with_steps_of_5_ms() {
    check_all("wall_dt005_e0_");
}

#[test]
fn walls_with_steps_of_5_ms() {
    check_all("wall_dt005_e5_");
}

#[test]
fn a_wall_and_the_least_fuel() {
    check_all("wall_fuel_");
}

#[test]
fn pendulums() {
    check_all("pendulum_");
}

#[test]
fn carts_with_poles() {
    check_all("cartpole_");
}

#[test]
fn flights_among_boxes() {
    check_all("boxes_");
}

#[test]
fn pucks() {
    check_all("puck_");
}

#[test]
fn random_quadratic_programs() {
    check_all("miqp_");
}

/// Ms that presolve has tightened are for the search: what becomes an answer is solved on the rows
/// as they were. On the tightened ones this plan came out 3e-7 below its optimum.
#[test]
fn answers_do_not_lean_on_tightened_rows() {
    let model = generators::pendulum(40, [-0.05, 1.0], false);
    let objective = |presolve: bool| {
        let options = Options::default().with_presolve(presolve);
        BranchAndBound::new(options).solve(&model).unwrap().objective().unwrap()
    };
    let (tightened, plain) = (objective(true), objective(false));
    assert!((tightened - plain).abs() <= 1e-8 * plain, "{tightened} {plain}");
}
