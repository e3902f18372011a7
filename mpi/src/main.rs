//! The program `carom-mpi`: solves a model file on the ranks of an MPI run, `mpirun -n 4 carom-mpi FILE`.
//! `--help` lists the options. Without the feature `mpi`, the ranks are threads of one process.
//!
//! Rank 0 prints what `carom` prints: `rows=...` first, and `status=... objective=... bound=...` last.

#[macro_use]
#[path = "../../crates/carom-cli/src/output.rs"]
mod output;
#[allow(dead_code)] // it has more than is printed here
#[path = "../../crates/carom-cli/src/answer.rs"]
mod answer;
#[path = "../../crates/carom-cli/src/header.rs"]
mod header;

use std::error::Error;
use std::path::Path;
use std::process::ExitCode;
use std::str::FromStr;
use std::time::Duration;

use carom::model::{Model, cbf, lp, mps};
use carom::prelude::*;
use carom_mpi::{Answer, Run};

const USAGE: &str = "usage: carom-mpi FILE [OPTIONS]; `carom-mpi --help` lists the options";

const HELP: &str = "\
Solves a model file (MPS, LP, CBF or JSON, as its name ends) on the ranks of an MPI run.

usage: mpirun -n RANKS carom-mpi FILE [OPTIONS]

  --checkpoint FILE  write what is open and the best point to FILE, now and then and at the end
  --every S          seconds between two checkpoints, 60 by default
  --resume           go on from the checkpoint, if there is one
  --time-limit S     stop after S seconds
  --node-limit N     stop after N nodes of all ranks together
  --gap G            relative gap at which to stop, 1e-6 by default
  --quiet            no log on the standard error
  --ranks N          the number of ranks, 1 by default, where they are threads: only in a build
                     without the feature `mpi`
  --help             print this

Rank 0 prints, on the standard output, `rows=... columns=... integers=... nonzeros=...` first and
`status=... objective=... bound=... nodes=... seconds=...` last, as `carom` does.

exit status: 0 if the search came to its end or to a limit that was set, which the status tells; 1
after an error; 2 if the arguments are wrong. For any status but 0, `mpirun` says that the run failed";

/// The exit status for wrong arguments.
const WRONG_ARGUMENTS: u8 = 2;

/// What is asked for.
struct Arguments {
    file: String,
    checkpoint: Option<String>,
    every: Duration,
    resumes: bool,
    logs: bool,
    #[cfg(not(feature = "mpi"))]
    ranks: usize,
    options: Options,
}

fn main() -> ExitCode {
    // Words are wrong on all ranks, and rank 0 says so.
    match arguments() {
        Ok(Some(arguments)) => on_ranks(|solve, is_first| finish(&arguments, solve, is_first)),
        Ok(None) => on_ranks(|_, is_first| {
            if is_first {
                println!("{HELP}");
            }
            ExitCode::SUCCESS
        }),
        Err(error) => on_ranks(|_, is_first| {
            if is_first {
                eprintln!("carom-mpi: {error}\n{USAGE}");
            }
            WRONG_ARGUMENTS.into()
        }),
    }
}

/// How a rank takes part in a run.
type Solve<'a> = dyn FnMut(&Model, &Run) -> Result<Answer, carom_mpi::Error> + 'a;

