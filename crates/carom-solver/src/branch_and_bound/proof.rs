//! The phase after the last one, if it is asked for: the proof of the answer, for another program
//! to check.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind as IoErrorKind, Write};
use std::path::{Path, PathBuf};

use super::lower::{LoweredProgram, lower};
use super::solve::{Solve, SolveResult};
use crate::error::{Error, ErrorKind};
use crate::model::Model;
use crate::proof::{Claim, Guide, ProofRequest};
use crate::relaxation::CascadePool;
use crate::solution::{ProofReport, Termination};
use crate::solver::{Control, Event, Options, Progress, StopToken};

/// Splits of a proof besides those of the search, and of a proof without a search.
const MOST_SPLITS: u64 = 20_000;
const FEW_SPLITS: u64 = 1000;

/// The largest number of proofs in a folder.
const MOST_FILES: usize = 1_000_000;

/// Refuses a path to which no proof can be written, before the search. A file that is there keeps
/// what it has until then.
///
/// # Errors
///
/// [`ErrorKind::Io`](crate::error::ErrorKind::Io), naming the path.
pub(super) fn check_path(options: &Options) -> Result<(), Error> {
    let Some(path) = options.proof_path() else { return Ok(()) };
    try_to_open(path).map_err(|source| {
        let help = "choose a file or a folder that can be written";
        Error::with_source(ErrorKind::Io { what: cannot_write(path), help }, source)
    })
}

pub(super) fn cannot_write(path: &Path) -> String {
    format!("the proof cannot be written to {}", path.display())
}

/// Opens a path for writing, and leaves nothing behind.
fn try_to_open(path: &Path) -> io::Result<()> {
    match fs::metadata(path) {
        Ok(found) if found.is_dir() => create_in(path).map(|(_, new)| fs::remove_file(new))?,
        Ok(found) if found.is_file() => OpenOptions::new().append(true).open(path).map(drop),
        // The reader of a pipe would take the end of this for the end of the proof.
        Ok(_) => Ok(()),
        // A link to a file that is still to be made.
        Err(_) if path.is_symlink() => Ok(()),
        Err(_) => {
            OpenOptions::new().write(true).create_new(true).open(path)?;
            fs::remove_file(path)
        }
    }
}

impl Solve<'_> {
    /// Writes the proof of an answer; `None` if it claims nothing. A failure to write is part of
    /// the report, because it makes the answer no worse.
    pub(super) fn write_proof(
        &self,
        path: &Path,
        lowered: &LoweredProgram,
        solved: &mut SolveResult,
        control: &mut Control<'_>,
    ) -> Option<ProofReport> {
        let found = &mut solved.found;
        let (program, squares) = lowered.stated();
        if let Some(point) = &mut solved.lowered_point {
            point.truncate(program.column_count());
        }
        let claim = match found.termination {
            Termination::Infeasible => Claim::Infeasible,
            _ if found.bound.is_finite() => {
                let point = solved.lowered_point.as_ref();
                let best = point.map_or(found.bound, |x| program.objective(x));
                let gap = self.options.allowed_gap(best, program.constant);
                Claim::Bound(found.bound.min(best) - gap)
            }
            _ => return None,
        };
        let (sign, counts) = (program.sign, &found.statistics);
        let best = solved.lowered_point.as_ref().map(|x| sign * program.objective(x));
        let (bound, elapsed) = (sign * found.bound, self.token.elapsed());
        let mut figures = Progress::new(counts.nodes, 0, counts.relaxations, best, bound, elapsed);
        figures.iterations = counts.iterations;
        figures.constant = sign * program.constant;
        control.report(&Event::Proving(figures));
        let (splits, cuts) = (std::mem::take(&mut found.splits), found.root_cuts.take());
        let guide = Guide::new(splits, solved.origins.take(), program.column_count(), cuts);
        let token = StopToken::new(self.options.time_limit, control.interrupt());
        let names = lowered.names.as_ref().map_or([&[][..]; 2], |[a, b]| [&a[..], &b[..]]);
        let point = solved.lowered_point.as_deref();
        let (options, token, cascades) = (self.options, &token, self.cascades);
        let asked = ProofRequest {
            program,
            squares,
            names,
            claim,
            options,
            token,
            most_splits: MOST_SPLITS,
            cascades,
        };
        let written =
            create(path).and_then(|file| asked.prove(guide, point, &mut BufWriter::new(file)));
        let failed = |error| ProofReport::failed(format!("{}: {error}", cannot_write(path)));
        Some(written.unwrap_or_else(failed))
    }
}

/// The file at a path, or a new one in it if it is a folder.
pub(super) fn create(path: &Path) -> io::Result<File> {
    if path.is_dir() { create_in(path).map(|(file, _)| file) } else { File::create(path) }
}

/// A new file in a folder.
fn create_in(path: &Path) -> io::Result<(File, PathBuf)> {
    let place = |k: usize| -> PathBuf { path.join(format!("{k:06}.proof")) };
    for k in 1..MOST_FILES {
        match OpenOptions::new().write(true).create_new(true).open(place(k)) {
            Err(error) if error.kind() == IoErrorKind::AlreadyExists => {}
            other => return other.map(|file| (file, place(k))),
        }
    }
    Err(IoErrorKind::AlreadyExists.into())
}

/// Writes the proof of a claim about a model that no search has made: that its (minimised)
/// objective is at least `bound`, or that it has no point. The log is one that no checker accepts
/// if the claim is false.
pub fn write_proof_of(
    model: &Model,
    bound: Option<f64>,
    out: &mut dyn Write,
) -> Result<ProofReport, Error> {
    let (options, token) = (&Options::default(), &StopToken::default());
    let Some(lowered) = lower(model, token, true)? else { return Err(ErrorKind::Other.into()) };
    let names = lowered.names.as_ref().map_or([&[][..]; 2], |[a, b]| [&a[..], &b[..]]);
    let claim = bound.map_or(Claim::Infeasible, Claim::Bound);
    let cascades = &CascadePool::new(options);
    let (program, squares) = lowered.stated();
    let asked = ProofRequest {
        program,
        squares,
        names,
        claim,
        options,
        token,
        most_splits: FEW_SPLITS,
        cascades,
    };
    asked.prove(Guide::default(), None, out).map_err(|source| {
        let (what, help) = ("the proof cannot be written".into(), "look at the writer");
        Error::with_source(ErrorKind::Io { what, help }, source)
    })
}
