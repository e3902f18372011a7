//! The formats of model files: which one a file has, reading and writing.

use std::error::Error;
use std::path::Path;
use std::str::FromStr;

use carom::model::{Read, Variable, cbf, lp, mps, nl, qplib};
use carom::prelude::Model;

use crate::answer;
use crate::input;
use crate::{coded, warnings};

/// A format of model files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Format {
    Mps,
    Lp,
    Cbf,
    Qplib,
    Nl,
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
            "nl" => Ok(Format::Nl),
            "json" => Ok(Format::Json),
            _ => Err(format!(
                "no format is called `{name}`; there are mps, lp, cbf, qplib, nl and json"
            )),
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

/// A model from a file.
pub(crate) struct FromFile {
    pub(crate) model: Model,
    /// The warnings of the reader.
    pub(crate) warnings: Vec<String>,
    pub(crate) format: Format,
    /// Values to begin with.
    pub(crate) start: Vec<(Variable, f64)>,
}

/// Reads the model of a file.
pub(crate) fn read(path: &str, asked: Option<Format>) -> Result<FromFile, Box<dyn Error>> {
    let bytes = input::contents(path)?;
    let known =
        asked.or_else(|| of_extension(path)).or_else(|| is_nl(&bytes).then_some(Format::Nl));
    let name = input::name(path);
    let said = |error: Box<dyn Error>| format!("{name}: {}", coded(&*error));
    if known == Some(Format::Nl) {
        let read = nl::read(bytes).map_err(|error| said(error.into()))?;
        return Ok(FromFile::new(read, Format::Nl, name));
    }
    let text = input::decoded(path, bytes)?;
    let format = known.unwrap_or_else(|| of_contents(&text));
    if format == Format::Json {
        let model = json(&text).map_err(said)?;
        return Ok(FromFile { model, warnings: Vec::new(), format, start: Vec::new() });
    }
    let read = match format {
        Format::Mps => mps::read(&text),
        Format::Cbf => cbf::read(&text),
        Format::Qplib => qplib::read(&text),
        _ => lp::read(&text),
    };
    Ok(FromFile::new(read.map_err(|error| said(error.into()))?, format, name))
}

impl FromFile {
    fn new(read: Read, format: Format, name: &str) -> Self {
        let warnings = warnings::lines(name, &read.warnings);
        FromFile { model: read.model, warnings, format, start: read.start }
    }
}

/// Whether a file begins as those of AMPL do, such as `g3 1 1 0`.
fn is_nl(bytes: &[u8]) -> bool {
    let first = bytes.split(|&byte| byte == b'\n').next().unwrap_or_default();
    let numbers = first.split(|&byte| byte == b'#').next().unwrap_or_default();
    matches!(numbers, [b'g' | b'b', digit, ..] if digit.is_ascii_digit())
        && numbers[1..].iter().all(|byte| byte.is_ascii_digit() || byte.is_ascii_whitespace())
}

#[cfg(feature = "serde")]
fn json(text: &str) -> Result<Model, Box<dyn Error>> {
    Ok(serde_json::from_str(text)?)
}

#[cfg(not(feature = "serde"))]
fn json(_text: &str) -> Result<Model, Box<dyn Error>> {
    Err("JSON needs `--features serde`".into())
}

/// Makes sure that a model can be written to a file: the extension tells a format, and the file can
/// be opened.
pub(crate) fn check(path: &str) -> Result<(), String> {
    match of_extension(path) {
        Some(_) => answer::check(path),
        None => Err(format!("{path}: expected .mps, .lp, .cbf, .nl or .json")),
    }
}

/// Writes a model in the format that the extension tells, compressed for `.gz`.
pub(crate) fn write(model: &Model, path: &str) -> Result<(), Box<dyn Error>> {
    let text = match of_extension(path) {
        Some(Format::Mps) => mps::write(model)?,
        Some(Format::Lp) => lp::write(model)?,
        Some(Format::Cbf) => cbf::write(model)?,
        Some(Format::Nl) => nl::write(model)?,
        #[cfg(feature = "serde")]
        Some(Format::Json) => serde_json::to_string_pretty(model)?,
        #[cfg(not(feature = "serde"))]
        Some(Format::Json) => return Err("JSON needs `--features serde`".into()),
        Some(Format::Qplib) | None => {
            return Err(format!("{path}: expected .mps, .lp, .cbf, .nl or .json").into());
        }
    };
    let bytes = if path.ends_with(".gz") { input::compressed(&text)? } else { text.into_bytes() };
    Ok(std::fs::write(path, bytes).map_err(|error| format!("{path}: {error}"))?)
}
