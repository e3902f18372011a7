//! Solves an MPS file and prints one line.
//!
//! `cargo run --release --example solve -- FILE.mps [--time-limit S] [--threads K] [--gap G]
//! [--lowered OUT.mps]`
//!
//! * `--time-limit S`: stop after S seconds
//! * `--threads K`: threads of the tree search, 1 by default
//! * `--gap G`: relative gap at which to stop, 1e-6 by default
//! * `--lowered OUT.mps`: also write the model with its indicators as big-M rows
//!
//! The line is `status=… objective=… bound=… nodes=… seconds=…`. The status is `optimal`,
//! `infeasible`, `unbounded`, `feasible` (stopped with a point that is not proved optimal) or
//! `limit` (stopped without a point); the objective is `-` where there is no point. Reading the
//! file is not part of the seconds.

use std::error::Error;
use std::process::ExitCode;
use std::str::FromStr;
use std::time::{Duration, Instant};

use carom::model::mps;
use carom::prelude::{BranchAndBound, Options, Solution, Solver, Termination};
use carom::reformulate;

const USAGE: &str =
    "usage: solve FILE.mps [--time-limit S] [--threads K] [--gap G] [--lowered OUT.mps]";

fn main() -> ExitCode {
    match run() {
        Ok(line) => {
            println!("{line}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("solve: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<String, Box<dyn Error>> {
    let (file, lowered, options) = arguments()?;
    let text = std::fs::read_to_string(&file).map_err(|error| format!("{file}: {error}"))?;
    let model = mps::read(&text).map_err(|error| format!("{file}: {error}"))?;
    if let Some(path) = lowered {
        let text = mps::write(reformulate::lower(&model)?.model())?;
        std::fs::write(&path, text).map_err(|error| format!("{path}: {error}"))?;
    }
    let start = Instant::now();
    let solution = BranchAndBound::new(options).solve(&model)?;
    let seconds = start.elapsed().as_secs_f64();
    Ok(format!(
        "status={} objective={} bound={} nodes={} seconds={seconds:.6}",
        status(&solution),
        solution.objective().map_or("-".into(), twelve_digits),
        twelve_digits(solution.bound()),
        solution.statistics().nodes,
    ))
}

/// The file, where to write the lowered model, and the options.
fn arguments() -> Result<(String, Option<String>, Options), Box<dyn Error>> {
    let (mut file, mut lowered, mut options) = (None, None, Options::default());
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value\n{USAGE}"));
        match word.as_str() {
            "--time-limit" => {
                let seconds = number(&word, &value()?)?;
                options.time_limit = Some(Duration::try_from_secs_f64(seconds)?);
            }
            "--threads" => options.threads = number(&word, &value()?)?,
            "--gap" => options.relative_gap = number(&word, &value()?)?,
            "--lowered" => lowered = Some(value()?),
            _ if word.starts_with("--") || file.is_some() => {
                return Err(format!("unexpected `{word}`\n{USAGE}").into());
            }
            _ => file = Some(word),
        }
    }
    Ok((file.ok_or(USAGE)?, lowered, options))
}

fn number<T: FromStr>(option: &str, text: &str) -> Result<T, String> {
    text.parse().map_err(|_| format!("{option} cannot be `{text}`"))
}

fn status(solution: &Solution) -> &'static str {
    match solution.termination() {
        Termination::Optimal => "optimal",
        Termination::Infeasible => "infeasible",
        Termination::Unbounded => "unbounded",
        _ if solution.point().is_some() => "feasible",
        _ => "limit",
    }
}

/// A number rounded to twelve significant digits, without trailing zeros.
fn twelve_digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.11e}").parse().unwrap_or(value);
    format!("{}", rounded + 0.0) // no minus sign before a zero
}
