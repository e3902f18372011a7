//! Solves a model file, or writes it in another format.
//!
//! `cargo run --release --example solve -- FILE [--solution] [--time-limit S] [--threads K] [--gap G]
//! [--node-limit N] [--deterministic] [--with PART] [--without PART] [--symmetry] [--conflicts] [--log]
//! [--relaxation METHOD] [--pool K] [--write OUT] [--lowered OUT]`
//!
//! Files are MPS (free or fixed), LP, or JSON (with `--features serde`). The format follows from
//! the extension `.mps`, `.lp` or `.json`, otherwise from the contents.
//!
//! * `--solution`: also print the values with magnitudes above 1e-9, `name = value`
//! * `--time-limit S`: stop after S seconds
//! * `--node-limit N`: stop after N nodes
//! * `--threads K`: threads of the tree search, 1 by default
//! * `--gap G`: relative gap at which to stop, 1e-6 by default
//! * `--deterministic`: the same search for any number of threads
//! * `--without PART`: leave out `presolve` or a part of it (`reductions`, `disjunctive-tightening`,
//!   `big-m-tightening`), `probing`, `cuts`, `blocks`, a heuristic (`rounding`, `roll-out`, `diving`,
//!   `neighbourhood`, `local-branching`, `pump`) or all `heuristics`; may be given several times
//! * `--with PART`: add a heuristic, or all `heuristics`
//! * `--relaxation METHOD`: solve relaxations by `active-set` (the default: small dense ones that
//!   way, the others as by the next), `interior-point` (with Clarabel if it gives up) or `clarabel`
//!   alone
//! * `--symmetry`: order interchangeable columns
//! * `--conflicts`: learn from conflicts
//! * `--log`: progress and a summary on the standard error
//! * `--pool K`: print the proved objectives of the K best points with distinct integers
//! * `--write OUT`: write the model without solving it
//! * `--lowered OUT`: write the lowered model, with indicators and logic as rows, and solve it
//!
//! The first line is `rows=… columns=… integers=… nonzeros=…`, as read; rows include those of
//! indicators. The second one is `status=… objective=… bound=… nodes=… seconds=…`. The status is
//! `optimal`, `infeasible`, `unbounded`, `feasible` (stopped with a point that is not proved
//! optimal) or `limit` (stopped without a point). The objective is `-` if there is no point. The
//! seconds exclude reading the file.

#[macro_use]
#[path = "common/output.rs"]
mod output;

use std::error::Error;
use std::path::Path;
use std::process::ExitCode;
use std::str::FromStr;
use std::time::{Duration, Instant};

use carom::model::{Read, lp, mps};
use carom::prelude::{
    BranchAndBound, Control, Event, Log, Model, Options, Solution, Solver, Termination,
};
use carom::reformulate;
use carom::solver::{Heuristics, PoolMode, RelaxationMethod};

const USAGE: &str = "usage: solve FILE [--solution] [--time-limit S] [--threads K] [--gap G] \
                     [--node-limit N] [--deterministic] [--with PART] [--without PART] \
                     [--symmetry] [--conflicts] [--log] [--relaxation METHOD] \
                     [--pool K] [--write OUT] [--lowered OUT]";

#[derive(Default)]
struct Arguments {
    file: String,
    write: Option<String>,
    lowered: Option<String>,
    solution: bool,
    log: bool,
    options: Options,
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("solve: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn Error>> {
    let arguments = arguments()?;
    let file = &arguments.file;
    let text = text(file)?;
    let model = read(file, &text).map_err(|error| format!("{file}: {error}"))?;
    println!("{}", counts(&model));
    if let Some(path) = arguments.write {
        return write(&model, &path);
    }
    if let Some(path) = arguments.lowered {
        write(reformulate::lower(&model)?.model(), &path)?;
    }
    let start = Instant::now();
    let mut log = Log::new(std::io::stderr());
    let mut callback = |event: &Event| log.record(event);
    let mut control = Control::default();
    if arguments.log {
        control = control.with_progress(&mut callback);
    }
    let mut solver = BranchAndBound::new(arguments.options);
    let solution = solver.solve_with(&model, &mut control)?;
    let seconds = start.elapsed().as_secs_f64();
    if arguments.log {
        log.finish(&solution);
    }
    println!(
        "status={} objective={} bound={} nodes={} seconds={seconds:.6}",
        status(&solution),
        solution.objective().map_or("-".into(), twelve_digits),
        twelve_digits(solution.bound()),
        solution.statistics().nodes,
    );
    if solver.options().pool > 1 {
        let proved = if solution.pool().is_complete() { "proved" } else { "found" };
        let values = solution.pool().iter().map(|p| twelve_digits(p.objective()));
        println!("pool ({proved}): {}", values.collect::<Vec<_>>().join(" "));
    }
    if arguments.solution && solution.point().is_some() {
        for variable in model.variables() {
            let value = solution.value(variable.id())?;
            if value.abs() > 1e-9 {
                println!("{} = {}", variable.name(), twelve_digits(value));
            }
        }
    }
    Ok(())
}

/// The text of a file. If it is not text, the error says where.
fn text(path: &str) -> Result<String, String> {
    let bytes = std::fs::read(path).map_err(|error| format!("{path}: {error}"))?;
    String::from_utf8(bytes).map_err(|error| {
        let before = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let before = String::from_utf8_lossy(before);
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().map_or(0, |line| line.chars().count()) + 1;
        format!("{path}: line {line}, column {column}: this is no text in UTF-8; save it as UTF-8")
    })
}

/// The format of a file, from its extension or its contents.
fn format(path: &str, text: Option<&str>) -> Result<&'static str, Box<dyn Error>> {
    let extension = Path::new(path).extension().map(|e| e.to_string_lossy().to_lowercase());
    match (extension.as_deref(), text) {
        (Some("mps"), _) => Ok("mps"),
        (Some("lp"), _) => Ok("lp"),
        (Some("json"), _) => Ok("json"),
        (_, Some(text)) if text.trim_start().starts_with('{') => Ok("json"),
        (_, Some(text)) if text.lines().any(is_rows) => Ok("mps"),
        (_, Some(_)) => Ok("lp"),
        (_, None) => Err(format!("{path}: expected .mps, .lp or .json").into()),
    }
}

