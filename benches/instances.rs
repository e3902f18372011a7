//! Whole solves of hybrid control programs, as plain rows; `tests/instances` holds their optima.

#[path = "../tests/instances/generators.rs"]
mod generators;

use std::hint::black_box;

use carom::prelude::*;
use criterion::{Criterion, criterion_group, criterion_main};
use generators::{boxes, pendulum, puck, wall};

fn whole_solves(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("instances");
    group.sample_size(10);
    for (name, model) in [
        ("wall 484, infeasible", wall(484, 0.005, 0.5, false)),
        ("wall 485", wall(485, 0.005, 0.5, false)),
        ("wall 60, fuel", wall(60, 0.05, 0.5, true)),
        ("pendulum 40", pendulum(40, [-0.05, 1.0])),
        ("boxes 30", boxes(30, 4, false)),
        ("boxes 30, squared", boxes(30, 3, true)),
        ("puck 25", puck(25, 0.2)),
    ] {
        group.bench_function(name, |b| {
            b.iter(|| black_box(BranchAndBound::default().solve(&model)));
        });
    }
    group.finish();
}

criterion_group!(benches, whole_solves);
criterion_main!(benches);
