//! Solves the programs of the benchmark and prints what each cost, or writes them as files.
//!
//! `cargo run --release --example table -- [NAME...] [--threads K] [--time-limit S] [--rounds N]
//! [--write FOLDER]`
//!
//! * `NAME...`: parts of names; without, all programs
//! * `--threads K`: threads of the tree search, 1 by default
//! * `--time-limit S`: seconds a solve, 60 by default
//! * `--rounds N`: solves of each program, of which the median time counts; 3 by default
//! * `--write FOLDER`: write each program there as an MPS file, and all answers as `answers.txt`
//!   (name and optimum, or `infeasible`), and solve nothing; `benches/compare.py` reads them
//!
//! Programs are solved from their MPS text, without knowledge of where they come from. Allocations
//! are all of the process during the solve, lowering included. The exit status tells whether every
//! answer was the listed one. `docs/benchmarks.md` says more.

#[path = "../tests/instances/generators.rs"]
mod generators;
#[path = "../tests/instances/random_miqp.rs"]
mod random_miqp;
#[path = "../tests/instances/riccati.rs"]
mod riccati;
#[path = "../tests/instances/suite.rs"]
mod suite;

use std::alloc::System;
use std::error::Error;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use carom::model::mps;
use carom::prelude::{BranchAndBound, Options, Solution, Solver, Termination};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use suite::{Truth, suite};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

fn main() -> ExitCode {
    match run() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("table: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<bool, Box<dyn Error>> {
    let mut options = Options::default().with_time_limit(Duration::from_secs(60));
    let (mut names, mut folder, mut rounds) = (Vec::new(), None, 3_usize);
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value"));
        match word.as_str() {
            "--threads" => options.threads = value()?.parse()?,
            "--rounds" => rounds = value()?.parse::<usize>()?.max(1),
            "--time-limit" => {
                options.time_limit = Some(Duration::try_from_secs_f64(value()?.parse()?)?);
            }
            "--write" => folder = Some(value()?),
            _ if word.starts_with("--") => return Err(format!("unexpected `{word}`").into()),
            _ => names.push(word),
        }
    }
    if let Some(folder) = folder {
        write(&names, &folder)?;
        return Ok(true);
    }
    println!(
        "| program | status | objective | nodes | relaxations | iterations | seconds | nodes/s | \
         allocations/node |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    let mut right = true;
    for (name, model, truth) in suite(&names) {
        let model = mps::read(&mps::write(&model)?)?;
        let mut runs = Vec::new();
        for _ in 0..rounds {
            let (region, start) = (Region::new(ALLOCATOR), Instant::now());
            let solution = BranchAndBound::new(options.clone()).solve(&model)?;
            let seconds = start.elapsed().as_secs_f64();
            let change = region.change();
            runs.push((seconds, change.allocations + change.reallocations, solution));
        }
        runs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (seconds, allocations, solution) = &runs[rounds / 2];
        let statistics = solution.statistics();
        let nodes = statistics.nodes.max(1) as f64;
        let agrees = agrees(solution, truth);
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
    }
    Ok(right)
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
