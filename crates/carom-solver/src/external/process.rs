//! Runs a program in a private folder, with a deadline and an interrupt.

use std::fs::{self, File};
use std::io;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;

use tempfile::TempDir;
use web_time::{Duration, Instant};

use super::dialect::{Dialect, ExternalAnswer, Files, SolverClaim};
use crate::error::{Error, ErrorKind};
use crate::solution::Termination;
use crate::solver::{Options, StopToken};

/// Interval between checks of a running program.
const POLLING_INTERVAL: Duration = Duration::from_millis(5);

/// Time that a program gets after its own time limit to write its answer.
const GRACE_PERIOD: Duration = Duration::from_secs(2);

/// The advice if the folder or its files cannot be made.
const FOLDER_HELP: &str =
    "check that the folder for temporary files exists, is writable and has room";

/// One call of a program.
pub(super) struct ProgramRun<'a> {
    pub(super) dialect: &'a dyn Dialect,
    pub(super) program: &'a str,
    pub(super) options: &'a Options,
    pub(super) token: &'a StopToken,
}

impl ProgramRun<'_> {
    /// Runs the program on a model and reads the answer. Also returns why the program was stopped,
    /// if it was.
    pub(super) fn answer(
        &self,
        model: &str,
    ) -> Result<(ExternalAnswer, Option<Termination>), Error> {
        let time_left = self.token.left();
        if let Some(reason) = self.token.ended() {
            return Ok((ExternalAnswer::new(SolverClaim::Unknown), Some(reason)));
        }
        let folder = private_folder()
            .map_err(|e| self.refused("no temporary folder can be made for", FOLDER_HELP, e))?;
        let files = Files {
            model: folder.path().join("model.mps"),
            solution: folder.path().join("solution.txt"),
            settings: folder.path().join("settings.txt"),
        };
        let written = |path: &Path, text: &str| {
            fs::write(path, text)
                .map_err(|e| self.refused("files cannot be written for", FOLDER_HELP, e))
        };
        written(&files.model, model)?;
        if let Some(settings) = self.dialect.settings(self.options, time_left) {
            written(&files.settings, &settings)?;
        }
        let log = folder.path().join("printed");
        let output = File::create(&log).and_then(|file| Ok((file.try_clone()?, file)));
        let (output, errors) =
            output.map_err(|e| self.refused("files cannot be written for", FOLDER_HELP, e))?;
        let child = Command::new(self.program)
            .args(self.dialect.arguments(&files, self.options, time_left))
            .current_dir(folder.path())
            .stdin(Stdio::null())
            .stdout(output)
            .stderr(errors)
            .spawn()
            .map_err(|e| {
                self.refused("cannot start", "check that it is installed and on the `PATH`", e)
            })?;
        let stopped = self.wait(child, time_left)?;
        let read = |path: &Path| match fs::read(path) {
            Ok(bytes) => Ok(Some(String::from_utf8_lossy(&bytes).into_owned())),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(self.refused("cannot read the answer of", "solve again", error)),
        };
        let (printed, solution) = (read(&log)?.unwrap_or_default(), read(&files.solution)?);
        match self.dialect.read(solution.as_deref(), &printed) {
            Ok(answer) => Ok((answer, stopped)),
            Err(_) if stopped.is_some() => Ok((ExternalAnswer::new(SolverClaim::Unknown), stopped)),
            Err(what) => {
                let last: Vec<&str> = printed.lines().rev().take(3).collect();
                let last: Vec<&str> = last.into_iter().rev().collect();
                let message = format!("{what}; it printed last: {}", last.join(" / "));
                Err(ErrorKind::Backend { solver: self.program.into(), message }.into())
            }
        }
    }

    /// Waits for the end, or makes one at the deadline or on an interrupt.
    fn wait(
        &self,
        mut child: Child,
        time_left: Option<Duration>,
    ) -> Result<Option<Termination>, Error> {
        let deadline = time_left.and_then(|left| Instant::now().checked_add(left + GRACE_PERIOD));
        loop {
            match child.try_wait() {
                Ok(Some(_)) => return Ok(None),
                Ok(None) => {}
                Err(error) => return Err(self.refused("cannot wait for", "solve again", error)),
            }
            let reason = if self.token.interrupt().is_triggered() {
                Some(Termination::Interrupted)
            } else {
                let late = deadline.is_some_and(|deadline| Instant::now() >= deadline);
                late.then_some(Termination::TimeLimit)
            };
            if reason.is_some() {
                // Both may fail because the program has ended by itself.
                let _ = child.kill();
                let _ = child.wait();
                return Ok(reason);
            }
            thread::sleep(POLLING_INTERVAL);
        }
    }

    fn refused(&self, what: &str, help: &'static str, error: io::Error) -> Error {
        let what = format!("{what} `{}`", self.program);
        Error::with_source(ErrorKind::Io { what, help }, error)
    }
}

/// A folder that nobody else can read, under a random name, removed when it is dropped.
fn private_folder() -> io::Result<TempDir> {
    let mut builder = tempfile::Builder::new();
    builder.prefix("carom-");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o700));
    builder.tempdir()
}
