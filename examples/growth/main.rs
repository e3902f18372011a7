//! Seconds and memory over the size of a program, for four families: unit commitment, a flight with
//! a longer horizon, with more obstacles, and a mission of more robots.
//!
//! `cargo run --release --example growth -- FOLDER [--large] [--limit S] [--write] [--compared
//! FILE.json]`
//!
//! * `FOLDER`: the table `growth.csv` and the picture `growth.svg` go there
//! * `--large`: larger programs, too, which take minutes
//! * `--limit S`: seconds a solve, 20 by default
//! * `--write`: write each program there as an MPS file, and solve nothing
//! * `--compared FILE.json`: draw HiGHS from the answers of `benches/compare.py --json` on these
//!   files; with the feature `highs` it is measured in the same run
//!
//! `cargo run --release --example growth -- --draw FIGURES.csv PICTURE.svg` draws a kept table.
//!
//! Each solve is a process of its own, so that its memory can be told. Seconds are those of the
//! processor where the system tells them, without building the program.

#[path = "../../tests/instances/mod.rs"]
mod instances;
#[allow(dead_code)] // of the missions, robots use the points
#[path = "../../tests/instances/missions.rs"]
mod missions;
#[path = "../common/robots.rs"]
mod robots;

mod families;
mod figures;
mod picture;

use std::error::Error;
use std::path::Path;
use std::process::{Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

use carom::model::mps;
use carom::prelude::*;
use carom::reformulate;
use families::{FAMILIES, Family};
use figures::Figure;

type Done<T> = Result<T, Box<dyn Error>>;

const USAGE: &str = "usage: growth FOLDER [--large] [--limit S] [--write] [--compared FILE.json], \
                     or growth --draw FIGURES.csv PICTURE.svg";

/// The solvers that are measured.
const SOLVERS: &[&str] = if cfg!(feature = "highs") { &["carom", "HiGHS"] } else { &["carom"] };

fn main() -> ExitCode {
    match answer() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("growth: {error}");
            ExitCode::FAILURE
        }
    }
}

fn answer() -> Done<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["--draw", figures, drawn] => {
            std::fs::write(drawn, picture::picture(&figures::read(Path::new(figures))?))?;
            Ok(())
        }
        ["--solve", family, size, solver, limit] => {
            let family = Family::named(family).ok_or(USAGE)?;
            let limit = Duration::try_from_secs_f64(limit.parse()?)?;
            println!("{}", solve(family, size.parse()?, solver, limit)?);
            Ok(())
        }
        _ => run(&words),
    }
}

/// Measures all programs, and writes the table and the picture.
fn run(words: &[&str]) -> Done<()> {
    let (mut folder, mut limit, mut compared) = (None, "20", None);
    let (mut with_large, mut only_write) = (false, false);
    let mut words = words.iter().copied();
    while let Some(word) = words.next() {
        match word {
            "--large" => with_large = true,
            "--write" => only_write = true,
            "--limit" => limit = words.next().ok_or(USAGE)?,
            "--compared" => compared = Some(words.next().ok_or(USAGE)?),
            _ if word.starts_with('-') => return Err(USAGE.into()),
            _ => folder = Some(Path::new(word)),
        }
    }
    let folder = folder.ok_or(USAGE)?;
    std::fs::create_dir_all(folder)?;
    let mut found = Vec::new();
    for family in &FAMILIES {
        for size in family.sizes(with_large) {
            if only_write {
                let lowered = reformulate::lower(&family.model(size)?)?;
                let file = folder.join(figures::file_stem(family.name, size) + ".mps");
                std::fs::write(file, mps::write(lowered.model())?)?;
                continue;
            }
            for solver in SOLVERS {
                let figure = measure(family, size, solver, limit)?;
                eprintln!("{figure}");
                found.push(figure);
            }
        }
    }
    if only_write {
        return Ok(());
    }
    if let Some(path) = compared {
        found.extend(figures::compared(path, &found)?);
    }
    println!("{}", figures::table(&found));
    let kept = folder.join("growth.csv");
    figures::write(&kept, &found)?;
    // The table has fewer digits, and its picture is to be the same.
    std::fs::write(folder.join("growth.svg"), picture::picture(&figures::read(&kept)?))?;
    Ok(())
}

/// Solves a program in a process of its own.
fn measure(family: &Family, size: usize, solver: &str, limit: &str) -> Done<Figure> {
    let size = size.to_string();
    let output = Command::new(std::env::current_exe()?)
        .args(["--solve", family.name, &size, solver, limit])
        .stderr(Stdio::inherit())
        .output()?;
    let line = String::from_utf8_lossy(&output.stdout);
    let failed = || format!("{} of size {size} by {solver}: {}", family.name, output.status);
    Figure::read(line.trim_end()).ok_or_else(|| failed().into())
}

/// Solves a program in this process.
fn solve(family: &Family, size: usize, name: &str, limit: Duration) -> Done<Figure> {
    let model = family.model(size)?;
    let options = Options::default().with_time_limit(limit);
    let mut solver = solver(name, options)?;
    let (begin, cpu) = (Instant::now(), processor_seconds());
    let solution = solver.solve(&model)?;
    let elapsed = begin.elapsed().as_secs_f64();
    let seconds = processor_seconds().zip(cpu).map_or(elapsed, |(end, begin)| end - begin);
    Ok(Figure {
        family: family.name.into(),
        size,
        columns: reformulate::lower(&model)?.model().variable_count(),
        solver: name.into(),
        status: solution.termination().to_string().replace(',', ""),
        seconds,
        nodes: solution.statistics().nodes,
        megabytes: most_megabytes(),
    })
}

#[cfg(feature = "highs")]
fn solver(name: &str, options: Options) -> Done<Box<dyn Solver>> {
    Ok(match name {
        "HiGHS" => Box::new(carom::highs::HighsSolver::new(options)),
        _ => Box::new(BranchAndBound::new(options)),
    })
}

#[cfg(not(feature = "highs"))]
fn solver(name: &str, options: Options) -> Done<Box<dyn Solver>> {
    match name {
        "HiGHS" => Err("HiGHS needs the feature `highs`".into()),
        _ => Ok(Box::new(BranchAndBound::new(options))),
    }
}

/// Processor time of this thread (s), where the system tells it.
fn processor_seconds() -> Option<f64> {
    std::thread::yield_now(); // brings the count up to date
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(1e-9 * text.split_whitespace().next()?.parse::<f64>().ok()?)
}

/// The most memory that this process took (MB), where the system tells it.
fn most_megabytes() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(1e-3 * line.split_whitespace().next()?.parse::<f64>().ok()?)
}
