//! Limits and interrupts: partial answers that say so.

use std::time::Duration;

use carom::explain::{
    ElasticOptions, ExplainOptions, ExplanationStatus, infeasibility, relaxation,
};
use carom::prelude::*;

/// Pigeons in too few holes: infeasible, and not by propagation.
fn pigeons() -> Model {
    let (pigeons, holes) = (6, 5);
    let mut model = Model::new("pigeons");
    let sits: Vec<_> =
        (0..pigeons).map(|p| model.binary_family(&format!("sits_{p}"), holes).unwrap()).collect();
    for (p, sits) in sits.iter().enumerate() {
        model.add(("somewhere", p), sits.iter().sum::<Affine>().ge(1.0)).unwrap();
    }
    for hole in 0..holes {
        let here: Vec<Variable> = sits.iter().map(|sits| sits[hole]).collect();
        for p in 0..pigeons {
            for q in 0..p {
                let name = format!("apart_{p}_{q}");
                model.add((name, hole), (here[p] + here[q]).le(1.0)).unwrap();
            }
        }
    }
    model
}

#[test]
fn a_triggered_interrupt_claims_nothing() {
    let interrupt = Interrupt::new();
    interrupt.trigger();
    let options = ExplainOptions::default().with_interrupt(&interrupt);
    let why = infeasibility(&pigeons(), &mut BranchAndBound::default(), &options).unwrap();
    assert_eq!(why.status(), ExplanationStatus::Unknown);
    assert!(why.groups().is_empty() && !why.is_infeasible());
    assert!(why.to_string().starts_with("it is not known whether `pigeons` has a solution"));

    let options = ElasticOptions::default().with_interrupt(&interrupt);
    let relaxed = relaxation(&pigeons(), &mut BranchAndBound::default(), &options).unwrap();
    assert_eq!(relaxed.termination(), Termination::Interrupted);
}

#[test]
fn no_time_claims_nothing() {
    let options = ExplainOptions::default().with_time_limit(Duration::ZERO);
    let mut solver = BranchAndBound::default();
    let why = infeasibility(&pigeons(), &mut solver, &options).unwrap();
    assert_eq!(why.status(), ExplanationStatus::Unknown);
    assert_eq!(why.solves(), 0);
    assert_eq!(solver.options().time_limit, None);
}

#[test]
fn a_limit_on_solves_leaves_a_set_that_is_not_called_irreducible() {
    let mut solver = BranchAndBound::default();
    for limit in [1, 3] {
        let options = ExplainOptions::default().with_solve_limit(limit);
        let why = infeasibility(&pigeons(), &mut solver, &options).unwrap();
        assert_eq!(why.solves(), limit);
        assert_eq!(why.status(), ExplanationStatus::Reducible);
        assert!(why.is_infeasible() && !why.groups().is_empty());
        assert!(why.to_string().contains("a limit came before"));
    }
}

/// Solves that stop at the solver's own node limit leave their families in the set.
#[test]
fn a_node_limit_of_the_solver_is_respected() {
    let mut solver = BranchAndBound::new(Options::default().with_node_limit(0));
    let why = infeasibility(&pigeons(), &mut solver, &ExplainOptions::default()).unwrap();
    assert_eq!(why.status(), ExplanationStatus::Unknown);
}
