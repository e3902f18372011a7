//! The call of AMPL's solvers, `carom STUB -AMPL [OPTION=VALUE ...]`: reads `STUB.nl` and writes
//! `STUB.sol` (D. M. Gay, "Hooking your solver to AMPL", 1997).

use std::process::ExitCode;
use std::time::Instant;

use carom::model::nl::{self, SolFile};
use carom::prelude::*;

use crate::arguments::{duration, number};
use crate::interrupts::Signals;
use crate::live::Live;
use crate::{NAME, WRONG_ARGUMENTS, answer, coded, guessed, header, input};

/// The variable of the environment in which AMPL hands options over.
const ENVIRONMENT: &str = "carom_options";

pub(crate) const OPTIONS: &str = "\
Options of the call `STUB -AMPL [OPTION=VALUE ...]`, also in the variable `carom_options` of the environment, where
they may be given as `OPTION VALUE`:

  timelim S        stop after S seconds
  nodelim N        stop after N nodes
  mipgap G         relative gap at which to stop, 1e-6 by default
  absmipgap G      absolute gap at which to stop, in the unit of the objective
  threads K        threads of the search, 1 by default
  deterministic 1  the same search for any number of threads
  mipstart 0       do not begin with the values in the file
  objno 0          look for any point; 1, the first objective, is the default
  outlev 1         show the progress on the standard error
  proof FILE       write a proof of the bound, or that there is no point, for `carom-proof check`";

/// Whether the words are AMPL's call.
pub(crate) fn is_called(words: &[String]) -> bool {
    words.iter().any(|word| word == "-AMPL")
}

/// The request that the options make.
struct Asked {
    options: Options,
    has_start: bool,
    has_objective: bool,
    is_shown: bool,
}

