//! Closed loops of hybrid systems: every program solved from nothing, and prepared and warm.
//!
//! `cargo run --release --example closed_loops -- [NAME...] [--steps N] [--seed S] [--noise F]
//! [--each]`
//!
//! * `NAME...`: parts of names; all loops by default
//! * `--steps N`: steps of a loop, 100 by default
//! * `--seed S`: of the disturbances, 1 by default
//! * `--noise F`: a factor of all disturbances, 1 by default
//! * `--each`: a line per step as well
//!
//! The programs are those of `table`, with the measured state as parameters. After each step the
//! state is the next one of the plan, disturbed. The table has the median times, the median of warm
//! over cold, the steps that took longer than 1.1 times cold plus 1 ms, the nodes, and the
//! allocations per relaxation. The exit status tells whether all optima agree within the gaps.
//! Ctrl-C ends the loop at hand with the row of its steps so far, and the exit status 3.

#[macro_use]
#[path = "../crates/carom-cli/src/output.rs"]
mod output;
#[path = "../crates/carom-cli/src/interrupts.rs"]
mod interrupts;

#[path = "../tests/instances/mod.rs"]
mod instances;

use std::alloc::System;
use std::process::ExitCode;
use std::time::Instant;

use carom::prelude::*;
use instances::generators::{cartpole, pendulum};
use interrupts::{INTERRUPTED, Signals};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// A system, where its loop begins, and how much each entry of its state is disturbed in a step.
struct Loop {
    name: &'static str,
    model: fn() -> Model,
    states: &'static [&'static str],
    start: &'static [f64],
    push: &'static [f64],
}

const LOOPS: &[Loop] = &[
    Loop {
        name: "pendulum_60",
        model: || pendulum(60, None, false),
        states: &["angle", "rate"],
        start: &[-0.05, 1.0],
        push: &[0.002, 0.05],
    },
    Loop {
        name: "cartpole_30",
        model: || cartpole(30, None),
        states: &["x0", "x1", "x2", "x3"],
        start: &[0.2, 0.3, 0.0, -2.0],
        push: &[0.01, 0.01, 0.1, 0.3],
    },
    Loop {
        name: "cartpole_45",
        model: || cartpole(45, None),
        states: &["x0", "x1", "x2", "x3"],
        start: &[0.2, 0.3, 0.0, -2.0],
        push: &[0.01, 0.01, 0.1, 0.3],
    },
];

/// Milliseconds and counts of a solve.
#[derive(Debug, Clone, Copy)]
struct Effort {
    time: f64,
    nodes: u64,
    relaxations: u64,
    /// Nodes and children closed by proofs of the solve before.
    proved: u64,
    allocations: u64,
}

fn timed(solve: impl FnOnce() -> Result<Solution, Error>) -> Result<(Solution, Effort), Error> {
    let (region, began) = (Region::new(ALLOCATOR), Instant::now());
    let solution = solve()?;
    let time = 1e3 * began.elapsed().as_secs_f64();
    let change = region.change();
    let allocations = (change.allocations + change.reallocations) as u64;
    let counts = solution.statistics();
    let (nodes, relaxations) = (counts.nodes, counts.relaxations);
    let proved = counts.closed_by_proofs;
    Ok((solution, Effort { time, nodes, relaxations, proved, allocations }))
}

