//! The answer: in a line for programs, in words for people, and as a file.

use std::fs::{self, OpenOptions};
use std::io;
use std::path::Path;

use carom::explain::Explanation;
use carom::model::Name;
use carom::prelude::{Model, Solution, Termination, VariableKind};
use carom::solution::{ProofReport, StartStatus};

/// The last line of the output.
pub(crate) fn status_line(solution: &Solution, seconds: f64, cpu: Option<f64>) -> String {
    format!(
        "status={} objective={} bound={} nodes={} seconds={seconds:.6}{}",
        status(solution),
        solution.objective().map_or("-".into(), |value| objective(solution, value)),
        bound(solution),
        solution.statistics().nodes,
        cpu.map_or(String::new(), |cpu| format!(" cpu={cpu:.6}")),
    )
}

/// The objectives of the pool.
pub(crate) fn pool(solution: &Solution) -> String {
    let proved = if solution.pool().is_complete() { "proved" } else { "found" };
    let values = solution.pool().iter().map(|p| twelve_digits(p.objective()));
    format!("pool ({proved}): {}", values.collect::<Vec<_>>().join(" "))
}

/// The values of the best point that are not tiny, a line each.
pub(crate) fn values(model: &Model, solution: &Solution) -> Vec<String> {
    let Some(point) = solution.point() else { return Vec::new() };
    let values = model.variables().zip(point.as_slice()).filter(|(_, value)| value.abs() > 1e-9);
    values
        .map(|(variable, value)| format!("{} = {}", variable.name(), twelve_digits(*value)))
        .collect()
}

/// A count with what is counted, which is one or several of it.
pub(crate) fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// Makes sure that a file can be written, before the work that leads to it. Leaves no file behind.
pub(crate) fn check(path: &str) -> Result<(), String> {
    try_to_open(Path::new(path)).map_err(|error| format!("{path}: {error}"))
}

fn try_to_open(path: &Path) -> io::Result<()> {
    match fs::metadata(path) {
        Ok(found) if found.is_dir() => Err(io::ErrorKind::IsADirectory.into()),
        Ok(found) if found.is_file() => OpenOptions::new().append(true).open(path).map(drop),
        // The reader of a pipe would take the end of this for the end of the answer.
        Ok(_) => Ok(()),
        // A link to a file that is still to be made.
        Err(_) if path.is_symlink() => Ok(()),
        Err(_) => {
            OpenOptions::new().write(true).create_new(true).open(path)?;
            fs::remove_file(path)
        }
    }
}

/// Writes the best point to a file that `--start` reads: a line for every value but 0, with all
/// digits.
pub(crate) fn write(model: &Model, solution: &Solution, path: &str) -> Result<(), String> {
    let mut text = format!("# Status: {}\n", status(solution));
    if let (Some(point), Some(objective)) = (solution.point(), solution.objective()) {
        text += &format!("# Objective value = {objective}\n");
        for (variable, value) in model.variables().zip(point.as_slice()) {
            if *value != 0.0 {
                text += &format!("{} {value}\n", variable.name());
            }
        }
    }
    fs::write(path, text).map_err(|error| format!("{path}: {error}"))
}

/// The line about the MIP start.
pub(crate) fn start_report(status: Option<&StartStatus>) -> String {
    match status {
        Some(StartStatus::Accepted) => "start: accepted".into(),
        Some(StartStatus::Repaired { changed }) => {
            let differ = if changed.len() == 1 { "integer differs" } else { "integers differ" };
            format!("start: repaired, {} {differ}", changed.len())
        }
        Some(StartStatus::Rejected { reason }) => format!("start: rejected, {reason}"),
        _ => "start: not tried, because the answer was known before".into(),
    }
}

/// The outcome in a line.
pub(crate) fn summary(model: &Model, solution: &Solution, seconds: f64) -> String {
    let statistics = solution.statistics();
    let effort = format!(
        "{seconds:.2} s, {} and {}",
        counted(statistics.nodes as usize, "node"),
        counted(statistics.relaxations as usize, "relaxation")
    );
    let found = match solution.objective() {
        Some(value) => format!(
            "objective {}, proved bound {}, gap {}{}",
            objective(solution, value),
            bound(solution),
            percent(solution.relative_gap()),
            without_constant(model, solution, value)
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

/// That a gap is relative to the objective without its constant, if there is a gap and that makes a
/// difference.
fn without_constant(model: &Model, solution: &Solution, objective: f64) -> String {
    let fixed = |variable| {
        let bounds = model.variable_ref(variable).ok()?.bounds();
        (bounds.lower == bounds.upper).then_some(bounds.lower)
    };
    let terms = model.objective().affine().terms();
    let sum: f64 = terms.iter().filter_map(|&(v, cost)| Some(cost * fixed(v)?)).sum();
    let constant = model.objective().affine().offset() + sum;
    let is_smaller = (objective - constant).abs() < objective.abs();
    match is_smaller && solution.relative_gap() > 0.0 {
        true => format!(" of the objective without its constant {}", twelve_digits(constant)),
        false => String::new(),
    }
}

/// The domains that play a part in a contradiction, with their bounds.
pub(crate) fn domains(model: &Model, explanation: &Explanation, is_lp: bool) -> Vec<String> {
    let line = |name: &Name| {
        let variable = model.variable_ref(model.variable_by_name(name.clone()).ok()?).ok()?;
        let bounds = variable.bounds();
        if variable.kind() == VariableKind::Binary && (bounds.lower, bounds.upper) == (0.0, 1.0) {
            return Some(format!("domain: {name} is 0 or 1"));
        }
        let is_default = is_lp && bounds.lower == 0.0 && !variable.kind().is_integral();
        let default = match (is_default, bounds.upper.is_infinite()) {
            (true, true) => " (the default of LP files, where the file gives no bounds)",
            (true, false) => " (a lower bound of 0 is the default of LP files)",
            _ => "",
        };
        let lower =
            if bounds.lower.is_finite() { format!("{} <= ", bounds.lower) } else { String::new() };
        let upper =
            if bounds.upper.is_finite() { format!(" <= {}", bounds.upper) } else { String::new() };
        Some(format!("domain: {lower}{name}{upper}{default}"))
    };
    explanation.domains().iter().filter_map(line).collect()
}

/// The line about a proof that was written: how far, and what it claims. The bound has all digits.
pub(crate) fn proof_line(proof: &ProofReport) -> String {
    let ProofReport { commands, bytes, bound, failure, .. } = proof;
    let state = match (failure, proof.is_complete) {
        (Some(_), _) => "failed",
        (None, true) => "complete",
        (None, false) => "incomplete",
    };
    let claim = match bound {
        Some(bound) => format!("bound bound={bound}"),
        None => "infeasible".to_owned(),
    };
    match failure {
        Some(_) => format!("proof={state}"),
        None => format!("proof={state} claim={claim} commands={commands} bytes={bytes}"),
    }
}

/// An objective, without what rounding has left of 0.
fn objective(solution: &Solution, value: f64) -> String {
    twelve_digits(solution.cleaned(value))
}

/// The bound; `-` where no bound is possible.
fn bound(solution: &Solution) -> String {
    match solution.termination() {
        Termination::Unbounded => "-".to_owned(),
        _ => objective(solution, solution.bound()),
    }
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

/// A number rounded to twelve significant digits, without trailing zeros; below 1e-6 with an
/// exponent. A zero has no sign, and less than all normal numbers is 0.
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
