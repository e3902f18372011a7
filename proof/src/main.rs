//! `carom-proof check LOG`: one line that says what is proved, or which line of the log fails and why.
//! `carom-proof compare MODEL LOG`: whether the log is about the model.

use carom_proof::compare::{Comparison, Format};
use flate2::bufread::MultiGzDecoder;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::process::ExitCode;

const HELP: &str = "\
Checks proofs that carom writes, in exact arithmetic.

    carom-proof check LOG           what the log proves
    carom-proof compare MODEL LOG   whether the log is about this MPS, LP or CBF file

Both may be compressed by gzip, and - is the standard input.
Exit codes: 0 proved, or the same; 1 rejected, or different; 2 unreadable.";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments[..] {
        ["check", log] => check(log),
        ["compare", model, log] => compare(model, log),
        ["--help" | "-h"] => {
            println!("{HELP}");
            ExitCode::SUCCESS
        }
        _ => {
            eprintln!("{HELP}");
            ExitCode::from(2)
        }
    }
}

fn check(path: &str) -> ExitCode {
    let log = match open(path) {
        Ok(log) => log,
        Err(error) => {
            eprintln!("{path}: {error}");
            return ExitCode::from(2);
        }
    };
    match carom_proof::check(log) {
        Ok(proved) => {
            for point in &proved.points {
                println!("{point}");
            }
            println!("{proved}");
            ExitCode::SUCCESS
        }
        Err(failure) => {
            println!("{failure}");
            ExitCode::from(if failure.is_readable { 1 } else { 2 })
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
            return ExitCode::from(2);
        }
    };
    let mut text = String::new();
    let read = open(model).and_then(|mut input| input.read_to_string(&mut text));
    let log = match read.and_then(|_| open(log)) {
        Ok(log) => log,
        Err(error) => {
            eprintln!("{model}, {log}: {error}");
            return ExitCode::from(2);
        }
    };
    match carom_proof::compare::compare(&text, format, log) {
        Ok(comparison) => {
            println!("{comparison}");
            ExitCode::from(u8::from(matches!(comparison, Comparison::Different(_))))
        }
        Err(error) => {
            println!("{error}");
            ExitCode::from(2)
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