/// Both solves of every step, and whether their optima agree.
fn run(
    of: &Loop,
    steps: usize,
    seed: u64,
    each: bool,
    noise: f64,
    interrupt: &Interrupt,
) -> Result<(Vec<[Effort; 2]>, bool), Error> {
    let mut model = (of.model)();
    let measured: Vec<Variable> = model.parameters().collect();
    let next = of.states.iter().map(|name| model.variable_by_name((*name, 1)));
    let next: Vec<Variable> = next.collect::<Result<_, _>>()?;
    let pushes = of.push.iter().map(|&most| -noise * most..=noise * most);
    let mut push = Disturbance::new(pushes, seed);
    let (mut cold, mut solver) = (BranchAndBound::default(), BranchAndBound::default());
    let mut prepared = solver.prepare(&model)?;
    let control = || Control::default().with_interrupt(interrupt);
    let (mut state, mut efforts, mut agree) = (of.start.to_vec(), Vec::new(), true);
    for step in 0..steps {
        let values: Vec<(Variable, f64)> = measured.iter().copied().zip(state.clone()).collect();
        for &(parameter, value) in &values {
            model.set_parameter(parameter, value)?;
        }
        let (one, first) = timed(|| cold.solve_with(&model, &mut control()))?;
        let (two, second) = timed(|| prepared.solve(&values, &mut control().with_steps_passed(1)))?;
        if interrupt.is_triggered() {
            break;
        }
        efforts.push([first, second]);
        if each {
            println!("{step:>3} {state:.3?} from nothing {first:?}, warm {second:?}");
        }
        let (Some(best), Some(own)) = (one.objective(), two.objective()) else {
            agree &= one.termination() == two.termination();
            println!("{}: step {step} is {}", of.name, one.termination());
            break;
        };
        agree &= (best - own).abs() <= 3e-6 * best.abs() + 3e-7;
        for ((value, &variable), w) in state.iter_mut().zip(&next).zip(push.next_value()) {
            let range = model.variable_ref(variable)?.bounds();
            *value = (one.value(variable)? + w).clamp(range.lower, range.upper);
        }
    }
    Ok((efforts, agree))
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

fn main() -> Result<ExitCode, Box<dyn std::error::Error>> {
    let (mut names, mut steps, mut seed, mut each) = (Vec::new(), 100, 1, false);
    let mut noise = 1.0;
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        match word.as_str() {
            "--each" => each = true,
            "--steps" => steps = words.next().and_then(|word| word.parse().ok()).unwrap_or(steps),
            "--noise" => noise = words.next().and_then(|word| word.parse().ok()).unwrap_or(noise),
            "--seed" => seed = words.next().and_then(|word| word.parse().ok()).unwrap_or(seed),
            _ => names.push(word),
        }
    }
    println!(
        "| loop | steps | cold / ms | warm / ms | warm / cold | slower | nodes | relaxations | proved | allocations | agree |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    let interrupt = Interrupt::new();
    let signals = Signals::catch(&interrupt)?;
    let mut right = true;
    let is_wanted =
        |of: &&Loop| names.is_empty() || names.iter().any(|part| of.name.contains(part));
    for of in LOOPS.iter().filter(is_wanted) {
        let (efforts, agree) = run(of, steps, seed, each, noise, &interrupt)?;
        if efforts.is_empty() && signals.came() {
            return Ok(INTERRUPTED.into());
        }
        right &= agree;
        let middle = |of: fn(&[Effort; 2]) -> f64| median(efforts.iter().map(of).collect());
        let sum = |k: usize, of: fn(&Effort) -> u64| -> u64 {
            efforts.iter().map(|both| of(&both[k])).sum()
        };
        let slower = efforts.iter().filter(|[cold, warm]| warm.time > 1.1 * cold.time + 1.0);
        println!(
            "| {} | {} | {:.2} | {:.2} | {:.2} | {} | {} -> {} | {} -> {} | {} | {} -> {} | {agree} |",
            of.name,
            efforts.len(),
            middle(|both| both[0].time),
            middle(|both| both[1].time),
            middle(|both| both[1].time / both[0].time),
            slower.count(),
            sum(0, |e| e.nodes),
            sum(1, |e| e.nodes),
            sum(0, |e| e.relaxations),
            sum(1, |e| e.relaxations),
            sum(1, |e| e.proved),
            sum(0, |e| e.allocations) / sum(0, |e| e.relaxations).max(1),
            sum(1, |e| e.allocations) / sum(1, |e| e.relaxations).max(1),
        );
        if signals.came() {
            return Ok(INTERRUPTED.into());
        }
    }
    Ok(if right { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
