//! Explanations of models whose variables only rows bound: a part without these rows is no error.

use carom::explain::{ElasticOptions, ExplainOptions, elastic_relaxation, infeasibility};
use carom::prelude::*;

/// A walk from 0 by at most 1 a step, past an obstacle, to a goal.
fn walk(goal: [f64; 2]) -> Model {
    let mut model = Model::new("walk");
    let x = model.continuous_family("x", 6, -f64::INFINITY, f64::INFINITY).unwrap();
    let left = model.binary_family("left", 6).unwrap();
    model.add("start", x[0].equals(0.0)).unwrap();
    for k in 0..5 {
        model.add(("speed", k), (x[k + 1] - x[k]).within(-1.0, 1.0)).unwrap();
    }
    for k in 1..6 {
        model.add(("below", k), left[k].on().implies(x[k].le(1.5))).unwrap();
        model.add(("above", k), left[k].off().implies(x[k].ge(1.75))).unwrap();
    }
    model.add("goal", x[5].within(goal[0], goal[1])).unwrap();
    model
}

#[test]
fn the_rows_that_bound_are_part_of_the_reason() {
    let model = walk([6.5, 8.0]);
    let mut solver = BranchAndBound::default();
    assert!(solver.solve(&model).unwrap().is_infeasible());
    let why = infeasibility(&model, &ExplainOptions::default(), &mut solver).unwrap();
    let names: Vec<String> = why.groups().iter().map(|group| group.name().to_string()).collect();
    assert_eq!(names, ["start", "speed", "goal"]);
    assert!(why.is_irreducible());
}

#[test]
fn rows_that_give_bound_less() {
    let relaxed = elastic_relaxation(
        &walk([6.5, 8.0]),
        &ElasticOptions::default(),
        &mut BranchAndBound::default(),
    )
    .unwrap();
    assert!(relaxed.is_optimal());
    assert!((relaxed.cost().unwrap() - 1.5).abs() < 1e-5, "{relaxed}");
}

/// Without the goal, which lies in the obstacle, nothing bounds what the obstacle's indicators
/// need.
#[test]
fn parts_without_bounds_are_searched_all_the_same() {
    let model = walk([1.6, 1.7]);
    let why =
        infeasibility(&model, &ExplainOptions::default(), &mut BranchAndBound::default()).unwrap();
    let names: Vec<String> = why.groups().iter().map(|group| group.name().to_string()).collect();
    assert_eq!(names, ["goal", "below", "above"]);
    assert!(why.is_irreducible(), "{why}");
}
