//! The paper's experiments: solved, proved, plotted, and compared with the paper's figures.
//!
//! `cargo run --release --example paper [-- OPTIONS]`; `--help` lists the options.
//!
//! Ctrl-C ends the searches; what is proved by then is printed and plotted, with how far the others
//! are, and the exit status is 3. A second Ctrl-C ends the program.
//!
//! M. L. Mote, J.-P. Afman, E. Feron, "A framework for collision-tolerant optimal trajectory
//! planning of autonomous vehicles", arXiv:1611.07608.

#[macro_use]
#[path = "../../crates/carom-cli/src/output.rs"]
mod output;
#[path = "../../crates/carom-cli/src/interrupts.rs"]
mod interrupts;
#[path = "../common/proofs.rs"]
mod proofs;

mod cases;
mod plots;
mod progress;
mod report;
mod scaling;
mod tube;

use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;

use carom::prelude::Interrupt;
use interrupts::{INTERRUPTED, Signals};

const USAGE: &str = "usage: paper [--csv] [--out FOLDER] [--proof FOLDER] [--scaling]; `paper --help` \
                     lists the options";

const HELP: &str = "\
The paper's experiments: solved, proved, plotted, and compared with the paper's figures.

usage: paper [--csv] [--out FOLDER] [--proof FOLDER] [--scaling]

  --csv            print the rows of a CSV file on standard output and nothing else
  --out FOLDER     where the plots go, `plots` by default
  --proof FOLDER   write a log for every shorter horizon of each row and for its plan, which
                   `carom-proof check` reads, to a folder for each row; they take gigabytes
  --scaling        instead, measure the time of one search with finer and finer steps
  --help           print this

Ctrl-C ends the searches; what is proved by then is printed and plotted, with how far the others are.
A second Ctrl-C ends the program at once.

exit status: 0 if all searches came to their end, 1 after an error, 2 if the arguments are wrong, 3 if
Ctrl-C ended them";

/// The exit status for wrong arguments.
const WRONG_ARGUMENTS: u8 = 2;

/// What is asked for.
struct Arguments {
    csv: bool,
    scaling: bool,
    folder: PathBuf,
    proofs: Option<PathBuf>,
}

fn main() -> ExitCode {
    let arguments = match arguments() {
        Ok(Some(arguments)) => arguments,
        Ok(None) => {
            println!("{HELP}");
            return ExitCode::SUCCESS;
        }
        Err(error) => {
            eprintln!("paper: {error}\n{USAGE}");
            return WRONG_ARGUMENTS.into();
        }
    };
    match run(arguments) {
        Ok(status) => status,
        Err(error) => {
            eprintln!("paper: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Reads the arguments; `None` if help is asked for.
fn arguments() -> Result<Option<Arguments>, String> {
    let (proofs, words) = proofs::arguments()?;
    let folder = PathBuf::from("plots");
    let mut arguments = Arguments { csv: false, scaling: false, folder, proofs };
    let mut words = words.into_iter();
    while let Some(word) = words.next() {
        match word.as_str() {
            "--help" | "-h" => return Ok(None),
            "--csv" => arguments.csv = true,
            "--scaling" => arguments.scaling = true,
            "--out" => arguments.folder = words.next().ok_or("--out needs a folder")?.into(),
            _ => return Err(format!("unexpected `{word}`")),
        }
    }
    Ok(Some(arguments))
}

fn run(arguments: Arguments) -> Result<ExitCode, Box<dyn Error>> {
    let Arguments { csv, scaling, folder, proofs } = arguments;
    // Problems with the folder show before the work, not after it.
    std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let interrupt = Interrupt::new();
    let signals = Signals::catch(&interrupt)?;
    let status = || if signals.came() { INTERRUPTED.into() } else { ExitCode::SUCCESS };
    if scaling {
        scaling::run(csv, &folder, &interrupt)?;
        return Ok(status());
    }
    let results = cases::solve_all(&interrupt, proofs.as_deref())?;
    let (results, unfinished): (Vec<_>, Vec<_>) =
        results.into_iter().partition(|solved| solved.is_done());
    let figures = plots::write_all(&results, &folder)?;
    if csv {
        report::print_csv(&results);
    } else {
        if signals.came() {
            report::print_interrupted(&results, &unfinished);
        } else {
            report::print_tables(&results);
            if let Some(folder) = &proofs {
                report::print_logs(&results, folder);
            }
        }
        for figure in figures {
            println!("wrote {}", figure.display());
        }
    }
    Ok(status())
}
