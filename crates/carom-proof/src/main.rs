//! `carom-proof check LOG...`: one line a log that says what is proved, or which line of it fails
//! and why. `carom-proof compare MODEL LOG`: whether the log is about the model.

use carom_proof::compare::{Comparison, Format};
use flate2::bufread::MultiGzDecoder;
use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

const HELP: &str = "\
Checks proofs that carom writes, in exact arithmetic.

    carom-proof check LOG...        what the log proves; of several, a line each, and of a folder all
                                    files in it and its folders that end in .proof or .proof.gz
    carom-proof table FILE          what a table of laws proves, with plans, losses and refutations
    carom-proof compare MODEL LOG   whether the log is about this MPS, LP or CBF file

Logs and models may be compressed by gzip, and - is the standard input.
Exit codes: 0 proved, or the same; 1 rejected, or different; 2 unreadable.";

/// The exit code for what cannot be read.
const UNREADABLE: u8 = 2;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments[..] {
        ["check", log] if !Path::new(log).is_dir() => check(log, "").into(),
        ["check", _, ..] => check_all(&arguments[1..]),
        ["table", table] => check_table(table),
        ["compare", model, log] => compare(model, log),
        ["--help" | "-h"] => {
            println!("{HELP}");
            ExitCode::SUCCESS
        }
        _ => {
            eprintln!("{HELP}");
            UNREADABLE.into()
        }
    }
}

/// Checks several logs. Returns the worst exit code.
fn check_all(paths: &[&str]) -> ExitCode {
    let mut logs = Vec::new();
    for path in paths {
        let before = logs.len();
        let listed = collect(Path::new(path), &mut logs);
        if let Err(error) = listed {
            eprintln!("{path}: {error}");
            return UNREADABLE.into();
        }
        if logs.len() == before {
            eprintln!("{path}: there is no file in it that ends in .proof or .proof.gz");
            return UNREADABLE.into();
        }
    }
    let mut worst = 0;
    for log in &logs {
        worst = worst.max(check(log, &format!("{log}: ")));
    }
    worst.into()
}

/// Adds a file, or the logs in a folder in the order of their names.
fn collect(path: &Path, logs: &mut Vec<String>) -> io::Result<()> {
    if !path.is_dir() {
        logs.push(path.display().to_string());
        return Ok(());
    }
    let mut entries: Vec<PathBuf> =
        fs::read_dir(path)?.map(|entry| Ok(entry?.path())).collect::<io::Result<_>>()?;
    entries.sort();
    for entry in entries {
        let name = entry.to_string_lossy();
        if entry.is_dir() || name.ends_with(".proof") || name.ends_with(".proof.gz") {
            collect(&entry, logs)?;
        }
    }
    Ok(())
}

/// Checks a log and prints what it proves, with a word in front. Returns the exit code.
fn check(path: &str, front: &str) -> u8 {
    let log = match open(path) {
        Ok(log) => log,
        Err(error) => {
            eprintln!("{path}: {error}");
            return UNREADABLE;
        }
    };
    match carom_proof::check(log) {
        Ok(proved) => {
            for point in &proved.points {
                println!("{front}{point}");
            }
            println!("{front}{proved}");
            0
        }
        Err(failure) => {
            println!("{front}{failure}");
            if failure.is_readable { 1 } else { UNREADABLE }
        }
    }
}

fn check_table(path: &str) -> ExitCode {
    let table = match open(path) {
        Ok(table) => table,
        Err(error) => {
            eprintln!("{path}: {error}");
            return UNREADABLE.into();
        }
    };
    match carom_proof::check_table(table) {
        Ok(proved) => {
            println!("{proved}");
            ExitCode::SUCCESS
        }
        Err(failure) => {
            println!("{failure}");
            ExitCode::from(if failure.is_readable { 1 } else { UNREADABLE })
        }
    }
}

fn compare(model: &str, log: &str) -> ExitCode {
    let lower = model.to_ascii_lowercase();
    let ending = lower.trim_end_matches(".gz").rsplit('.').next().unwrap_or_default().to_string();
    let format = match ending.as_str() {
        "mps" | "qps" => Format::Mps,
        "lp" => Format::Lp,
        "cbf" => Format::Cbf,
        _ => {
            eprintln!("{model}: the name must end in .mps, .qps, .lp or .cbf");
            return UNREADABLE.into();
        }
    };
    let mut text = String::new();
    let read = open(model).and_then(|mut input| input.read_to_string(&mut text));
    let log = match read.and_then(|_| open(log)) {
        Ok(log) => log,
        Err(error) => {
            eprintln!("{model}, {log}: {error}");
            return UNREADABLE.into();
        }
    };
    match carom_proof::compare::compare(&text, format, log) {
        Ok(comparison) => {
            println!("{comparison}");
            ExitCode::from(u8::from(matches!(comparison, Comparison::Different(_))))
        }
        Err(error) => {
            println!("{error}");
            UNREADABLE.into()
        }
    }
}

/// A file or the standard input; what begins like a gzip file is decompressed.
fn open(path: &str) -> io::Result<Box<dyn BufRead>> {
    let mut input: Box<dyn BufRead> = match path {
        "-" => Box::new(io::stdin().lock()),
        _ => Box::new(BufReader::with_capacity(1 << 18, File::open(path)?)),
    };
    if input.fill_buf()?.starts_with(&[0x1f, 0x8b]) {
        input = Box::new(BufReader::with_capacity(1 << 18, MultiGzDecoder::new(input)));
    }
    Ok(input)
}
