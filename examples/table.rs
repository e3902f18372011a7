//! Solves the programs of the benchmark and prints nodes and times, or writes the programs as
//! files.
//!
//! `cargo run --release --example table -- [NAME...] [--threads K] [--time-limit S] [--rounds N]
//! [--relaxation METHOD] [--write FOLDER] [--limits]`
//!
//! * `NAME...`: parts of names; all programs by default
//! * `--threads K`: threads of the tree search, 1 by default
//! * `--time-limit S`: seconds per solve, 60 by default
//! * `--rounds N`: solves of each program, whose median time is printed; 3 by default
//! * `--relaxation METHOD`: `automatic` (the default), `interior-point` or `clarabel`
//! * `--write FOLDER`: write each program as an MPS file, and all answers as `answers.txt` (name
//!   and optimum, or `infeasible`), for `benches/compare.py`, without solving
//!
//! * `--limits`: instead, stop solves of large programs after 16 different times from 2 ms to 3 s,
//!   half of them by an interrupt from another thread, and print the delays until they return
//!
//! Programs are solved from their MPS text. Allocations are those of the process during the solve,
//! including lowering. The exit status tells whether every answer was the listed one. See
//! `docs/benchmarks.md`. Ctrl-C ends the solve at hand; its row says what is known of it, and the
//! exit status is 3.

#[macro_use]
#[path = "../crates/carom-cli/src/output.rs"]
mod output;
#[path = "../crates/carom-cli/src/interrupts.rs"]
mod interrupts;

#[path = "../tests/instances/mod.rs"]
mod instances;

use std::alloc::System;
use std::error::Error;
use std::process::ExitCode;
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};

use carom::model::mps;
use carom::prelude::{
    BranchAndBound, Control, Interrupt, Model, Options, Solution, Solver, Termination,
};
use carom::solver::RelaxationMethod;
use instances::large::large;
use instances::suite::{Truth, suite};
use interrupts::{INTERRUPTED, Signals};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

