//! Limits and interrupts: partial answers that say so.

use std::time::Duration;

use carom::explain::{
    ElasticOptions, ExplainOptions, ExplanationStatus, elastic_relaxation, infeasibility,
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
    let why = infeasibility(&pigeons(), &options, &mut BranchAndBound::default()).unwrap();
    assert_eq!(why.status(), ExplanationStatus::Unknown);
    assert!(why.groups().is_empty() && !why.is_infeasible());
    assert!(why.to_string().starts_with("it is not known whether `pigeons` has a solution"));

    let options = ElasticOptions::default().with_interrupt(&interrupt);
    let relaxed = elastic_relaxation(&pigeons(), &options, &mut BranchAndBound::default()).unwrap();
    assert_eq!(relaxed.termination(), Termination::Interrupted);
}

#[test]
fn no_time_claims_nothing() {
    let options = ExplainOptions::default().with_time_limit(Duration::ZERO);
    let mut solver = BranchAndBound::default();
    let why = infeasibility(&pigeons(), &options, &mut solver).unwrap();
    assert_eq!(why.status(), ExplanationStatus::Unknown);
    assert_eq!(why.solves(), 0);
    assert_eq!(solver.options().time_limit, None);
}

#[test]
fn a_limit_on_solves_leaves_a_set_that_is_not_called_irreducible() {
    let mut solver = BranchAndBound::default();
    for limit in [1, 3] {
        let options = ExplainOptions::default().with_solve_limit(limit);
        let why = infeasibility(&pigeons(), &options, &mut solver).unwrap();
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
    let why = infeasibility(&pigeons(), &ExplainOptions::default(), &mut solver).unwrap();
    assert_eq!(why.status(), ExplanationStatus::Unknown);
}

/// Counts solves, and may trigger an interrupt before one of them.
struct Counting {
    inner: BranchAndBound,
    solves: usize,
    interrupt: Option<(usize, Interrupt)>,
}

impl Solver for Counting {
    fn name(&self) -> &str {
        "counting"
    }

    fn options(&self) -> &Options {
        self.inner.options()
    }

    fn options_mut(&mut self) -> &mut Options {
        self.inner.options_mut()
    }

    fn solve_with(&mut self, model: &Model, control: &mut Control<'_>) -> Result<Solution, Error> {
        self.solves += 1;
        if let Some((at, interrupt)) = &self.interrupt
            && self.solves == *at
        {
            interrupt.trigger();
        }
        self.inner.solve_with(model, control)
    }
}

/// The solves reported are the solves made; an interrupt on the way leaves a contradictory set.
#[test]
fn solves_are_counted_and_interrupts_leave_valid_sets() {
    let count = |interrupt: Option<(usize, Interrupt)>| {
        let handle = interrupt.as_ref().map(|(_, handle)| handle.clone()).unwrap_or_default();
        let inner = BranchAndBound::default();
        let mut solver = Counting { inner, solves: 0, interrupt };
        let options = ExplainOptions::default().with_interrupt(&handle);
        let why = infeasibility(&pigeons(), &options, &mut solver).unwrap();
        assert_eq!(why.solves(), solver.solves);
        why
    };
    let whole = count(None);
    assert!(whole.is_irreducible());
    let solves = whole.solves();
    for at in 2..=solves.min(6) {
        let why = count(Some((at, Interrupt::new())));
        assert!(why.solves() <= at, "{why}");
        assert!(why.is_infeasible(), "{why}");
        // The statements named are contradictory all the same.
        let mut part = pigeons();
        let rows: Vec<_> = part.constraints().map(|row| (row.id(), row.name().clone())).collect();
        for (row, name) in rows {
            if !why.groups().iter().any(|group| group.statements().contains(&name)) {
                part.set_limits(row, -1e6, 1e6).unwrap();
            }
        }
        assert!(BranchAndBound::default().solve(&part).unwrap().is_infeasible());
    }
    assert_eq!(count(Some((1, Interrupt::new()))).status(), ExplanationStatus::Unknown);
}