/// Runs something on this rank, which is told whether it is rank 0.
#[cfg(feature = "mpi")]
fn on_ranks(run: impl FnOnce(&mut Solve<'_>, bool) -> ExitCode) -> ExitCode {
    use mpi::traits::Communicator;
    let Some(universe) = mpi::initialize() else {
        eprintln!("carom-mpi: MPI cannot be initialised");
        return ExitCode::FAILURE;
    };
    let world = universe.world();
    let is_first = world.rank() == 0;
    run(&mut |model, run| run.solve(model, &world), is_first)
}

/// Runs something at rank 0. The other ranks are threads that take part in its solve.
#[cfg(not(feature = "mpi"))]
fn on_ranks(run: impl FnOnce(&mut Solve<'_>, bool) -> ExitCode) -> ExitCode {
    let ranks = arguments().ok().flatten().map_or(1, |arguments| arguments.ranks);
    let mut solve = |model: &Model, run: &Run| {
        let mut ends = carom_mpi::ThreadChannel::ends(ranks);
        let others: Vec<_> = ends.drain(1..).collect();
        std::thread::scope(|scope| {
            for mut end in others {
                scope.spawn(move || run.solve_on(model, &mut end));
            }
            run.solve_on(model, &mut ends[0])
        })
    };
    run(&mut solve, true)
}

/// Reads the arguments; `None` if help is asked for.
fn arguments() -> Result<Option<Arguments>, String> {
    let mut arguments = Arguments {
        file: String::new(),
        checkpoint: None,
        every: Duration::from_secs(60),
        resumes: false,
        logs: true,
        #[cfg(not(feature = "mpi"))]
        ranks: 1,
        options: Options::default(),
    };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value"));
        let options = &mut arguments.options;
        match word.as_str() {
            "--help" | "-h" => return Ok(None),
            "--checkpoint" => arguments.checkpoint = Some(value()?),
            "--every" => arguments.every = seconds(&word, &value()?)?,
            "--resume" => arguments.resumes = true,
            "--time-limit" => options.time_limit = Some(seconds(&word, &value()?)?),
            "--node-limit" => options.node_limit = Some(number(&word, &value()?)?),
            "--gap" => options.relative_gap = number(&word, &value()?)?,
            "--quiet" => arguments.logs = false,
            #[cfg(not(feature = "mpi"))]
            "--ranks" => {
                arguments.ranks = number(&word, &value()?)?;
                if arguments.ranks == 0 {
                    return Err("--ranks cannot be `0`".into());
                }
            }
            _ if arguments.file.is_empty() && !word.starts_with('-') => arguments.file = word,
            _ => return Err(format!("unexpected `{word}`")),
        }
    }
    match arguments.file.is_empty() {
        true => Err("no file is given".into()),
        false => Ok(Some(arguments)),
    }
}

fn number<T: FromStr>(option: &str, text: &str) -> Result<T, String> {
    text.parse().map_err(|_| format!("{option} cannot be `{text}`"))
}

fn seconds(option: &str, text: &str) -> Result<Duration, String> {
    let seconds: f64 = number(option, text)?;
    Duration::try_from_secs_f64(seconds).map_err(|_| format!("{option} cannot be `{text}`"))
}

/// Takes part in the run, and prints the answer at rank 0.
fn finish(arguments: &Arguments, solve: &mut Solve<'_>, is_first: bool) -> ExitCode {
    match run(arguments, solve, is_first) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            if is_first {
                eprintln!("carom-mpi: {error}");
            }
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments, solve: &mut Solve<'_>, is_first: bool) -> Result<(), Box<dyn Error>> {
    let Arguments { file, checkpoint, every, resumes, logs, options, .. } = arguments;
    let model = read(file)?;
    if is_first {
        println!("{}", header::counts(&model));
        if *logs {
            eprintln!("{}", header::header(&model));
        }
    }
    let mut run = Run::new(options).with_resume(*resumes).with_log(*logs);
    if let Some(path) = checkpoint {
        run = run.with_checkpoint(path, *every);
    }
    let Answer { solution, ranks, unwritten, .. } = solve(&model, &run)?;
    let Some(solution) = solution else { return Ok(()) };
    if *logs {
        for counts in &ranks {
            let nodes = answer::counted(counts.nodes as usize, "node");
            eprintln!(
                "rank {}: {nodes}, {} handed to it, {} given back, busy for {:.1} s",
                counts.rank, counts.handed, counts.given, counts.busy
            );
        }
    }
    let seconds = solution.statistics().time.as_secs_f64();
    println!("{}", answer::status_line(&solution, seconds, None));
    // Behind the answer, which it makes no worse.
    unwritten.map_or(Ok(()), |error| Err(error.into()))
}

/// Reads a model; the extension says its format.
fn read(path: &str) -> Result<Model, Box<dyn Error>> {
    let text = std::fs::read_to_string(path).map_err(|error| format!("{path}: {error}"))?;
    let extension = Path::new(path).extension().and_then(|extension| extension.to_str());
    Ok(match extension {
        Some("lp") => lp::read(&text)?.model,
        Some("mps") => mps::read(&text)?.model,
        Some("cbf") => cbf::read(&text)?.model,
        Some("json") => serde_json::from_str(&text)?,
        _ => return Err(format!("{path}: the name ends in none of .lp, .mps, .cbf, .json").into()),
    })
}
