//! What relaxations and prepared solves allocate. On its own, because it counts for the whole
//! process.

#[path = "instances/mod.rs"]
mod instances;

use std::alloc::System;

use carom::prelude::*;
use carom::solver::StopToken;
use carom_solver::internals::presolve::{Domain, Reduced, reduce};
use carom_solver::internals::program::Program;
use carom_solver::internals::relaxation::{
    Effort, InteriorPoint, Prover, Relaxation, RelaxationClaim,
};
use instances::generators::cartpole;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

fn counted<T>(work: impl FnOnce() -> T) -> (usize, T) {
    let region = Region::new(ALLOCATOR);
    let result = work();
    let change = region.change();
    (change.allocations + change.reallocations, result)
}

/// The root of a program whose parameters have these values.
fn root(model: &mut Model, values: &[f64]) -> Reduced {
    let parameters: Vec<Variable> = model.parameters().collect();
    for (parameter, &value) in parameters.into_iter().zip(values) {
        model.set_parameter(parameter, value).unwrap();
    }
    let program = Program::assemble(model).unwrap();
    reduce(&program, &Domain::new(&program)).unwrap()
}

/// What a relaxation of unchanged structure allocates: before any result was given back, once one
/// was, and the proof of its bound.
fn relaxations() -> [usize; 3] {
    let mut model = cartpole(8, None);
    let (one, two) = (root(&mut model, &[0.2, 0.0, 0.0, -1.0]), root(&mut model, &[0.1; 4]));
    assert_eq!((&one.rows.index, &one.rows.start), (&two.rows.index, &two.rows.start));
    let (mut method, mut prover) = (InteriorPoint::new(), Prover::default());
    let token = StopToken::default();
    let effort = Effort {
        iterations: 60,
        tolerance: 1e-8,
        refinements: 1,
        cutoff: f64::INFINITY,
        token: &token,
        warm: None,
    };
    let first = method.solve(&one, &effort);
    assert_eq!(first.claim, RelaxationClaim::Solved);
    prover.lower_bound(&one, &first.x, &first.y);
    let (before, second) = counted(|| method.solve(&two, &effort));
    assert_eq!(second.claim, RelaxationClaim::Solved);
    assert!(second.iterations > 3);
    method.reuse(first);
    let (after, third) = counted(|| method.solve(&two, &effort));
    assert_eq!((third.claim, &third.x, &third.y), (RelaxationClaim::Solved, &second.x, &second.y));
    assert!(third.warm.is_some());
    let (proof, bound) = counted(|| prover.lower_bound(&two, &second.x, &second.y));
    let value = two.objective(&second.x);
    assert!((bound - value).abs() <= 1e-6 * value.abs().max(1.0), "{bound} {value}");
    [before, after, proof]
}

/// Allocations per relaxation of prepared solves of nearly the same program, presolve, trees and
/// verification included.
fn prepared_solves() -> usize {
    let model = cartpole(20, None);
    let parameters: Vec<Variable> = model.parameters().collect();
    let mut solver = BranchAndBound::default();
    let mut prepared = solver.prepare(&model).unwrap();
    let (mut allocations, mut relaxations) = (0, 0);
    for step in 0..12 {
        let push = 0.01 * f64::from(step % 5);
        let state = [0.2 - push, 0.3 * push, 0.02 * push, -2.0 + 3.0 * push];
        let values: Vec<_> = parameters.iter().copied().zip(state).collect();
        let (count, solution) =
            counted(|| prepared.solve(&values, &mut Control::default()).unwrap());
        assert!(solution.is_optimal());
        // The first one fills the memory.
        if step > 0 {
            allocations += count;
            relaxations += solution.statistics().relaxations as usize;
        }
    }
    assert!(relaxations > 100, "{relaxations}");
    println!("{allocations} allocations, {relaxations} relaxations");
    allocations / relaxations
}

#[test]
fn allocations_are_few() {
    let [before, after, proof] = relaxations();
    // The result: its point, its multipliers, and what it leaves to its children.
    assert!(before <= 5, "{before}");
    assert_eq!([after, proof], [0, 0]);
    let each = prepared_solves();
    assert!(each <= 80, "{each} allocations per relaxation");
}
