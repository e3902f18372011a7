//! The dialects of CBC, GLPK, HiGHS and SCIP.

use std::path::Path;

use web_time::Duration;

use super::dialect::{Dialect, ExternalAnswer, Files, SolverClaim};
use crate::solution::Termination;
use crate::solver::Options;

fn text(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}

/// The number after a label, on the last line of a log that has this label.
fn labelled(printed: &str, label: &str) -> Option<f64> {
    let line = printed.lines().rev().find_map(|line| line.trim_start().strip_prefix(label))?;
    let number = line.trim_start_matches([' ', ':', '=', '\t']);
    number.split_whitespace().next()?.parse().ok().filter(|value: &f64| value.abs() < 1e20)
}

fn number(word: Option<&str>) -> Option<f64> {
    word?.parse().ok()
}

/// COIN-OR CBC 2.10: `cbc model.mps ... -solve -solution file`.
#[doc(hidden)]
#[derive(Debug, Clone, Copy)]
pub struct Cbc;

impl Dialect for Cbc {
    fn program(&self) -> &str {
        "cbc"
    }

    fn arguments(&self, files: &Files, options: &Options, time: Option<Duration>) -> Vec<String> {
        let mut arguments = vec![text(&files.model)];
        let mut set = |name: &str, value: String| arguments.extend([name.to_owned(), value]);
        set("-ratioGap", options.relative_gap.to_string());
        set("-allowableGap", options.absolute_gap.to_string());
        set("-integerTolerance", options.integrality.max(1e-9).to_string());
        set("-threads", options.threads.to_string());
        if let Some(time) = time {
            set("-timeMode", "elapsed".into());
            set("-sec", time.as_secs_f64().to_string());
        }
        if let Some(nodes) = options.node_limit {
            set("-maxNodes", nodes.to_string());
        }
        arguments.push("-solve".into());
        arguments.extend(["-solution".into(), text(&files.solution)]);
        arguments
    }

    fn read(&self, solution: Option<&str>, printed: &str) -> Result<ExternalAnswer, String> {
        let solution = solution.ok_or("it wrote no solution")?;
        let mut lines = solution.lines();
        let first = lines.next().ok_or("its solution is empty")?;
        let lower = first.to_lowercase();
        let claim = if lower.starts_with("optimal") {
            SolverClaim::Optimal
        } else if lower.contains("infeasible") {
            SolverClaim::Infeasible
        } else if lower.contains("unbounded") {
            SolverClaim::Unbounded
        } else if lower.contains("stopped on time") {
            SolverClaim::Limit(Termination::TimeLimit)
        } else if lower.contains("stopped on nodes") || lower.contains("stopped on iterations") {
            SolverClaim::Limit(Termination::NodeLimit)
        } else {
            SolverClaim::Unknown
        };
        let mut answer = ExternalAnswer::new(claim);
        answer.bound = labelled(printed, "Lower bound:");
        answer.nodes = labelled(printed, "Enumerated nodes:").map(|nodes| nodes as u64);
        let no_point = lower.contains("no integer solution");
        if matches!(claim, SolverClaim::Optimal | SolverClaim::Limit(_)) && !no_point {
            answer.objective = number(first.split_whitespace().last());
            // `** 3 c2 1.5 0`: position, name, value, reduced cost; stars mark missed rows.
            let value = |line: &str| {
                let mut words = line.split_whitespace().filter(|word| *word != "**").skip(1);
                Some((words.next()?.to_owned(), number(words.next())?))
            };
            let values: Option<Vec<_>> = lines.map(value).collect();
            answer.values = Some(values.ok_or("its solution has a line without a value")?);
        }
        Ok(answer)
    }
}

/// GLPK 5: `glpsol --freemps model.mps --write file`.
#[doc(hidden)]
#[derive(Debug, Clone, Copy)]
pub struct Glpk;

impl Dialect for Glpk {
    fn program(&self) -> &str {
        "glpsol"
    }

    fn arguments(&self, files: &Files, options: &Options, time: Option<Duration>) -> Vec<String> {
        let mut arguments = vec!["--freemps".into(), text(&files.model)];
        arguments.extend(["--mipgap".into(), options.relative_gap.to_string()]);
        if let Some(time) = time {
            arguments.extend(["--tmlim".into(), time.as_secs_f64().ceil().to_string()]);
        }
        arguments.extend(["--write".into(), text(&files.solution)]);
        arguments
    }

