//! Building, writing and reading models, and lowering their indicators.

use std::hint::black_box;

use carom::model::{Method, Reformulation, mps};
use carom::prelude::*;
use carom::reformulate;
use carom::solver::StopToken;
use carom_solver::internals::presolve::{Domain, reduce};
use carom_solver::internals::program::Program;
use carom_solver::internals::relaxation::{ClarabelRelaxation, Effort, Prover, Relaxation};
use criterion::{BatchSize, Criterion, criterion_group, criterion_main};

/// Rows of the large models.
const ROWS: usize = 100_000;

/// A chain `x[t+1] = x[t] + 0.1 u[t]` with a convex cost on `u`: one row a step.
fn chain(rows: usize) -> Result<Model, Error> {
    let mut model = Model::new("chain");
    let x = model.continuous_family("x", rows + 1, -10.0, 10.0)?;
    let u = model.continuous_family("u", rows, -1.0, 1.0)?;
    let mut cost = Quadratic::zero();
    for t in 0..rows {
        model.add(("step", t), (x[t + 1] - x[t] - 0.1 * u[t]).equals(0.0))?;
        cost.add_product(1.0, u[t], u[t]);
    }
    model.minimize(cost)?;
    Ok(model)
}

/// Two indicators a step on a band around the floor.
fn switched(steps: usize) -> Result<Model, Error> {
    let mut model = Model::new("switched");
    let x = model.continuous_family("x", steps, -10.0, 10.0)?;
    let hit = model.binary_family("hit", steps)?;
    for t in 0..steps {
        model.add(("contact", t), hit[t].on().implies(x[t].within(-0.1, 0.1)))?;
        model.add(("flight", t), hit[t].off().implies(x[t].ge(0.0)))?;
    }
    Ok(model)
}

/// A chain with an indicator a step: half of the rows are dynamics, half are switched.
fn planner(rows: usize) -> Result<Model, Error> {
    let steps = rows / 2;
    let mut model = Model::new("planner");
    let x = model.continuous_family("x", steps + 1, -10.0, 10.0)?;
    let u = model.continuous_family("u", steps, -1.0, 1.0)?;
    let hit = model.binary_family("hit", steps)?;
    let mut cost = Quadratic::from(hit.iter().map(|hit| 0.1 * hit).sum::<Affine>());
    for t in 0..steps {
        model.add(("step", t), (x[t + 1] - x[t] - 0.1 * u[t]).equals(0.0))?;
        model.add(("flight", t), hit[t].off().implies(x[t].ge(0.0)))?;
        cost.add_product(1.0, u[t], u[t]);
    }
    model.fix(x[0], 5.0)?;
    model.minimize(cost)?;
    Ok(model)
}

/// Lowers a model and solves its root relaxation once; the proved bound.
fn lower_and_relax(model: &Model) -> Result<f64, Error> {
    let lowered = reformulate::lower(model)?;
    let program = Program::assemble(lowered.model())?;
    let Some(reduced) = reduce(&program, &Domain::new(&program)) else {
        return Ok(f64::INFINITY);
    };
    let effort = Effort {
        iterations: 100,
        tolerance: 1e-8,
        refinements: 1,
        cutoff: f64::INFINITY,
        token: &StopToken::default(),
        warm: None,
    };
    let answer = ClarabelRelaxation::new().solve(&reduced, &effort);
    Ok(Prover::default().lower_bound(&reduced, &answer.x, &answer.y))
}

/// Building a model against what follows: the first must stay under a tenth of the second.
fn building(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("100,000 statements");
    group.sample_size(10);
    group.bench_function("build", |b| b.iter_with_large_drop(|| planner(ROWS)));
    let model = planner(ROWS).expect("the planner is valid");
    group.bench_function("lower", |b| b.iter(|| black_box(reformulate::lower(&model))));
    group.bench_function("lower and relax", |b| b.iter(|| black_box(lower_and_relax(&model))));
    group.finish();
}

/// One disjunction a step, lowered by each method.
fn disjunctions(criterion: &mut Criterion) {
    let model = |method| -> Result<Model, Error> {
        let mut model = Model::new("boxes");
        let x = model.continuous_family("x", 200, -10.0, 10.0)?;
        let y = model.continuous_family("y", 200, -10.0, 10.0)?;
        for t in 0..200 {
            let outside = either(x[t].le(-1.0)).or(x[t].ge(1.0)).or(y[t].le(-2.0));
            model.add(("outside", t), outside.or(y[t].ge(2.0)))?;
        }
        model.set_reformulation(Reformulation::default().with_method(method));
        Ok(model)
    };
    let mut group = criterion.benchmark_group("200 disjunctions of 4 terms");
    group.sample_size(10);
    for method in Method::ALL {
        let model = model(method).expect("the model is valid");
        group.bench_function(method.word(), |b| b.iter(|| black_box(reformulate::lower(&model))));
    }
    group.finish();
}

fn large_models(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("100,000 rows");
    group.sample_size(10);
    group.bench_function("build", |b| b.iter(|| black_box(chain(ROWS))));
    let model = chain(ROWS).expect("the chain is valid");
    let text = mps::write(&model).expect("its names are valid");
    group.bench_function("write MPS", |b| b.iter(|| black_box(mps::write(&model))));
    group.bench_function("read MPS", |b| b.iter(|| black_box(mps::read(&text))));
    let model = switched(ROWS / 2).expect("the model is valid");
    group.bench_function("lower indicators", |b| {
        b.iter_batched(
            || &model,
            |model| black_box(reformulate::lower(model)),
            BatchSize::LargeInput,
        );
    });
    group.finish();
}

criterion_group!(benches, large_models, building, disjunctions);
criterion_main!(benches);