fn main() -> ExitCode {
    match run() {
        Ok(status) => status,
        Err(error) => {
            eprintln!("table: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<ExitCode, Box<dyn Error>> {
    let mut options = Options::default().with_time_limit(Duration::from_secs(60));
    let (mut names, mut folder, mut rounds, mut limits) = (Vec::new(), None, 3_usize, false);
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value"));
        match word.as_str() {
            "--threads" => options.threads = value()?.parse()?,
            "--rounds" => rounds = value()?.parse::<usize>()?.max(1),
            "--time-limit" => {
                options.time_limit = Some(Duration::try_from_secs_f64(value()?.parse()?)?);
            }
            "--relaxation" => {
                let name = value()?;
                let mut all = RelaxationMethod::ALL.into_iter();
                let found = all.find(|method| method.to_string() == name);
                options.relaxation = found.ok_or(format!("no method is called `{name}`"))?;
            }
            "--write" => folder = Some(value()?),
            "--limits" => limits = true,
            _ if word.starts_with("--") => return Err(format!("unexpected `{word}`").into()),
            _ => names.push(word),
        }
    }
    if let Some(folder) = folder {
        write(&names, &folder)?;
        return Ok(ExitCode::SUCCESS);
    }
    if limits {
        overshoots(&names, options.threads)?;
        return Ok(ExitCode::SUCCESS);
    }
    println!(
        "| program | status | objective | nodes | relaxations | iterations | seconds | nodes/s | \
         allocations/node |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    let programs = suite(&names);
    let interrupt = Interrupt::new();
    let signals = Signals::catch(&interrupt)?;
    let mut right = true;
    for (name, model, truth) in programs {
        let model = mps::read(&mps::write(&model)?)?.model;
        let mut runs = Vec::new();
        for _ in 0..rounds {
            let (region, start) = (Region::new(ALLOCATOR), Instant::now());
            let mut control = Control::default().with_interrupt(&interrupt);
            let solution = BranchAndBound::new(options.clone()).solve_with(&model, &mut control)?;
            let seconds = start.elapsed().as_secs_f64();
            let change = region.change();
            runs.push((seconds, change.allocations + change.reallocations, solution));
            if signals.came() {
                break;
            }
        }
        runs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (seconds, allocations, solution) = &runs[runs.len() / 2];
        let statistics = solution.statistics();
        let nodes = statistics.nodes.max(1) as f64;
        let agrees = agrees(solution, truth) || signals.came();
        right &= agrees;
        println!(
            "| {name} | {}{} | {} | {} | {} | {} | {seconds:.4} | {:.0} | {:.0} |",
            solution.termination(),
            if agrees { "" } else { " (WRONG)" },
            solution.objective().map_or("-".into(), |objective| format!("{objective:.8}")),
            statistics.nodes,
            statistics.relaxations,
            statistics.iterations,
            nodes / seconds,
            *allocations as f64 / nodes,
        );
        if signals.came() {
            return Ok(INTERRUPTED.into());
        }
    }
    Ok(if right { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn agrees(solution: &Solution, truth: Truth) -> bool {
    match (solution.termination(), truth) {
        (Termination::Infeasible, Truth::Infeasible) => true,
        (Termination::Optimal, Truth::Optimum(optimum)) => solution
            .objective()
            .is_some_and(|found| (found - optimum).abs() <= 2e-6 * optimum.abs().max(1.0)),
        _ => false,
    }
}

fn write(names: &[String], folder: &str) -> Result<(), Box<dyn Error>> {
    std::fs::create_dir_all(folder)?;
    let mut answers = String::new();
    for (name, model, truth) in suite(names) {
        std::fs::write(format!("{folder}/{name}.mps"), mps::write(&model)?)?;
        let answer = match truth {
            Truth::Infeasible => "infeasible".to_owned(),
            Truth::Optimum(optimum) => optimum.to_string(),
        };
        answers += &format!("{name} {answer}\n");
    }
    Ok(std::fs::write(format!("{folder}/answers.txt"), answers)?)
}

/// Prints how much solves of large programs overshoot their limits.
fn overshoots(names: &[String], threads: usize) -> Result<(), Box<dyn Error>> {
    const MOMENTS: u32 = 16;
    const LIMITS: [f64; 2] = [0.002, 3.0];
    println!("| program | rows | columns | stopped | median / ms | largest / ms | at / ms |");
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    for (name, model) in large(names) {
        let mut overshoots = Vec::new();
        for k in 0..MOMENTS {
            let share = f64::from(k) / f64::from(MOMENTS - 1);
            let limit = Duration::from_secs_f64(LIMITS[0] * (LIMITS[1] / LIMITS[0]).powf(share));
            let (ended, took) = stopped(&model, limit, threads, k % 2 == 1)?;
            if ended.is_limit() {
                overshoots.push((took.saturating_sub(limit), limit));
            }
        }
        overshoots.sort();
        let rows = model.constraint_count() + model.indicator_count();
        print!("| {name} | {rows} | {} | {} |", model.variable_count(), overshoots.len());
        match (overshoots.get(overshoots.len() / 2), overshoots.last()) {
            (Some((median, _)), Some((most, at))) => println!(
                " {:.1} | {:.1} | {} |",
                1e3 * median.as_secs_f64(),
                1e3 * most.as_secs_f64(),
                at.as_millis()
            ),
            _ => println!(" - | - | - |"),
        }
    }
    Ok(())
}

/// Solves until a certain time. Returns why it stopped and when.
fn stopped(
    model: &Model,
    limit: Duration,
    threads: usize,
    by_interrupt: bool,
) -> Result<(Termination, Duration), Box<dyn Error>> {
    let time_limit = (!by_interrupt).then_some(limit);
    let mut options = Options::default().with_threads(threads);
    options.time_limit = time_limit;
    let interrupt = Interrupt::new();
    let (done, ended) = mpsc::channel();
    let start = Instant::now();
    let (solution, took) = thread::scope(|scope| {
        let other = interrupt.clone();
        if by_interrupt {
            // Not beyond the end of a solve that finishes first.
            scope.spawn(move || match ended.recv_timeout(limit) {
                Ok(()) => {}
                Err(_) => other.trigger(),
            });
        }
        let mut control = Control::default().with_interrupt(&interrupt);
        let solution = BranchAndBound::new(options).solve_with(model, &mut control);
        let took = start.elapsed();
        // Fails if the solve has already ended.
        let _ = done.send(());
        (solution, took)
    });
    Ok((solution?.termination(), took))
}