/// Whether a line begins the rows of an MPS file.
fn is_rows(line: &str) -> bool {
    line.trim_end().eq_ignore_ascii_case("ROWS")
}

fn read(path: &str, text: &str) -> Result<Model, Box<dyn Error>> {
    match format(path, Some(text))? {
        "mps" => Ok(checked(path, mps::read(text)?)),
        "lp" => Ok(checked(path, lp::read(text)?)),
        #[cfg(feature = "serde")]
        _ => Ok(serde_json::from_str(text)?),
        #[cfg(not(feature = "serde"))]
        _ => Err("JSON needs `--features serde`".into()),
    }
}

/// The model, after printing the warnings.
fn checked(path: &str, read: Read) -> Model {
    for warning in &read.warnings {
        eprintln!("warning: {path}: {warning}");
    }
    read.model
}

fn write(model: &Model, path: &str) -> Result<(), Box<dyn Error>> {
    let text = match format(path, None)? {
        "mps" => mps::write(model)?,
        "lp" => lp::write(model)?,
        #[cfg(feature = "serde")]
        _ => serde_json::to_string_pretty(model)?,
        #[cfg(not(feature = "serde"))]
        _ => return Err("JSON needs `--features serde`".into()),
    };
    Ok(std::fs::write(path, text).map_err(|error| format!("{path}: {error}"))?)
}

fn counts(model: &Model) -> String {
    let rows = model.constraint_count() + model.indicator_count();
    let integers = model.variables().filter(|variable| variable.kind().is_integral()).count();
    let linear: usize = model.constraints().map(|row| row.terms().len()).sum();
    let switched: usize = model.indicators().map(|row| row.terms().len()).sum();
    let (columns, nonzeros) = (model.variable_count(), linear + switched);
    format!("rows={rows} columns={columns} integers={integers} nonzeros={nonzeros}")
}

fn arguments() -> Result<Arguments, Box<dyn Error>> {
    let mut arguments = Arguments::default();
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value\n{USAGE}"));
        match word.as_str() {
            "--solution" => arguments.solution = true,
            "--time-limit" => {
                let seconds = number(&word, &value()?)?;
                arguments.options.time_limit = Some(Duration::try_from_secs_f64(seconds)?);
            }
            "--threads" => arguments.options.threads = number(&word, &value()?)?,
            "--deterministic" => arguments.options.deterministic = true,
            "--log" => arguments.log = true,
            "--pool" => {
                arguments.options.pool = number(&word, &value()?)?;
                arguments.options.pool_mode = PoolMode::Best;
            }
            "--node-limit" => arguments.options.node_limit = Some(number(&word, &value()?)?),
            "--without" => match value()?.as_str() {
                "presolve" => arguments.options = arguments.options.with_presolve(false),
                "reductions" => arguments.options.reductions = false,
                "disjunctive-tightening" => arguments.options.disjunctive_tightening = false,
                "big-m-tightening" => arguments.options.big_m_tightening = false,
                "probing" => arguments.options.probing = false,
                "cuts" => arguments.options.cuts = false,
                "blocks" => arguments.options.blocks = false,
                part => switch(&mut arguments.options.heuristics, part, false)?,
            },
            "--with" => switch(&mut arguments.options.heuristics, &value()?, true)?,
            "--relaxation" => arguments.options.relaxation = method(&value()?)?,
            "--conflicts" => arguments.options.conflicts = true,
            "--symmetry" => arguments.options.symmetry = true,
            "--gap" => arguments.options.relative_gap = number(&word, &value()?)?,
            "--write" => arguments.write = Some(value()?),
            "--lowered" => arguments.lowered = Some(value()?),
            _ if word.starts_with("--") || !arguments.file.is_empty() => {
                return Err(format!("unexpected `{word}`\n{USAGE}").into());
            }
            _ => arguments.file = word,
        }
    }
    if arguments.file.is_empty() { Err(USAGE.into()) } else { Ok(arguments) }
}

/// Switches a heuristic, or all of them.
fn switch(heuristics: &mut Heuristics, part: &str, on: bool) -> Result<(), String> {
    match part {
        "heuristics" => *heuristics = if on { Heuristics::all() } else { Heuristics::none() },
        "rounding" => heuristics.rounding = on,
        "diving" => heuristics.diving = on,
        "neighbourhood" => heuristics.neighbourhood = on,
        "local-branching" => heuristics.local_branching = on,
        "roll-out" => heuristics.roll_out = on,
        "pump" => heuristics.pump = on,
        _ => return Err(format!("nothing is called `{part}`\n{USAGE}")),
    }
    Ok(())
}

/// The method of relaxations with a name.
fn method(name: &str) -> Result<RelaxationMethod, String> {
    let found = RelaxationMethod::ALL.into_iter().find(|method| method.to_string() == name);
    found.ok_or_else(|| format!("no method is called `{name}`\n{USAGE}"))
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
