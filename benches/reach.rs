//! Speed of reach sets on the paper's scenario at e = 0.5: sweeps, one tube, the whole search with
//! and without them, an explanation, and sets of more states.

use std::hint::black_box;

use carom::collision_tolerant::{Objective, Scenario};
use carom::hybrid::reach::{ReachSets, SetOptions};
use carom::hybrid::{HybridSystem, LinearSystem, Matrix, ShortestOptions};
use carom::interval::Interval;
use carom::prelude::*;
use carom_hybrid::internals::{Choice, Transition};
use criterion::{BatchSize, Criterion, criterion_group, criterion_main};

fn scenario(time_step: f64) -> Scenario {
    let paper = Scenario::paper().with_time_step(time_step);
    paper.with_restitution(0.5).expect("0.5 is a restitution")
}

fn sets(time_step: f64) -> ReachSets {
    scenario(time_step).reach_sets().expect("the paper's scenario is valid")
}

fn sweeps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("paper_485");
    group.sample_size(20);
    let fresh = sets(0.005);
    let forward = |mut sets: ReachSets| sets.forward(485).map(|_| sets);
    group.bench_function("forward", |b| {
        b.iter_batched(|| fresh.clone(), forward, BatchSize::LargeInput)
    });
    let swept = forward(fresh).expect("485 steps are allowed");
    group.bench_function("tube", |b| {
        b.iter_batched(
            || swept.clone(),
            |mut sets| sets.tube(black_box(485)),
            BatchSize::LargeInput,
        )
    });
    let tube = swept.clone().tube(485).expect("485 steps are allowed");
    let program = scenario(0.005).program(485, Objective::Feasibility);
    let program = program.expect("the paper's scenario is valid");
    let variables = program.program().variables().horizon_variables();
    group.bench_function("tighten", |b| {
        b.iter_batched(
            || program.model().clone(),
            |mut model| tube.tighten(&mut model, &variables),
            BatchSize::LargeInput,
        )
    });
    group.bench_function("explain_484", |b| b.iter(|| sets(0.005).explain(black_box(484))));
    group.finish();
}

fn searches(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("shortest_plan");
    group.sample_size(10);
    for time_step in [0.05, 0.01, 0.005] {
        for (name, wanted) in [("with_sets", true), ("without_sets", false)] {
            // Without sets the finer grids take seconds.
            if !wanted && time_step < 0.05 {
                continue;
            }
            let options = ShortestOptions::default().with_reach_sets(wanted);
            group.bench_function(format!("{name}_{time_step}"), |b| {
                b.iter(|| {
                    let mut solver = BranchAndBound::default();
                    scenario(black_box(time_step)).shortest_with(&options, &mut solver)
                })
            });
        }
    }
    group.finish();
}

/// A horizon with time to spare and a cost: most binaries stay open, so that the sets help little.
/// What they cost is to be seen beside the solve.
fn time_to_spare(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("time_to_spare_30_steps");
    group.sample_size(10);
    let scenario = scenario(0.1);
    let program = scenario.program(30, Objective::Effort);
    let program = program.expect("the paper's scenario is valid");
    let variables = program.program().variables().horizon_variables();
    group.bench_function("sets", |b| {
        b.iter_batched(
            || program.model().clone(),
            |mut model| {
                let mut sets = scenario.reach_sets()?;
                sets.tube(30)?.tighten(&mut model, &variables)
            },
            BatchSize::LargeInput,
        )
    });
    group.bench_function("solve", |b| {
        b.iter(|| BranchAndBound::default().solve(black_box(program.model())))
    });
    group.finish();
}

/// A mass on each of some lines, and a chain of three integrators.
fn more_states(criterion: &mut Criterion) {
    let dt = 0.05;
    let line = LinearSystem::double_integrator(dt).expect("a time step");
    let masses = |axes: usize| {
        let a = Matrix::from_fn(2 * axes, 2 * axes, |i, j| match i / 2 == j / 2 {
            true => line.a()[(i % 2, j % 2)],
            false => 0.0,
        });
        let b = Matrix::from_fn(2 * axes, axes, |i, j| match i / 2 == j {
            true => line.b()[(i % 2, 0)],
            false => 0.0,
        });
        LinearSystem::new(a, b, vec![0.0; 2 * axes])
    };
    let chain = LinearSystem::new(
        Matrix::from_fn(3, 3, |i, j| match j.checked_sub(i) {
            Some(0) => 1.0,
            Some(1) => dt,
            Some(2) => 0.5 * dt * dt,
            _ => 0.0,
        }),
        Matrix::from_fn(3, 1, |i, _| [dt * dt * dt / 6.0, 0.5 * dt * dt, dt][i]),
        vec![0.0; 3],
    );
    for (name, flow) in [("three_axes", masses(3)), ("jerk", chain)] {
        let flow = flow.expect("finite matrices");
        let (states, inputs) = (flow.states(), flow.inputs());
        let mut system = HybridSystem::new(1.0).with_transition(Transition::new("flight", flow));
        for i in 0..states {
            system = system.with_state(format!("s{i}"), Interval::new(-50.0, 50.0));
        }
        for j in 0..inputs {
            system = system.with_input(format!("u{j}"), Interval::new(-1.0, 1.0));
        }
        let rest = vec![Interval::point(0.0); states];
        criterion.bench_function(&format!("more_states/{name}_100_steps"), |b| {
            b.iter(|| {
                let options = SetOptions::default();
                let mut sets = ReachSets::new(&system, &rest, &rest, options).expect("it fits");
                sets.tube(black_box(100))
            })
        });
    }
}

/// Rooms in a row, each of which exchanges heat with its neighbours, so that all states are
/// coupled. The first one has a heater that stays on for at least three samples.
fn rooms(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("rooms");
    group.sample_size(10);
    for count in [5, 10, 20] {
        let flow = |heat: f64| {
            let exchange = Matrix::from_fn(count, count, |i, j| match i.abs_diff(j) {
                0 => 0.75,
                1 => 0.1,
                _ => 0.0,
            });
            let mut rise = vec![0.5; count];
            rise[0] += heat;
            LinearSystem::new(exchange, Matrix::zeros(count, 0), rise).expect("finite matrices")
        };
        let heater = Choice::new("heater")
            .with_transition(Transition::new("idle", flow(0.0)).within("off"))
            .with_transition(Transition::event("start", flow(3.0)).between("off", "on"))
            .with_transition(Transition::new("heat", flow(3.0)).within("on"))
            .with_transition(Transition::new("stop", flow(0.0)).between("on", "off"))
            .with_dwell("on", 3, None);
        let mut system = HybridSystem::new(1.0).with_choice(heater);
        for i in 0..count {
            system = system.with_state(format!("room {i}"), Interval::new(0.0, 60.0));
        }
        let start = vec![Interval::point(10.0); count];
        let goal = vec![Interval::new(0.0, 60.0); count];
        group.bench_function(format!("{count}_states_50_steps"), |b| {
            b.iter(|| {
                let options = SetOptions::default();
                let mut sets = ReachSets::new(&system, &start, &goal, options).expect("it fits");
                sets.tube(black_box(50))
            })
        });
    }
    group.finish();
}

criterion_group!(benches, sweeps, searches, time_to_spare, more_states, rooms);
criterion_main!(benches);
