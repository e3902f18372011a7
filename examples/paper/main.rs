//! The paper's experiments: solved, proved, plotted, and compared with the paper's figures.
//!
//! `cargo run --release --example paper [-- [--csv] [--out FOLDER] [--proof FOLDER] [--scaling]]`
//!
//! * `--csv`: print the rows of a CSV file on standard output and nothing else
//! * `--out FOLDER`: where the plots go, `plots` by default
//! * `--proof FOLDER`: write a log for every shorter horizon of each row and for its plan, which
//!   `carom-proof check` reads, to a folder for each row
//! * `--scaling`: instead, measure the time of one search with finer and finer steps
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

const USAGE: &str = "usage: paper [--csv] [--out FOLDER] [--proof FOLDER] [--scaling]";

fn main() -> ExitCode {
    match run() {
        Ok(status) => status,
        Err(error) => {
            eprintln!("paper: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<ExitCode, Box<dyn Error>> {
    let (mut csv, mut scaling, mut folder) = (false, false, PathBuf::from("plots"));
    let (proofs, words) = proofs::arguments()?;
    let mut words = words.into_iter();
    while let Some(word) = words.next() {
        match word.as_str() {
            "--csv" => csv = true,
            "--scaling" => scaling = true,
            "--out" => folder = words.next().ok_or(USAGE)?.into(),
            _ => return Err(format!("unexpected `{word}`\n{USAGE}").into()),
        }
    }
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
