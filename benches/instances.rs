//! Whole solves of hybrid control programs, as plain rows; `tests/instances` holds their optima.

#[path = "../tests/instances/mod.rs"]
mod instances;

use std::hint::black_box;

use carom::prelude::*;
use criterion::{Criterion, criterion_group, criterion_main};
use instances::suite::suite;

fn whole_solves(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("instances");
    group.sample_size(10);
    for (name, model, _) in suite(&[]) {
        group.bench_function(name, |b| {
            b.iter(|| black_box(BranchAndBound::default().solve(&model)));
        });
    }
    group.finish();
}

criterion_group!(benches, whole_solves);
criterion_main!(benches);