    fn read(&self, solution: Option<&str>, printed: &str) -> Result<ExternalAnswer, String> {
        let solution = solution.ok_or("it wrote no solution")?;
        let mut answer = ExternalAnswer::new(SolverClaim::Unknown);
        let mut values = Vec::new();
        for line in solution.lines() {
            let words: Vec<&str> = line.split_whitespace().collect();
            match words[..] {
                // Status and objective: `s mip rows columns status value`, or for a program
                // without integers `s bas rows columns primal dual value`.
                ["s", "mip", _, _, status, value] => {
                    answer.claim = match status {
                        "o" => SolverClaim::Optimal,
                        "n" => SolverClaim::Infeasible,
                        _ => SolverClaim::Unknown,
                    };
                    let found = matches!(status, "o" | "f");
                    answer.objective = number(Some(value)).filter(|_| found);
                }
                ["s", "bas", _, _, primal, dual, value] => {
                    answer.claim = match (primal, dual) {
                        ("f", "f") => SolverClaim::Optimal,
                        ("n", _) => SolverClaim::Infeasible,
                        (_, "n") => SolverClaim::Unbounded,
                        _ => SolverClaim::Unknown,
                    };
                    let found = answer.claim == SolverClaim::Optimal;
                    answer.objective = number(Some(value)).filter(|_| found);
                }
                ["j", column, value] | ["j", column, _, value, _] => {
                    let column: usize = column.parse().map_err(|_| "a column has no number")?;
                    let value = number(Some(value)).ok_or("a column has no value")?;
                    // Columns count from 1, in the order of the file.
                    values.push((format!("c{}", column.saturating_sub(1)), value));
                }
                _ => {}
            }
        }
        let says = |text: &str| printed.contains(text);
        if answer.claim == SolverClaim::Unknown {
            if says("TIME LIMIT EXCEEDED") {
                answer.claim = SolverClaim::Limit(Termination::TimeLimit);
            } else if says("HAS NO PRIMAL FEASIBLE SOLUTION") {
                answer.claim = SolverClaim::Infeasible;
            } else if says("HAS UNBOUNDED PRIMAL SOLUTION") || says("HAS NO DUAL FEASIBLE SOLUTION")
            {
                answer.claim = SolverClaim::Unbounded;
            }
        }
        answer.values = answer.objective.is_some().then_some(values);
        Ok(answer)
    }
}

/// HiGHS 1: `highs --options_file settings --solution_file file model.mps`.
#[doc(hidden)]
#[derive(Debug, Clone, Copy)]
pub struct Highs;

impl Dialect for Highs {
    fn program(&self) -> &str {
        "highs"
    }

    fn arguments(&self, files: &Files, _: &Options, _: Option<Duration>) -> Vec<String> {
        let (settings, solution) = (text(&files.settings), text(&files.solution));
        let model = text(&files.model);
        ["--options_file", &settings, "--solution_file", &solution, &model].map(String::from).into()
    }

    fn settings(&self, options: &Options, time: Option<Duration>) -> Option<String> {
        let mut lines = vec![
            format!("mip_rel_gap = {}", options.relative_gap),
            format!("mip_abs_gap = {}", options.absolute_gap),
            format!("threads = {}", options.threads),
        ];
        lines.extend(time.map(|time| format!("time_limit = {}", time.as_secs_f64())));
        lines.extend(options.node_limit.map(|nodes| format!("mip_max_nodes = {nodes}")));
        lines.push(String::new());
        Some(lines.join("\n"))
    }

