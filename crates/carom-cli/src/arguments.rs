//! The words of the command line, and the task that they ask for.

use std::iter::Peekable;
use std::str::FromStr;
use std::time::Duration;

use carom::prelude::Options;
use carom::solver::{Heuristics, PoolMode, RelaxationMethod};

use crate::ampl;
use crate::format::Format;

const USAGE: &str = concat!(
    "usage: ",
    env!("CARGO_BIN_NAME"),
    " FILE [OPTIONS]; `",
    env!("CARGO_BIN_NAME"),
    " --help` lists the options"
);

pub(crate) const HELP: &str = concat!(
    "\
Solves a model file (MPS, LP, CBF, QPLIB, NL, or JSON with the feature `serde`), or writes it in another
format.

usage: ",
    env!("CARGO_BIN_NAME"),
    " FILE [OPTIONS]
       ",
    env!("CARGO_BIN_NAME"),
    " STUB -AMPL [OPTION=VALUE ...]     the call of AMPL and Pyomo; `-=` lists these options

FILE is `-` for the standard input. It may be compressed by gzip.

  --format FORMAT      `mps`, `lp`, `cbf`, `qplib`, `nl` or `json`; else the extension or the
                       contents tell
  --solution [FILE]    write the values to FILE, lines `name value`; without FILE, or with `-`, print
                       those with magnitudes above 1e-9, `name = value`
  --start FILE.sol     begin with the integers of a point: lines `name value` or `name = value`;
                       integers that are not named are 0.
                       For a model of an NL file also an answer of AMPL's form
  --explain            if there is no solution, print which statements contradict each other
  --proof FILE         write a proof of the bound, or that there is no point, for `carom-proof check`;
                       it is made after the search, with which it takes from 1.2 to more than 7
                       times as long, and a time limit holds for each of the two
  --time-limit S       stop after S seconds
  --node-limit N       stop after N nodes
  --gap G              relative gap at which to stop, 1e-6 by default
  --threads K          threads of the tree search, 1 by default
  --deterministic      the same search for any number of threads
  --pool K             print the proved objectives of the K best points with distinct integers
  --log                a long summary on the standard error
  --quiet              no warnings, progress and summary on the standard error
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
  --version            print the version
  --help               print this

The last line on the standard output is `status=... objective=... bound=... nodes=... seconds=...`,
where `-` stands for what is not known. With --proof, a line before it says what the log proves:
`proof=complete claim=bound bound=... commands=... bytes=...`, or `claim=infeasible` without a bound.
That bound is looser than the one of the search by the gap at which the search may stop. `incomplete`
is a log that ends too early, and `failed` one that cannot be written.

Files to which nothing can be written are refused before the model is read. If writing fails later,
the answer is printed, and the exit status is 1.

A word in brackets after a message, such as [no-bound], and the status are sections of the page
\"Help\" of the documentation (docs/help.md): why one sees that, and what to do.

Ctrl-C ends the search, the explanation or the proof; the best point and the bound are printed, and
what was asked for is written. A second Ctrl-C, or one while the model is read, ends the program at
once.

exit status: 0 if the search came to its end or to a limit that was set, or if nobody reads the
output on; 1 after an error; 2 if the arguments are wrong; 3 if Ctrl-C ended the search, the
explanation or the proof; what the signal says if it ends the program at once (130 in a shell)"
);

/// The task.
pub(crate) enum Command {
    Solve(Box<Arguments>),
    Print(String),
}

/// Where the values of the best point go.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Values {
    Printed,
    Written(String),
}

#[derive(Default)]
pub(crate) struct Arguments {
    pub(crate) file: String,
    pub(crate) format: Option<Format>,
    pub(crate) write: Option<String>,
    pub(crate) lowered: Option<String>,
    pub(crate) start: Option<String>,
    pub(crate) solution: Option<Values>,
    pub(crate) explain: bool,
    pub(crate) log: bool,
    pub(crate) quiet: bool,
    pub(crate) options: Options,
}

