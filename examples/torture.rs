//! Solves random, numerically difficult programs and compares every answer with the exact one.
//!
//! `cargo run --release --example torture -- [--cases N] [--seed S] [--threads K]
//! [--solver-threads T] [--family NAME] [--paths] [--out FOLDER]`
//!
//! * `--cases N`: number of programs, 10000 by default
//! * `--seed S`: seed of the first program, 0 by default; the others follow
//! * `--threads K`: programs that are solved at the same time, 1 by default
//! * `--solver-threads T`: threads of each solve, 1 by default
//! * `--family NAME`: `mixed` (the default), `large`, `big-m`, `open`, `borderline`, `chain`, or `all` in
//!   turn; see `tests/torture/families.rs`
//! * `--paths`: solves each program in all unusual ways as well: without presolve, with a pool, with kept
//!   leaves, with another branching rule, without cuts
//! * `--out FOLDER`: where wrongly answered and unfinished programs go, `target/torture` by default
//!
//! Each program that was answered wrongly or not finished is written there as an MPS file named
//! after its family and seed, and a line says what is wrong. The last line counts the verdicts. The exit
//! status tells whether any answer was wrong, or any solve stalled that may not. `tests/torture` has the
//! generator and defines what is wrong.

#[macro_use]
#[path = "common/output.rs"]
mod output;

#[path = "../tests/common/mod.rs"]
mod common;
#[path = "../tests/torture/mod.rs"]
mod torture;

use std::error::Error;
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use carom::model::mps;
use carom::prelude::{BranchAndBound, Solver};
use torture::families::{Family, Path};
use torture::oracle::{Truth, Verdict};

struct Arguments {
    cases: u64,
    seed: u64,
    threads: usize,
    solver_threads: usize,
    families: Vec<Family>,
    paths: Vec<Path>,
    out: String,
}

fn main() -> ExitCode {
    match arguments().and_then(run) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("torture: {error}");
            ExitCode::FAILURE
        }
    }
}

fn arguments() -> Result<Arguments, Box<dyn Error>> {
    let (cases, seed, out) = (10_000, 0, "target/torture".to_owned());
    let (threads, solver_threads) = (1, 1);
    let (families, paths) = (vec![Family::Mixed], vec![Path::Usual]);
    let mut arguments = Arguments { cases, seed, threads, solver_threads, families, paths, out };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        if word == "--paths" {
            arguments.paths = Path::ALL.to_vec();
            continue;
        }
        let value = words.next().ok_or(format!("{word} needs a value"))?;
        match word.as_str() {
            "--cases" => arguments.cases = value.parse()?,
            "--seed" => arguments.seed = value.parse()?,
            "--threads" => arguments.threads = value.parse()?,
            "--solver-threads" => arguments.solver_threads = value.parse()?,
            "--family" if value == "all" => arguments.families = Family::ALL.to_vec(),
            "--family" => {
                let family = Family::named(&value);
                arguments.families = vec![family.ok_or(format!("no family `{value}`"))?];
            }
            "--out" => arguments.out = value,
            _ => return Err(format!("unexpected `{word}`").into()),
        }
    }
    Ok(arguments)
}

/// What was seen.
#[derive(Debug, Default)]
struct Counts {
    right: u64,
    borderline: u64,
    beyond: u64,
    stalled: u64,
    /// Those of them that may not stall.
    not_finished: u64,
    wrong: u64,
    infeasible: u64,
    unbounded: u64,
    nodes: u64,
}

fn run(arguments: Arguments) -> Result<bool, Box<dyn Error>> {
    let (next, counts) = (AtomicU64::new(0), Mutex::new(Counts::default()));
    let start = Instant::now();
    std::thread::scope(|scope| {
        for _ in 0..arguments.threads.max(1) {
            scope.spawn(|| {
                loop {
                    let done = next.fetch_add(1, Ordering::Relaxed);
                    if done >= arguments.cases {
                        break;
                    }
                    one(arguments.seed.wrapping_add(done), &arguments, &counts);
                }
            });
        }
    });
    let counts = counts.into_inner().map_err(|_| "a thread panicked")?;
    let seconds = start.elapsed().as_secs_f64();
    println!("{} programs in {seconds:.1} s: {counts:?}", arguments.cases);
    Ok(counts.wrong + counts.not_finished == 0)
}

fn one(seed: u64, arguments: &Arguments, counts: &Mutex<Counts>) {
    let family = arguments.families[(seed % arguments.families.len() as u64) as usize];
    let case = family.program(seed);
    let (model, variables) = case.build();
    let truth = family.truth(&case);
    if let Ok(mut counts) = counts.lock() {
        match truth {
            Truth::Infeasible => counts.infeasible += 1,
            Truth::Unbounded => counts.unbounded += 1,
            Truth::Least { .. } => {}
        }
    }
    for &path in &arguments.paths {
        let options = path.options();
        let threads = options.threads.max(arguments.solver_threads);
        let mut solver = BranchAndBound::new(options.with_threads(threads));
        let (verdict, nodes) = match solver.solve(&model) {
            Ok(solution) => (
                family.judge(&case, &variables, solver.options(), &solution, &truth),
                solution.statistics().nodes,
            ),
            Err(error) => (Verdict::Wrong(error.to_string()), 0),
        };
        if let Ok(mut counts) = counts.lock() {
            counts.nodes += nodes;
            match &verdict {
                Verdict::Right => counts.right += 1,
                Verdict::Borderline => counts.borderline += 1,
                Verdict::Beyond => counts.beyond += 1,
                Verdict::Stalled(_) => {
                    counts.stalled += 1;
                    counts.not_finished += u64::from(!family.may_stall());
                }
                Verdict::Wrong(_) => counts.wrong += 1,
            }
        }
        let (word, what) = match &verdict {
            Verdict::Wrong(what) => ("WRONG", what),
            Verdict::Stalled(what) => ("stalled", what),
            _ => continue,
        };
        let name = family.name();
        println!("{word} {seed} ({name}, {path:?}): {what}");
        let text = mps::write(&model).map_err(|error| error.to_string());
        let written = text.and_then(|text| {
            std::fs::create_dir_all(&arguments.out).map_err(|error| error.to_string())?;
            let path = format!("{}/{name}_{seed}.mps", arguments.out);
            std::fs::write(path, text).map_err(|error| error.to_string())
        });
        if let Err(error) = written {
            println!("  it could not be written: {error}");
        }
    }
}
