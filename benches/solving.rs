//! Speed of the solving tower's parts on the paper's program and on quadratic ones: lowering and
//! assembly, propagation, probing, reduction, one relaxation; and the search for the shortest
//! horizon.

#[path = "../tests/instances/mod.rs"]
mod instances;

use std::hint::black_box;

use carom::collision_tolerant::{Objective, Scenario};
use carom::prelude::*;
use carom::reformulate;
use carom::solver::StopToken;
use carom_solver::internals::presolve::{Domain, Propagator, probe, reduce};
use carom_solver::internals::program::Program;
use carom_solver::internals::relaxation::{ClarabelRelaxation, Effort, Relaxation};
use criterion::{BatchSize, Criterion, criterion_group, criterion_main};

/// The paper's tolerant program, perfectly plastic, at a feasible horizon.
fn paper(steps: usize) -> Model {
    match Scenario::paper().program(steps, Objective::Feasibility) {
        Ok(paper) => paper.model().clone(),
        Err(error) => panic!("the paper's scenario is valid: {error}"),
    }
}

fn assembled(model: &Model) -> Program {
    let lowered = reformulate::lower(model).expect("all variables are bounded");
    Program::assemble(lowered.model()).expect("no indicators are left")
}

fn node(criterion: &mut Criterion) {
    criterion.bench_function("paper_457/build", |b| b.iter(|| paper(black_box(457))));
    parts(criterion, "paper_457", &paper(457));
    for (name, model, _) in
        instances::suite::suite(&["pendulum_40", "boxes_30q", "miqp_60"].map(str::to_owned))
    {
        parts(criterion, name, &model);
    }
}

fn parts(criterion: &mut Criterion, name: &str, model: &Model) {
    let mut group = criterion.benchmark_group(name);
    group.bench_function("lower_and_assemble", |b| b.iter(|| assembled(black_box(model))));

    let program = assembled(model);
    let mut propagator = Propagator::new(&program);
    let fresh = Domain::new(&program);
    group.bench_function("propagate_root", |b| {
        b.iter_batched(
            || fresh.clone(),
            |mut domain| propagator.propagate_all(&program, &mut domain),
            BatchSize::LargeInput,
        );
    });

    let mut root = fresh.clone();
    propagator.propagate_all(&program, &mut root).expect("it is feasible");
    group.bench_function("probe_root", |b| {
        b.iter_batched(
            || root.clone(),
            |mut domain| {
                let columns = &program.integers;
                probe(&program, &mut domain, &mut propagator, columns, 4000, &StopToken::default())
            },
            BatchSize::LargeInput,
        );
    });
    group.bench_function("reduce_root", |b| b.iter(|| reduce(&program, black_box(&root))));

    let Some(reduced) = reduce(&program, &root) else {
        panic!("it is feasible");
    };
    let effort = Effort {
        iterations: 60,
        tolerance: 1e-8,
        refinements: 1,
        cutoff: f64::INFINITY,
        token: &StopToken::default(),
        warm: None,
    };
    let mut relaxation = ClarabelRelaxation::new();
    group.bench_function("relax_root", |b| b.iter(|| relaxation.solve(&reduced, &effort)));
    group.finish();
}

fn search(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("shortest_horizon");
    group.sample_size(10);
    for (name, time_step) in [("dt_0.05", 0.05), ("dt_0.02", 0.02), ("dt_0.005", 0.005)] {
        let scenario = Scenario::paper().with_time_step(time_step);
        group.bench_function(name, |b| {
            b.iter(|| {
                let options = ShortestOptions::default();
                scenario.compare(&options, &mut BranchAndBound::default())
            });
        });
    }
    group.finish();
}

criterion_group!(benches, node, search);
criterion_main!(benches);