    fn read(&self, solution: Option<&str>, printed: &str) -> Result<ExternalAnswer, String> {
        let solution = solution.ok_or("it wrote no solution")?;
        let mut lines = solution.lines();
        let status = lines.by_ref().skip_while(|line| !line.starts_with("Model status")).nth(1);
        let status = status.ok_or("its solution names no status")?.trim();
        let mut answer = ExternalAnswer::new(match status {
            "Optimal" => SolverClaim::Optimal,
            "Infeasible" => SolverClaim::Infeasible,
            // A second run without the objective tells which.
            "Unbounded" | "Primal infeasible or unbounded" => SolverClaim::Unbounded,
            "Time limit reached" => SolverClaim::Limit(Termination::TimeLimit),
            "Solution limit reached" => SolverClaim::Limit(Termination::NodeLimit),
            _ => SolverClaim::Unknown,
        });
        if status == "Empty" {
            // Neither columns nor rows.
            (answer.claim, answer.objective, answer.values) =
                (SolverClaim::Optimal, Some(0.0), Some(Vec::new()));
            return Ok(answer);
        }
        answer.bound = labelled(printed, "Dual bound");
        answer.nodes = labelled(printed, "Nodes").map(|nodes| nodes as u64);
        let mut feasible = false;
        while let Some(line) = lines.next() {
            if line == "Feasible" {
                feasible = true;
            } else if let Some(value) = line.strip_prefix("Objective ").filter(|_| feasible) {
                answer.objective = number(Some(value.trim()));
            } else if let Some(count) = line.strip_prefix("# Columns ").filter(|_| feasible) {
                let count: usize = count.trim().parse().map_err(|_| "it counts no columns")?;
                let value = |line: &str| {
                    let (name, value) = line.rsplit_once(' ')?;
                    Some((name.to_owned(), number(Some(value))?))
                };
                let values: Option<Vec<_>> = lines.by_ref().take(count).map(value).collect();
                answer.values = Some(values.ok_or("its solution has a line without a value")?);
                break;
            }
        }
        Ok(answer)
    }
}

/// SCIP 8 to 10: `scip -c "read ..." ...`.
#[doc(hidden)]
#[derive(Debug, Clone, Copy)]
pub struct Scip;

impl Dialect for Scip {
    fn program(&self) -> &str {
        "scip"
    }

    fn takes_quadratic(&self) -> bool {
        true
    }

    fn takes_cones(&self) -> bool {
        true
    }

    fn arguments(&self, files: &Files, options: &Options, time: Option<Duration>) -> Vec<String> {
        let mut commands = vec![
            format!("set limits gap {}", options.relative_gap),
            format!("set limits absgap {}", options.absolute_gap),
        ];
        commands.extend(time.map(|time| format!("set limits time {}", time.as_secs_f64())));
        commands.extend(options.node_limit.map(|nodes| format!("set limits nodes {nodes}")));
        commands.push(format!("read {}", text(&files.model)));
        commands.push("optimize".into());
        commands.push("display statistics".into());
        commands.push(format!("write solution {}", text(&files.solution)));
        commands.push("quit".into());
        commands.into_iter().flat_map(|command| ["-c".to_owned(), command]).collect()
    }

    fn read(&self, solution: Option<&str>, printed: &str) -> Result<ExternalAnswer, String> {
        let status = printed.lines().rev().find_map(|line| line.strip_prefix("SCIP Status"));
        let status = status.ok_or("it printed no status")?;
        let says = |text: &str| status.contains(text);
        let mut answer =
            ExternalAnswer::new(if says("[optimal solution found]") || says("[gap limit") {
                SolverClaim::Optimal
            } else if says("[infeasible]") {
                SolverClaim::Infeasible
            } else if says("[unbounded]") || says("[infeasible or unbounded]") {
                // A second run without the objective tells which.
                SolverClaim::Unbounded
            } else if says("[time limit reached]") {
                SolverClaim::Limit(Termination::TimeLimit)
            } else if says("[node limit reached]") || says("[total node limit reached]") {
                SolverClaim::Limit(Termination::NodeLimit)
            } else {
                SolverClaim::Unknown
            });
        answer.bound = labelled(printed, "Dual Bound");
        answer.nodes = labelled(printed, "Solving Nodes").map(|nodes| nodes as u64);
        let solution = solution.unwrap_or("");
        answer.objective = labelled(solution, "objective value:");
        if answer.objective.is_some() {
            let lines = solution.lines().skip_while(|line| !line.starts_with("objective value:"));
            let value = |line: &str| {
                let mut words = line.split_whitespace();
                Some((words.next()?.to_owned(), number(words.next())?))
            };
            let values = lines.skip(1).filter(|line| !line.trim().is_empty()).map(value);
            let values: Option<Vec<_>> = values.collect();
            answer.values = Some(values.ok_or("its solution has a line without a value")?);
        }
        Ok(answer)
    }
}