/// Answers the call. Whatever becomes of the program is in the answer; the exit status tells only
/// whether it could be written.
pub(crate) fn run(words: &[String]) -> ExitCode {
    let mut others = words.iter().filter(|word| *word != "-AMPL");
    let Some(stub) = others.next() else {
        eprintln!("{NAME}: no file is named before `-AMPL`");
        return WRONG_ARGUMENTS.into();
    };
    let stub = stub.strip_suffix(".nl").unwrap_or(stub);
    let sent = input::contents(&format!("{stub}.nl")).and_then(|bytes| {
        let answer = SolFile::to(&bytes);
        Ok((answer.map_err(|error| format!("{stub}.nl: {}", coded(&error)))?, bytes))
    });
    let (mut sol, bytes) = match sent {
        Ok(sent) => sent,
        Err(error) => {
            eprintln!("{NAME}: {error}");
            return ExitCode::FAILURE;
        }
    };
    let asked = Asked::read(std::env::var(ENVIRONMENT).unwrap_or_default().as_str(), others);
    let solved = asked.and_then(|asked| solve(&bytes, asked, &mut sol));
    if let Err(error) = solved {
        (sol.message, sol.code) = (error, 500);
    }
    sol.message = format!("carom {}: {}", env!("CARGO_PKG_VERSION"), sol.message);
    let path = format!("{stub}.sol");
    match std::fs::write(&path, sol.to_string()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{NAME}: {path}: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Solves the program of a file, and puts what is found into the answer.
fn solve(bytes: &[u8], asked: Asked, sol: &mut SolFile) -> Result<(), String> {
    let read = nl::read(bytes).map_err(|error| coded(&error))?;
    let (mut model, start) = (read.model, read.start);
    if !asked.has_objective {
        model.minimize(0.0).map_err(|error| coded(&error))?;
        sol.objective = -1;
    }
    let mut live = Live::new(!asked.is_shown);
    live.say(&header::header(&model));
    let mip_start = guessed(&model, start).filter(|_| asked.has_start);
    let interrupt = Interrupt::new();
    let _signals = Signals::catch(&interrupt).map_err(|error| error.to_string())?;
    let begin = Instant::now();
    let mut show = |event: &Event| live.show(event);
    let mut control = Control::default().with_progress(&mut show).with_interrupt(&interrupt);
    if let Some(start) = &mip_start {
        control = control.with_start(start);
    }
    let mut solver = BranchAndBound::new(asked.options);
    let solution = solver.solve_with(&model, &mut control).map_err(|error| coded(&error))?;
    live.end();
    sol.message = answer::summary(&model, &solution, begin.elapsed().as_secs_f64());
    sol.code = code(&solution);
    sol.values = solution.point().map_or_else(Vec::new, |point| point.as_slice().to_vec());
    // Variables of functions come after those of the file.
    sol.values.truncate(sol.columns);
    sol.bound = asked.has_objective.then(|| solution.bound());
    sol.multipliers = multipliers(&model, &solution, sol.rows);
    match solution.proof().and_then(|proof| proof.failure.as_ref()) {
        Some(failure) => Err(failure.to_string()),
        None => Ok(()),
    }
}

/// The shadow price of each constraint of the file, which tells its number by its name; none if the
/// program has integers or cones.
fn multipliers(model: &Model, solution: &Solution, rows: usize) -> Vec<f64> {
    let Some(known) = solution.multipliers() else { return Vec::new() };
    if model.conic_constraint_count() > 0 {
        return Vec::new();
    }
    let mut prices = vec![0.0; rows];
    for row in model.constraints() {
        let place = row.name().step().and_then(|step| prices.get_mut(step));
        if let (Some(place), Ok(price)) = (place, known.shadow_price(row.id())) {
            *place = price;
        }
    }
    prices
}

/// The code of a termination: see [`SolFile::code`].
fn code(solution: &Solution) -> i64 {
    match (solution.termination(), solution.point().is_some()) {
        (Termination::Optimal, _) => 0,
        (Termination::Infeasible, _) => 200,
        (Termination::Unbounded, _) => 300,
        (Termination::Stalled, true) => 100,
        (Termination::Stalled, false) => 500,
        (_, true) => 400,
        (_, false) => 470,
    }
}

impl Asked {
    /// The options of the environment and then those of the call, which come first.
    fn read<'w>(
        environment: &str,
        words: impl Iterator<Item = &'w String>,
    ) -> Result<Asked, String> {
        let mut asked = Asked {
            options: Options::default(),
            has_start: true,
            has_objective: true,
            is_shown: false,
        };
        let mut parts = parts(environment);
        // Only the first sign ends a name: a value may have some.
        parts.extend(words.flat_map(|word| match word.split_once('=') {
            Some((name, value)) => vec![name.to_owned(), value.to_owned()],
            None => vec![word.clone()],
        }));
        let mut parts = parts.into_iter();
        while let Some(name) = parts.next() {
            let value = parts.next().ok_or_else(|| format!("the option `{name}` needs a value"))?;
            asked.set(&name, &value)?;
        }
        Ok(asked)
    }

    fn set(&mut self, name: &str, value: &str) -> Result<(), String> {
        let options = &mut self.options;
        match name.to_ascii_lowercase().as_str() {
            "timelim" | "timelimit" | "time_limit" | "lim:time" => {
                options.time_limit = Some(duration(name, value)?);
            }
            "nodelim" | "nodelimit" | "node_limit" | "lim:nodes" => {
                options.node_limit = Some(number(name, value)?);
            }
            "mipgap" | "gap" | "mip:gap" => options.relative_gap = number(name, value)?,
            "absmipgap" | "mipgapabs" | "absolute_gap" | "mip:gapabs" => {
                options.absolute_gap = number(name, value)?;
            }
            "threads" | "tech:threads" => options.threads = number(name, value)?,
            "deterministic" => options.deterministic = switch(name, value)?,
            "mipstart" | "mip:start" => self.has_start = switch(name, value)?,
            "objno" | "obj:no" => {
                self.has_objective = switch(name, value).map_err(|error| {
                    format!("{error}; of several objectives the first one is solved")
                })?;
            }
            "outlev" | "tech:outlev" => self.is_shown = number::<i32>(name, value)? > 0,
            "proof" => options.proof = Some(value.into()),
            _ => return Err(format!("no option is called `{name}`; `{NAME} -=` lists them")),
        }
        Ok(())
    }
}

fn switch(name: &str, value: &str) -> Result<bool, String> {
    match value {
        "0" => Ok(false),
        "1" => Ok(true),
        _ => Err(format!("{name} cannot be `{value}`")),
    }
}

/// The names and values of a text, between white space or equals signs, unless these are quoted.
fn parts(text: &str) -> Vec<String> {
    let (mut parts, mut part, mut quote) = (Vec::new(), String::new(), None);
    for letter in text.chars() {
        match quote {
            Some(mark) if letter == mark => quote = None,
            None if letter == '\'' || letter == '"' => quote = Some(letter),
            None if letter.is_whitespace() || letter == '=' => {
                parts.push(std::mem::take(&mut part));
            }
            _ => part.push(letter),
        }
    }
    parts.push(part);
    parts.retain(|part| !part.is_empty());
    parts
}
