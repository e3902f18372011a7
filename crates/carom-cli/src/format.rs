//! The formats of model files: which one a file has, reading and writing.

use std::error::Error;
use std::path::Path;
use std::str::FromStr;

use carom::model::{Warning, cbf, lp, mps, qplib};
use carom::prelude::Model;

use crate::answer;
use crate::input::{self, STANDARD_INPUT};
use crate::{coded, warnings};

/// A format of model files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Format {
    Mps,
    Lp,
    Cbf,
    Qplib,
    Json,
}

impl FromStr for Format {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        match name.to_lowercase().as_str() {
            "mps" => Ok(Format::Mps),
            "lp" => Ok(Format::Lp),
            "cbf" => Ok(Format::Cbf),
            "qplib" => Ok(Format::Qplib),
            "json" => Ok(Format::Json),
            _ => {
                Err(format!("no format is called `{name}`; there are mps, lp, cbf, qplib and json"))
            }
        }
    }
}

/// The format that the extension of a file tells.
fn of_extension(path: &str) -> Option<Format> {
    let plain = path.strip_suffix(".gz").unwrap_or(path);
    Path::new(plain).extension()?.to_str()?.parse().ok()
}

/// The format that the contents of a file tell.
fn of_contents(text: &str) -> Format {
    let is_rows = |line: &str| line.trim_end().eq_ignore_ascii_case("ROWS");
    // The second line of a QPLIB file has three letters, and the third one the sense.
    let mut filled = text.lines().filter_map(|line| line.split_whitespace().next());
    let mut filled = filled.by_ref().filter(|word| !word.starts_with(['#', '!', '%'])).skip(1);
    let is_quadratic = filled.next().is_some_and(|word| word.len() == 3)
        && filled.next().is_some_and(|word| {
            ["minimize", "maximize"].contains(&word.to_ascii_lowercase().as_str())
        });
    if text.trim_start().starts_with('{') {
        Format::Json
    } else if text.lines().any(is_rows) {
        Format::Mps
    } else if text.lines().any(|line| line.trim_end() == "VER") {
        Format::Cbf
    } else if is_quadratic {
        Format::Qplib
    } else {
        Format::Lp
    }
}

/// Reads the model of a file. Returns also what the reader warns of, and whether it is an LP file.
pub(crate) fn read(
    path: &str,
    asked: Option<Format>,
) -> Result<(Model, Vec<String>, bool), Box<dyn Error>> {
    let text = input::text(path)?;
    let format = asked.or_else(|| of_extension(path)).unwrap_or_else(|| of_contents(&text));
    let name = if path == STANDARD_INPUT { "standard input" } else { path };
    let read = parse(format, &text).map_err(|error| format!("{name}: {}", coded(&*error)))?;
    Ok((read.0, warnings::lines(name, &read.1), format == Format::Lp))
}

fn parse(format: Format, text: &str) -> Result<(Model, Vec<Warning>), Box<dyn Error>> {
    let read = match format {
        Format::Mps => mps::read(text)?,
        Format::Lp => lp::read(text)?,
        Format::Cbf => cbf::read(text)?,
        Format::Qplib => qplib::read(text)?,
        #[cfg(feature = "serde")]
        Format::Json => return Ok((serde_json::from_str(text)?, Vec::new())),
        #[cfg(not(feature = "serde"))]
        Format::Json => return Err("JSON needs `--features serde`".into()),
    };
    Ok((read.model, read.warnings))
}

/// Makes sure that a model can be written to a file: the extension tells a format, and the file can
/// be opened.
pub(crate) fn check(path: &str) -> Result<(), String> {
    match of_extension(path) {
        Some(_) => answer::check(path),
        None => Err(format!("{path}: expected .mps, .lp, .cbf or .json")),
    }
}

/// Writes a model in the format that the extension tells, compressed for `.gz`.
pub(crate) fn write(model: &Model, path: &str) -> Result<(), Box<dyn Error>> {
    let text = match of_extension(path) {
        Some(Format::Mps) => mps::write(model)?,
        Some(Format::Lp) => lp::write(model)?,
        Some(Format::Cbf) => cbf::write(model)?,
        #[cfg(feature = "serde")]
        Some(Format::Json) => serde_json::to_string_pretty(model)?,
        #[cfg(not(feature = "serde"))]
        Some(Format::Json) => return Err("JSON needs `--features serde`".into()),
        Some(Format::Qplib) | None => {
            return Err(format!("{path}: expected .mps, .lp, .cbf or .json").into());
        }
    };
    let bytes = if path.ends_with(".gz") { input::compressed(&text)? } else { text.into_bytes() };
    Ok(std::fs::write(path, bytes).map_err(|error| format!("{path}: {error}"))?)
}
