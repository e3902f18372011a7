//! Solves a model file, or writes it in another format.
//!
//! `cargo run --release --example solve -- FILE [OPTIONS]`; `--help` lists the options.
//!
//! Files are MPS (free or fixed), LP, CBF, or JSON (with `--features serde`). The format follows from
//! the extension `.mps`, `.lp`, `.cbf` or `.json`, otherwise from the contents.
//!
//! The first line of the output is `rows=… columns=… integers=… nonzeros=…`, as read; rows include
//! those of indicators, and ` cones=…` follows if there are norms or quadratic rows. The last line is
//! `status=… objective=… bound=… nodes=… seconds=…`. The status
//! is `optimal`, `infeasible`, `unbounded`, `feasible` (stopped with a point that is not proved
//! optimal) or `limit` (stopped without a point). The objective is `-` if there is no point. The
//! seconds exclude reading the file. A summary for people is on the standard error, and so is a
//! progress bar if that is a terminal.

#[macro_use]
#[path = "common/output.rs"]
mod output;
#[path = "common/bar.rs"]
mod bar;
#[path = "common/sol.rs"]
mod sol;

use std::error::Error;
use std::path::Path;
use std::process::ExitCode;
use std::str::FromStr;
use std::time::{Duration, Instant};

use carom::model::{Read, cbf, lp, mps};
use carom::prelude::{
    BranchAndBound, Control, Event, Log, Model, Options, Solution, Solver, Termination,
};
use carom::reformulate;
use carom::solution::StartStatus;
use carom::solver::{Heuristics, MipStart, PoolMode, RelaxationMethod};

use bar::Bar;

const USAGE: &str = "usage: solve FILE [OPTIONS]; `solve --help` lists the options";

const HELP: &str = "\
Solves a model file (MPS, LP, CBF, or JSON with `--features serde`), or writes it in another format.

usage: solve FILE [OPTIONS]

  --solution           print the values with magnitudes above 1e-9, `name = value`
  --start FILE.sol     begin with the integers of a point: lines `name value` or `name = value`;
                       integers that are not named are 0
  --time-limit S       stop after S seconds
  --node-limit N       stop after N nodes
  --gap G              relative gap at which to stop, 1e-6 by default
  --threads K          threads of the tree search, 1 by default
  --deterministic      the same search for any number of threads
  --pool K             print the proved objectives of the K best points with distinct integers
  --log                progress in lines and a long summary on the standard error
  --write OUT          write the model without solving it
  --lowered OUT        write the lowered model, with indicators and logic as rows, and solve it
  --without PART       leave out `presolve` or a part of it (`reductions`, `disjunctive-tightening`,
                       `big-m-tightening`), `probing`, `cuts`, `blocks`, a heuristic (`rounding`,
                       `roll-out`, `diving`, `neighbourhood`) or all
                       `heuristics`; may be given several times
  --with PART          add a heuristic, or all `heuristics`
  --relaxation METHOD  solve relaxations by `automatic` (the default: dual simplex or active set
                       where they suit, else as by the next), `interior-point` (with Clarabel if
                       it gives up) or `clarabel` alone
  --help               print this";

#[derive(Default)]
struct Arguments {
    file: String,
    write: Option<String>,
    lowered: Option<String>,
    start: Option<String>,
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
    let Some(arguments) = arguments()? else {
        println!("{HELP}");
        return Ok(());
    };
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
    let mip_start = arguments.start.map(|path| start(&model, &path)).transpose()?;
    let threads = arguments.options.threads;
    let (start, cpu) = (Instant::now(), processor_seconds(threads));
    let (mut log, bar) = (Log::new(std::io::stderr()), Bar::new());
    let mut lines = |event: &Event| log.record(event);
    let mut line = |event: &Event| bar.show(event);
    let mut control = if arguments.log {
        Control::default().with_progress(&mut lines)
    } else {
        Control::default().with_progress(&mut line)
    };
    if let Some(start) = &mip_start {
        control = control.with_start(start);
    }
    let mut solver = BranchAndBound::new(arguments.options);
    let solution = solver.solve_with(&model, &mut control);
    bar.clear();
    let (solution, seconds) = (solution?, start.elapsed().as_secs_f64());
    let spent =
        processor_seconds(threads).zip(cpu).map(|(end, start)| format!(" cpu={:.6}", end - start));
    if let Some(report) = solution.start_report() {
        eprintln!("{}", start_report(report.status.as_ref()));
    }
    if arguments.log {
        log.finish(&solution);
    } else {
        eprintln!("{}", summary(&solution, seconds));
    }
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
    println!(
        "status={} objective={} bound={} nodes={} seconds={seconds:.6}{}",
        status(&solution),
        solution.objective().map_or("-".into(), twelve_digits),
        twelve_digits(solution.bound()),
        solution.statistics().nodes,
        spent.unwrap_or_default(),
    );
    Ok(())
}

