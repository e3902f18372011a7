//! Solves random, numerically difficult programs and compares every answer with the exact one.
//!
//! `cargo run --release --example torture -- [--cases N] [--seed S] [--threads K]
//! [--solver-threads T] [--family NAME] [--paths] [--out FOLDER]`
//!
//! * `--cases N`: number of programs, 10000 by default
//! * `--seed S`: seed of the first program, 0 by default; the others follow
//! * `--threads K`: programs that are solved at the same time, 1 by default
//! * `--solver-threads T`: threads of each solve, 1 by default
//! * `--family NAME`: `mixed` (the default), `large`, `big-m`, `open`, `borderline`, `chain`,
//!   `at-rest`, `open-integers`, `other-words`, `dense`, `cones`, `thin-cones`, or `all` in turn;
//!   see `tests/torture/families.rs` and `tests/torture/cones`
//! * `--paths`: solves each program in all unusual ways as well: without presolve, with a pool,
//!   with kept leaves, with another branching rule, without cuts
//! * `--out FOLDER`: where wrongly answered and unfinished programs go, `target/torture` by default
//!
//! Each program that was answered wrongly or not finished is written there as an MPS file named
//! after its family and seed, and a line says what is wrong. The last line counts the verdicts. The
//! exit status tells whether any answer was wrong, or any solve stalled that may not.
//! `tests/torture` has the generator and defines what is wrong. Ctrl-C ends it with the counts so
//! far and the exit status 3.

#[macro_use]
#[path = "../crates/carom-cli/src/output.rs"]
mod output;
#[path = "../crates/carom-cli/src/interrupts.rs"]
mod interrupts;

#[path = "../tests/common/mod.rs"]
mod common;
#[path = "../tests/torture/mod.rs"]
mod torture;

use std::error::Error;
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use carom::model::mps;
use carom::prelude::{
    BranchAndBound, Control, Interrupt, Model, Options, Solution, Solver, Termination,
};
use interrupts::{INTERRUPTED, Signals};
use torture::cones::case::ConicCase;
use torture::cones::{generator, oracle, thin};
use torture::families::{Family, Path};
use torture::oracle::{Truth, Verdict};

/// The time after which a solve counts as one that does not end.
const LIMIT: Duration = Duration::from_secs(20);

/// A family without cones, or one of those with them.
#[derive(Debug, Clone, Copy)]
enum Kind {
    Plain(Family),
    Cones,
    ThinCones,
}

struct Arguments {
    cases: u64,
    seed: u64,
    threads: usize,
    solver_threads: usize,
    families: Vec<Kind>,
    paths: Vec<Path>,
    out: String,
}

fn main() -> ExitCode {
    match arguments().and_then(run) {
        Ok(status) => status,
        Err(error) => {
            eprintln!("torture: {error}");
            ExitCode::FAILURE
        }
    }
}

