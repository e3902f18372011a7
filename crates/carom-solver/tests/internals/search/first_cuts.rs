//! What is known when the root's cones are first cut off.

use carom::model::norm;
use carom::prelude::*;
use carom::solver::StopToken;
use carom_solver::internals::branch_and_bound::search_tightened;
use carom_solver::internals::presolve::Reduced;
use carom_solver::internals::program::Program;
use carom_solver::internals::relaxation::{
    CascadePool, Effort, MethodCascade, Relaxation, RelaxationClaim, RelaxationResult,
};
use carom_solver::internals::search::SolveTask;

/// A method that interrupts the solve at its first relaxation. Programs with cones have their own
/// methods.
struct Interrupting(Interrupt);

impl Relaxation for Interrupting {
    fn solve(&mut self, program: &Reduced, _: &Effort<'_>) -> RelaxationResult {
        self.0.trigger();
        RelaxationResult {
            claim: RelaxationClaim::Unknown,
            x: vec![0.0; program.columns.len()],
            y: vec![0.0; program.rows.len()],
            iterations: 0,
            warm: None,
        }
    }
}

/// The farthest point of a disc in a half-plane, with a price for each of two halves.
fn disc() -> Program {
    let mut model = Model::new("disc");
    let x = model.continuous("x", -9.0, 9.0).unwrap();
    let y = model.continuous("y", -9.0, 9.0).unwrap();
    let far = model.binary("far").unwrap();
    model.add("disc", norm([x, y]).le(5.0)).unwrap();
    model.add("far", (x - 4.5 * far).le(4.0)).unwrap();
    model.minimize(0.3 * far - x - y).unwrap();
    Program::assemble(&model).unwrap()
}

#[test]
fn an_interrupt_keeps_the_bound_of_the_last_relaxation() {
    let (program, options, interrupt) = (disc(), Options::default(), Interrupt::new());
    let token = &StopToken::new(None, &interrupt);
    let cascades = CascadePool::with_cascades(&options, move || {
        MethodCascade::with_method(Box::new(Interrupting(interrupt.clone())))
    });
    let accept = |_: &[f64]| true;
    let found = search_tightened(SolveTask::new(&program, &accept, &cascades, &options, token));
    assert_eq!(found.termination, Termination::Interrupted);
    // The relaxed optimum is -5 sqrt(2) and a part of the price; the optimum is -7.
    assert!((-7.1..=-7.0 + 1e-6).contains(&found.bound), "{}", found.bound);
}
