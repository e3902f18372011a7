//! `carom-proof check LOG`: one line that says what is proved, or which line of the log fails and why.

use flate2::bufread::MultiGzDecoder;
use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::process::ExitCode;

const HELP: &str = "\
Checks proofs that carom writes, in exact arithmetic.

    carom-proof check LOG           what the log proves

LOG may be compressed by gzip, and - is the standard input.
Exit codes: 0 proved, 1 rejected, 2 unreadable.";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments[..] {
        ["check", log] => check(log),
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