/// Reads the arguments.
pub(crate) fn read(words: impl Iterator<Item = String>) -> Result<Command, String> {
    let mut arguments = Arguments::default();
    let mut words = words.peekable();
    while let Some(word) = words.next() {
        if word == "--solution" {
            arguments.solution = Some(values(&mut words));
            continue;
        }
        let mut value = || words.next().ok_or(format!("{word} needs a value\n{USAGE}"));
        let options = &mut arguments.options;
        match word.as_str() {
            "--help" | "-h" => return Ok(Command::Print(HELP.to_owned())),
            "--version" | "-V" | "-v" => {
                return Ok(Command::Print(format!("carom {}", env!("CARGO_PKG_VERSION"))));
            }
            "-=" => return Ok(Command::Print(ampl::OPTIONS.to_owned())),
            "--format" => arguments.format = Some(value()?.parse()?),
            "--start" => arguments.start = Some(value()?),
            "--explain" => arguments.explain = true,
            "--time-limit" => options.time_limit = Some(duration(&word, &value()?)?),
            "--threads" => options.threads = number(&word, &value()?)?,
            "--deterministic" => options.deterministic = true,
            "--log" => arguments.log = true,
            "--quiet" => arguments.quiet = true,
            "--pool" => {
                options.pool = number(&word, &value()?)?;
                options.pool_mode = PoolMode::Best;
            }
            "--node-limit" => options.node_limit = Some(number(&word, &value()?)?),
            "--without" => leave_out(options, &value()?)?,
            "--with" => switch(&mut options.heuristics, &value()?, true)?,
            "--relaxation" => options.relaxation = method(&value()?)?,
            "--proof" => options.proof = Some(value()?.into()),
            "--gap" => options.relative_gap = number(&word, &value()?)?,
            "--write" => arguments.write = Some(value()?),
            "--lowered" => arguments.lowered = Some(value()?),
            _ if word.starts_with("--") || !arguments.file.is_empty() => {
                return Err(format!("unexpected `{word}`\n{USAGE}"));
            }
            _ => arguments.file = word,
        }
    }
    match (&arguments.file, arguments.solution) {
        (file, Some(Values::Written(path))) if file.is_empty() => Err(format!(
            "`--solution {path}` writes to that file, and no file is left to solve\n{USAGE}"
        )),
        (file, _) if file.is_empty() => Err(USAGE.to_owned()),
        (_, solution) => Ok(Command::Solve(Box::new(Arguments { solution, ..arguments }))),
    }
}

/// Where `--solution` sends the values: to the file whose name follows, if one does.
fn values(words: &mut Peekable<impl Iterator<Item = String>>) -> Values {
    match words.next_if(|word| word == "-" || !word.starts_with('-')) {
        Some(path) if path != "-" => Values::Written(path),
        _ => Values::Printed,
    }
}

/// Leaves out a part of the solver.
fn leave_out(options: &mut Options, part: &str) -> Result<(), String> {
    match part {
        "presolve" => *options = options.clone().with_presolve(false),
        "reductions" => options.parts_mut().reductions = false,
        "disjunctive-tightening" => options.parts_mut().disjunctive_tightening = false,
        "big-m-tightening" => options.parts_mut().big_m_tightening = false,
        "probing" => options.parts_mut().probing = false,
        "cuts" => options.cuts = false,
        "blocks" => options.parts_mut().blocks = false,
        "facets" => *options = options.clone().with_facets(false),
        part => switch(&mut options.heuristics, part, false)?,
    }
    Ok(())
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

/// A number of seconds.
pub(crate) fn duration(option: &str, text: &str) -> Result<Duration, String> {
    let limit = Duration::try_from_secs_f64(number(option, text)?);
    limit.map_err(|_| format!("{option} cannot be `{text}`"))
}

pub(crate) fn number<T: FromStr>(option: &str, text: &str) -> Result<T, String> {
    text.parse().map_err(|_| format!("{option} cannot be `{text}`"))
}
