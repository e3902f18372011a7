//! How many variables and rows systems get.

use carom::hybrid::{HybridSystem, LinearSystem};
use carom::interval::Interval;
use carom::prelude::*;
use carom_hybrid::internals::{Halfspace, SystemVariables, Transition};

fn written(system: &HybridSystem) -> (Model, SystemVariables) {
    let mut model = Model::new("shapes");
    let program = system.write(&mut model, "", 1).unwrap();
    (model, program)
}

fn line() -> HybridSystem {
    HybridSystem::new(0.1)
        .with_state("x", Interval::new(0.0, 15.0))
        .with_state("v", Interval::new(-2.5, 2.5))
        .with_input("u", Interval::new(-1.0, 1.0))
}

fn gear(strength: f64) -> LinearSystem {
    let b = [[0.005 * strength], [0.1 * strength]];
    LinearSystem::new([[1.0, 0.1], [0.0, 1.0]], b, [0.0, 0.0]).unwrap()
}

#[test]
fn gears_share_one_variable() {
    let fast = Halfspace::limit("the least speed", [0.0, -1.0], -0.4);
    let system = line()
        .with_transition(Transition::new("low", gear(0.6)))
        .with_transition(Transition::new("high", gear(1.5)).with_guard(fast));
    let (model, _) = written(&system);
    let names: Vec<String> = model.variables().map(|v| v.name().to_string()).collect();
    assert_eq!(names, ["x[0]", "x[1]", "v[0]", "v[1]", "u[0]", "high[0]", "change_v[0]"]);
    // The dynamics, the extra thrust in any gear; without a gear none, and the limit.
    assert_eq!((model.constraint_count(), model.indicator_count()), (4, 2));
}

#[test]
fn constant_changes_need_no_variable() {
    let push = |c: f64| LinearSystem::new([[1.0]], [[]], [c]).unwrap();
    let mut system = HybridSystem::new(0.1).with_state("x", Interval::new(0.0, 9.0));
    for (k, name) in ["rest", "walk", "run"].into_iter().enumerate() {
        system = system.with_transition(Transition::new(name, push(k as f64)));
    }
    let (model, _) = written(&system);
    assert!(model.to_string().contains("x[1] - walk[0] - 2 run[0] = 0"), "{model}");
    assert_eq!((model.constraint_count(), model.indicator_count()), (1, 0));
    assert_eq!(model.disjunction_count(), 1);
}

#[test]
fn one_transition_needs_no_binary() {
    let ahead = Halfspace::new("ahead", [-1.0, 0.0, 2.0], 0.0);
    let (model, program) =
        written(&line().with_transition(Transition::new("go", gear(1.0)).with_guard(ahead)));
    assert_eq!(program.taken("mode", "go", 0).unwrap(), None);
    assert_eq!(model.variable_count(), 5);
    assert!(model.to_string().contains("  go_ahead[0]: -x[0] + 2 u[0] <= 0"), "{model}");
}

#[test]
fn a_guard_of_all_transitions_is_stated_once() {
    let both = || Halfspace::new("not too fast", [1.0, 1.0], 9.0);
    let system = line()
        .with_transition(Transition::new("low", gear(0.6)).with_guard(both()))
        .with_transition(Transition::new("high", gear(1.5)).with_guard(both()));
    let (model, _) = written(&system);
    let text = model.to_string();
    assert_eq!(text.matches("not_too_fast").count(), 1, "{text}");
    assert!(text.contains("  low_not_too_fast[0]: x[0] + v[0] <= 9"), "{text}");
}

#[test]
fn limits_that_can_be_dropped_leave_nothing_out() {
    // The limit implies the guard, and both are stated.
    let slow = Halfspace::limit("slow", [0.0, 1.0], 1.0);
    let guard = Halfspace::new("moderate", [0.0, 1.0], 2.0);
    let high = Transition::new("high", gear(1.5)).with_guard(slow).with_guard(guard);
    let system = line().with_transition(Transition::new("low", gear(0.6))).with_transition(high);
    let text = written(&system).0.to_string();
    for row in ["  high_slow[0]: high[0] = 1 implies v[0] <= 1", "  high_moderate[0]: "] {
        assert!(text.contains(row), "{text}");
    }
}

#[test]
fn what_is_never_possible_is_infeasible() {
    // A guard without variables that fails.
    let never = Halfspace::new("never", [0.0, 0.0], -1.0);
    let system = line().with_transition(Transition::new("go", gear(1.0)).with_guard(never));
    let (model, _) = written(&system);
    assert!(BranchAndBound::default().solve(&model).unwrap().is_infeasible());
}

#[test]
fn ranges_of_inputs_may_be_set_by_transitions() {
    // A booster, in low gear only.
    let low = Transition::new("low", gear(0.6)).with_input_range("u", Interval::new(-1.0, 3.0));
    let system = line().with_transition(low).with_transition(Transition::new("high", gear(1.5)));
    let (mut model, program) = written(&system);
    let u = program.input("u").unwrap()[0];
    assert_eq!(model.variable_ref(u).unwrap().bounds(), Interval::new(-1.0, 3.0));
    assert!(!model.is_background("high_most_u[0]"));
    model.maximize(1.0 * u).unwrap();
    for (gear, most) in [("low", 3.0), ("high", 1.0)] {
        let mut model = model.clone();
        model.add("gear", program.taken("mode", gear, 0).unwrap().unwrap()).unwrap();
        let solution = BranchAndBound::default().solve(&model).unwrap();
        assert!((solution.objective().unwrap() - most).abs() < 1e-6);
    }
}
