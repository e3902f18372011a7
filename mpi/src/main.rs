//! Solves a model file on the ranks of an MPI run:
//!
//! `mpirun -n 4 carom-mpi FILE [--checkpoint FILE] [--every S] [--resume] [--time-limit S]
//! [--node-limit N] [--gap G] [--quiet]`
//!
//! Rank 0 prints the answer; the exit status is 0 if it is proved, 3 if a limit came first, 1 for
//! errors.

use std::error::Error;
use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

use carom::model::{Model, cbf, lp, mps};
use carom::prelude::*;
use carom_mpi::{Answer, Run};
use mpi::traits::Communicator;

const USAGE: &str = "usage: carom-mpi FILE [--checkpoint FILE] [--every S] [--resume] \
                     [--time-limit S] [--node-limit N] [--gap G] [--quiet]";

fn main() -> ExitCode {
    let Some(universe) = mpi::initialize() else {
        eprintln!("carom-mpi: MPI cannot be initialised");
        return ExitCode::FAILURE;
    };
    let world = universe.world();
    match run(&world) {
        Ok(is_proved) => ExitCode::from(if is_proved { 0 } else { 3 }),
        Err(error) => {
            if world.rank() == 0 {
                eprintln!("carom-mpi: {error}");
            }
            ExitCode::FAILURE
        }
    }
}

fn run(world: &mpi::topology::SimpleCommunicator) -> Result<bool, Box<dyn Error>> {
    let (mut file, mut checkpoint, mut resumes, mut logs) = (None, None, false, true);
    let (mut every, mut options) = (60.0, Options::default());
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value\n{USAGE}"));
        match word.as_str() {
            "--checkpoint" => checkpoint = Some(value()?),
            "--every" => every = value()?.parse()?,
            "--resume" => resumes = true,
            "--time-limit" => {
                options.time_limit = Some(Duration::try_from_secs_f64(value()?.parse()?)?);
            }
            "--node-limit" => options.node_limit = Some(value()?.parse()?),
            "--gap" => options.relative_gap = value()?.parse()?,
            "--quiet" => logs = false,
            _ if file.is_none() && !word.starts_with('-') => file = Some(word),
            _ => return Err(format!("unexpected `{word}`\n{USAGE}").into()),
        }
    }
    let model = read(&file.ok_or(USAGE)?)?;
    let mut run = Run::new(&options).with_resume(resumes).with_log(logs);
    if let Some(path) = checkpoint {
        run = run.with_checkpoint(path, Duration::try_from_secs_f64(every)?);
    }
    let Answer { solution, ranks, unwritten, .. } = run.solve(&model, world)?;
    let Some(solution) = solution else { return Ok(true) };
    if let Some(error) = unwritten {
        eprintln!("carom-mpi: {error}");
    }
    if logs {
        for counts in &ranks {
            eprintln!(
                "rank {}: {} nodes, {} handed to it, {} given back, busy for {:.1} s",
                counts.rank, counts.nodes, counts.handed, counts.given, counts.busy
            );
        }
    }
    let number = |value: Option<f64>| value.map_or("none".into(), |value| value.to_string());
    println!("status: {}", solution.termination());
    println!("objective: {}", number(solution.objective()));
    println!("bound: {}", solution.bound());
    println!("nodes: {}", solution.statistics().nodes);
    println!("time: {:.3} s", solution.statistics().time.as_secs_f64());
    Ok(solution.is_optimal() || solution.is_infeasible())
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