fn arguments() -> Result<Arguments, Box<dyn Error>> {
    let (cases, seed, out) = (10_000, 0, "target/torture".to_owned());
    let (threads, solver_threads) = (1, 1);
    let (families, paths) = (vec![Kind::Plain(Family::Mixed)], vec![Path::Usual]);
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
            "--family" if value == "all" => {
                let cones = [Kind::Cones, Kind::ThinCones];
                arguments.families =
                    Family::ALL.into_iter().map(Kind::Plain).chain(cones).collect();
            }
            "--family" if value == "cones" => arguments.families = vec![Kind::Cones],
            "--family" if value == "thin-cones" => arguments.families = vec![Kind::ThinCones],
            "--family" => {
                let family = Family::named(&value).ok_or(format!("no family `{value}`"))?;
                arguments.families = vec![Kind::Plain(family)];
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

fn run(arguments: Arguments) -> Result<ExitCode, Box<dyn Error>> {
    let interrupt = Interrupt::new();
    let signals = Signals::catch(&interrupt)?;
    let (next, counts) = (AtomicU64::new(0), Mutex::new(Counts::default()));
    let start = Instant::now();
    std::thread::scope(|scope| {
        for _ in 0..arguments.threads.max(1) {
            scope.spawn(|| {
                loop {
                    let done = next.fetch_add(1, Ordering::Relaxed);
                    if done >= arguments.cases || interrupt.is_triggered() {
                        break;
                    }
                    one(arguments.seed.wrapping_add(done), &arguments, &interrupt, &counts);
                }
            });
        }
    });
    let counts = counts.into_inner().map_err(|_| "a thread panicked")?;
    let seconds = start.elapsed().as_secs_f64();
    let programs = next.into_inner().min(arguments.cases);
    println!("{programs} programs in {seconds:.1} s: {counts:?}");
    Ok(match counts.wrong + counts.not_finished {
        0 if signals.came() => INTERRUPTED.into(),
        0 => ExitCode::SUCCESS,
        _ => ExitCode::FAILURE,
    })
}

/// Judges a solution that was found with some options.
type Judge = dyn Fn(&Options, &Solution) -> Verdict;

/// A program that is to be solved.
struct Posed {
    name: String,
    model: Model,
    is_infeasible: bool,
    is_unbounded: bool,
    may_stall: Box<dyn Fn() -> bool>,
    judge: Box<Judge>,
}

/// The program of a seed; with cones also the same program in other coordinates.
fn posed(kind: Kind, seed: u64) -> Result<Vec<Posed>, String> {
    let family = match kind {
        Kind::Plain(family) => family,
        Kind::Cones => return with_cones("cones", generator::program(seed), seed),
        Kind::ThinCones => return with_cones("thin-cones", thin::program(seed), seed),
    };
    let case = family.program(seed);
    let (model, variables) = case.build();
    let truth = family.truth(&case);
    Ok(vec![Posed {
        name: family.name().to_owned(),
        model,
        is_infeasible: truth == Truth::Infeasible,
        is_unbounded: truth == Truth::Unbounded,
        may_stall: Box::new(move || family.may_stall()),
        judge: Box::new(move |options, solution| {
            family.judge(&case, &variables, options, solution, &truth)
        }),
    }])
}

fn with_cones(name: &str, case: ConicCase, seed: u64) -> Result<Vec<Posed>, String> {
    let truth = oracle::truth(&case, 0.0);
    let posed = |name: String, case: ConicCase| -> Result<Posed, String> {
        let (model, variables) = case.build().map_err(|error| error.to_string())?;
        let (truth, known, again) = (truth.clone(), truth.clone(), case.clone());
        Ok(Posed {
            name,
            model,
            is_infeasible: truth.least.is_none() && !truth.unbounded,
            is_unbounded: truth.unbounded,
            may_stall: Box::new(move || oracle::is_ill_posed(&again, &known)),
            judge: Box::new(move |options, solution| {
                oracle::judge(&case, &variables, options, solution, &truth)
            }),
        })
    };
    let mut all = Vec::new();
    // The bounds of turned columns may not tell the sign of a head any more.
    if let Some(moved) = Some(case.moved(seed)).filter(ConicCase::is_taken) {
        all.push(posed(format!("{name}-moved"), moved)?);
    }
    all.push(posed(name.to_owned(), case)?);
    Ok(all)
}

fn one(seed: u64, arguments: &Arguments, interrupt: &Interrupt, counts: &Mutex<Counts>) {
    let family = arguments.families[(seed % arguments.families.len() as u64) as usize];
    let posed = match posed(family, seed) {
        Ok(posed) => posed,
        Err(error) => {
            println!("WRONG {seed}: {error}");
            if let Ok(mut counts) = counts.lock() {
                counts.wrong += 1;
            }
            return;
        }
    };
    for posed in &posed {
        if let Ok(mut counts) = counts.lock() {
            counts.infeasible += u64::from(posed.is_infeasible);
            counts.unbounded += u64::from(posed.is_unbounded);
        }
        for &path in &arguments.paths {
            solve(seed, posed, path, arguments, interrupt, counts);
        }
    }
}

fn solve(
    seed: u64,
    posed: &Posed,
    path: Path,
    arguments: &Arguments,
    interrupt: &Interrupt,
    counts: &Mutex<Counts>,
) {
    let Posed { name, model, .. } = posed;
    let options = path.options().with_time_limit(LIMIT);
    let threads = options.threads.max(arguments.solver_threads);
    let mut solver = BranchAndBound::new(options.with_threads(threads));
    let mut control = Control::default().with_interrupt(interrupt);
    let (verdict, nodes) = match solver.solve_with(model, &mut control) {
        Ok(solution) if solution.termination() == Termination::Interrupted => return,
        Ok(solution) if solution.termination() == Termination::TimeLimit => {
            (Verdict::Stalled(format!("no end after {LIMIT:?}")), solution.statistics().nodes)
        }
        Ok(solution) => ((posed.judge)(solver.options(), &solution), solution.statistics().nodes),
        Err(error) => (Verdict::Wrong(error.to_string()), 0),
    };
    let may_stall = matches!(verdict, Verdict::Stalled(_)) && (posed.may_stall)();
    if let Ok(mut counts) = counts.lock() {
        counts.nodes += nodes;
        match &verdict {
            Verdict::Right => counts.right += 1,
            Verdict::Borderline => counts.borderline += 1,
            Verdict::Beyond => counts.beyond += 1,
            Verdict::Stalled(_) => {
                counts.stalled += 1;
                counts.not_finished += u64::from(!may_stall);
            }
            Verdict::Wrong(_) => counts.wrong += 1,
        }
    }
    let (word, what) = match &verdict {
        Verdict::Wrong(what) => ("WRONG", what),
        Verdict::Stalled(what) if may_stall => ("stalled, as it may,", what),
        Verdict::Stalled(what) => ("stalled", what),
        _ => return,
    };
    println!("{word} {seed} ({name}, {path:?}): {what}");
    // What MPS cannot say is written as text.
    let (text, ending) = match mps::write(model) {
        Ok(text) => (text, "mps"),
        Err(_) => (model.to_string(), "txt"),
    };
    let path = format!("{}/{name}_{seed}.{ending}", arguments.out);
    let written = std::fs::create_dir_all(&arguments.out).and_then(|()| std::fs::write(path, text));
    if let Err(error) = written {
        println!("  it could not be written: {error}");
    }
}
