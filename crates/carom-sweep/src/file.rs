//! The file of a sweep: a line a case, appended as soon as the case is known.

use std::fs::{File, OpenOptions};
use std::io::{ErrorKind as Io, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use super::record::{Field, SweepRecord};
use super::{Sweep, SweepResults};
use carom_model::error::{Error, ErrorKind};

/// The results of a sweep while it runs, with the file that they are appended to.
#[doc(hidden)]
#[derive(Debug)]
pub struct SweepFile {
    path: PathBuf,
    file: Option<File>,
    results: SweepResults,
}

/// The kinds of lines in a file.
enum Line {
    Case(usize, SweepRecord),
    Half,
    Blank,
}

impl SweepFile {
    /// Opens the file of a sweep, if it has one, and reads what is known already. A last line that
    /// was written by half is cut off.
    pub(super) fn open(sweep: &Sweep) -> Result<Self, Error> {
        let mut results = SweepResults::new(sweep);
        let Some(path) = sweep.path.clone() else {
            return Ok(SweepFile { path: PathBuf::new(), file: None, results });
        };
        let failed = |error| io_error("open", &path, error);
        let mut file =
            OpenOptions::new().read(true).append(true).create(true).open(&path).map_err(failed)?;
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(failed)?;
        let whole = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1);
        results.read(sweep, &path, &bytes[..whole])?;
        let last = &bytes[whole..];
        if !last.is_empty() {
            // The line is one of a sweep that was stopped, or the file is none of a sweep.
            match line(sweep, &path, whole_lines(&bytes[..whole]) + 1, last)? {
                Line::Case(k, record) => {
                    results.records[k] = Some(record);
                    file.write_all(b"\n").map_err(failed)?;
                }
                Line::Half => {
                    results.half_lines += 1;
                    file.set_len(whole as u64).map_err(failed)?;
                    file.seek(SeekFrom::End(0)).map_err(failed)?;
                }
                Line::Blank => {}
            }
        }
        Ok(SweepFile { path, file: Some(file), results })
    }

    /// The cases that are not known, and are this shard's.
    pub fn todo(&self, sweep: &Sweep) -> Vec<usize> {
        let is_own = |k: &usize| k % sweep.shard.1 == sweep.shard.0;
        self.results.missing().filter(is_own).collect()
    }

    /// Notes the record of a case, and appends its line.
    pub fn append(&mut self, sweep: &Sweep, case: usize, record: SweepRecord) -> Result<(), Error> {
        if let Some(file) = &mut self.file {
            let line = sweep.head(case).and(&record).to_line() + "\n";
            let written = file.write_all(line.as_bytes()).and_then(|()| file.flush());
            written.map_err(|error| io_error("write", &self.path, error))?;
        }
        self.results.records[case] = Some(record);
        Ok(())
    }

    /// The results.
    pub fn into_results(self) -> SweepResults {
        self.results
    }
}

impl SweepResults {
    /// Takes in the lines of a file.
    pub(super) fn read(&mut self, sweep: &Sweep, path: &Path, bytes: &[u8]) -> Result<(), Error> {
        for (k, own) in bytes.split(|&byte| byte == b'\n').enumerate() {
            match line(sweep, path, k + 1, own)? {
                Line::Case(k, record) => self.records[k] = Some(record),
                Line::Half => self.half_lines += 1,
                Line::Blank => {}
            }
        }
        Ok(())
    }
}

fn whole_lines(bytes: &[u8]) -> usize {
    bytes.iter().filter(|&&byte| byte == b'\n').count()
}

/// Reads a line. Where files were joined after a half line, what follows it counts.
fn line(sweep: &Sweep, path: &Path, number: usize, bytes: &[u8]) -> Result<Line, Error> {
    let refused = |what: &str, help| {
        let what = format!("line {number} of `{}` {what}", path.display());
        Err(ErrorKind::Sweep { what, help }.into())
    };
    let text = String::from_utf8_lossy(bytes);
    let text = text.trim();
    if text.is_empty() {
        return Ok(Line::Blank);
    }
    if !text.starts_with('{') {
        return refused("is no record of a sweep", "give the sweep a file of its own");
    }
    // Quotes inside of texts are escaped, so this begins no text.
    let begins = text.rfind("{\"sweep\":").unwrap_or(0);
    let Some(mut record) = SweepRecord::from_line(&text[begins..]) else { return Ok(Line::Half) };
    match record.take("sweep") {
        Some(Field::Text(key)) if key == sweep.key() => {}
        Some(Field::Text(_)) => {
            return refused(
                "belongs to another sweep",
                "choose another file, or run the sweep that it belongs to",
            );
        }
        _ => return refused("is no record of a sweep", "give the sweep a file of its own"),
    }
    let case = match record.take("case") {
        Some(Field::Number(k)) if k >= 0.0 && k < sweep.len() as f64 && k.fract() == 0.0 => {
            k as usize
        }
        _ => return refused("names no case of the sweep", "remove the line"),
    };
    sweep.names.iter().for_each(|name| _ = record.take(name));
    Ok(Line::Case(case, record))
}

fn io_error(action: &str, path: &Path, error: std::io::Error) -> Error {
    let help = match error.kind() {
        Io::NotFound => "make the folder first",
        _ => "check the folder and the rights",
    };
    let what = format!("{action} `{}`", path.display());
    Error::with_source(ErrorKind::Io { what, help }, error)
}