/// Processor time of this thread (s), or of the process if the search has several, where the system tells
/// it: not disturbed by other programs.
fn processor_seconds(threads: usize) -> Option<f64> {
    if threads > 1 {
        // User and system time, in hundredths of a second, are the 14th and 15th word; the 2nd is in
        // parentheses and may have blanks.
        let text = std::fs::read_to_string("/proc/self/stat").ok()?;
        let times = text.rsplit(')').next()?.split_whitespace().skip(11).take(2);
        return times.map(|ticks| Some(0.01 * ticks.parse::<f64>().ok()?)).sum();
    }
    std::thread::yield_now(); // brings the count up to date
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = text.split_whitespace().next()?.parse().ok()?;
    Some(1e-9 * nanoseconds)
}

/// The MIP start of a file.
fn start(model: &Model, path: &str) -> Result<MipStart, String> {
    let values = sol::integers(model, &text(path)?).map_err(|error| format!("{path}: {error}"))?;
    Ok(MipStart::new().with_values(values))
}

/// What became of the MIP start.
fn start_report(status: Option<&StartStatus>) -> String {
    match status {
        Some(StartStatus::Accepted) => "start: accepted".into(),
        Some(StartStatus::Repaired { changed }) => {
            format!("start: repaired, {} integers differ", changed.len())
        }
        Some(StartStatus::Rejected { reason }) => format!("start: rejected, {reason}"),
        _ => "start: not tried, because the answer was known before".into(),
    }
}

/// The outcome in a line.
fn summary(solution: &Solution, seconds: f64) -> String {
    let statistics = solution.statistics();
    let effort = format!(
        "{seconds:.2} s, {} nodes and {} relaxations",
        statistics.nodes, statistics.relaxations
    );
    let found = match solution.objective() {
        Some(objective) => format!(
            "objective {}, proved bound {}, gap {}",
            twelve_digits(objective),
            twelve_digits(solution.bound()),
            percent(solution.relative_gap())
        ),
        None => "no point".into(),
    };
    let notes: String = solution.notes().iter().map(|note| format!("\n{note}")).collect();
    let refused = solution.refused().and_then(|check| check.violations().first());
    let refused = refused.map_or(String::new(), |violation| {
        format!("; the nearest point that was refused violates {violation}")
    });
    format!("{}: {found}, after {effort}{refused}{notes}", solution.termination())
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
        (Some("cbf"), _) => Ok("cbf"),
        (Some("json"), _) => Ok("json"),
        (_, Some(text)) if text.trim_start().starts_with('{') => Ok("json"),
        (_, Some(text)) if text.lines().any(is_rows) => Ok("mps"),
        (_, Some(text)) if text.lines().any(|line| line.trim_end() == "VER") => Ok("cbf"),
        (_, Some(_)) => Ok("lp"),
        (_, None) => Err(format!("{path}: expected .mps, .lp, .cbf or .json").into()),
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
        "cbf" => Ok(checked(path, cbf::read(text)?)),
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
        "cbf" => cbf::write(model)?,
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
    let cones = match model.conic_constraint_count() {
        0 => String::new(),
        cones => format!(" cones={cones}"),
    };
    format!("rows={rows} columns={columns} integers={integers} nonzeros={nonzeros}{cones}")
}

/// The arguments; `None` if help is asked for.
fn arguments() -> Result<Option<Arguments>, Box<dyn Error>> {
    let mut arguments = Arguments::default();
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value\n{USAGE}"));
        match word.as_str() {
            "--help" | "-h" => return Ok(None),
            "--solution" => arguments.solution = true,
            "--start" => arguments.start = Some(value()?),
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
            "--gap" => arguments.options.relative_gap = number(&word, &value()?)?,
            "--write" => arguments.write = Some(value()?),
            "--lowered" => arguments.lowered = Some(value()?),
            _ if word.starts_with("--") || !arguments.file.is_empty() => {
                return Err(format!("unexpected `{word}`\n{USAGE}").into());
            }
            _ => arguments.file = word,
        }
    }
    if arguments.file.is_empty() { Err(USAGE.into()) } else { Ok(Some(arguments)) }
}

/// Switches a heuristic, or all of them.
fn switch(heuristics: &mut Heuristics, part: &str, on: bool) -> Result<(), String> {
    match part {
        "heuristics" => *heuristics = if on { Heuristics::default() } else { Heuristics::none() },
        "rounding" => heuristics.rounding = on,
        "diving" => heuristics.diving = on,
        "neighbourhood" => heuristics.neighbourhood = on,
        "roll-out" => heuristics.roll_out = on,
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

/// A number rounded to twelve significant digits, without trailing zeros; below 1e-6 with an exponent.
/// A zero has no sign, and less than all normal numbers is 0.
fn twelve_digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.11e}").parse().unwrap_or(value);
    match rounded.abs() {
        size if size < f64::MIN_POSITIVE => "0".into(),
        size if size < 1e-6 => format!("{rounded:e}"),
        _ => format!("{rounded}"),
    }
}

/// A gap in percent, or `none` without a bound.
fn percent(gap: f64) -> String {
    let percent = 100.0 * gap;
    match percent {
        _ if !percent.is_finite() => "none".into(),
        _ if percent < f64::MIN_POSITIVE => "0 %".into(),
        _ if !(1e-4..1e5).contains(&percent) => format!("{percent:.1e} %"),
        _ => format!("{percent:.4} %"),
    }
}
