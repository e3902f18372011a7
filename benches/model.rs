//! Building, writing and reading models, and lowering their indicators.

use std::hint::black_box;

use carom::model::mps;
use carom::prelude::*;
use carom::reformulate;
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

criterion_group!(benches, large_models);
criterion_main!(benches);
