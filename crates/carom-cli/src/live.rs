//! What is seen while a program is solved: lines on the standard error, and below them, on a
//! terminal, a line that moves.

use std::io::{self, Write};
use std::time::Duration;

use carom::prelude::{Event, Log, Solution};
use indicatif::{ProgressBar, ProgressStyle};

/// Between two turns of the spinner; what takes less shows nothing.
const TURN: Duration = Duration::from_millis(150);

/// Solves that take less than this have no figures in the moving line.
const PATIENCE: Duration = Duration::from_millis(500);

/// The lines and the moving line, or neither.
pub(crate) struct Live {
    spinner: ProgressBar,
    log: Option<Log<AboveSpinner>>,
}

impl Live {
    pub(crate) fn new(quiet: bool) -> Self {
        // It is hidden where the standard error is no terminal.
        let spinner = if quiet { ProgressBar::hidden() } else { ProgressBar::new_spinner() };
        if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {wide_msg}") {
            spinner.set_style(style);
        }
        spinner.enable_steady_tick(TURN);
        let log = (!quiet).then(|| Log::new(AboveSpinner::new(spinner.clone())));
        Live { spinner, log }
    }

    /// Says what is done before there are events.
    pub(crate) fn doing(&self, what: &str) {
        self.spinner.set_message(what.to_owned());
    }

    /// Writes something else while the moving line makes room.
    pub(crate) fn aside(&self, write: impl FnOnce()) {
        self.spinner.suspend(write);
    }

    /// Writes lines.
    pub(crate) fn say(&self, lines: &str) {
        if self.log.is_some() {
            self.spinner.suspend(|| eprintln!("{lines}"));
        }
    }

    /// Shows the state of a solve.
    pub(crate) fn show(&mut self, event: &Event) {
        if let Some(log) = &mut self.log {
            log.record(event);
        }
        let progress = event.progress();
        match event {
            Event::Presolved(..) => self.doing("the relaxation of the root"),
            Event::Relaxed(_) => self.doing("cuts at the root"),
            _ if progress.elapsed < PATIENCE => {}
            _ => {
                let best = match progress.incumbent {
                    Some(best) => {
                        format!("best {best:.6}, gap {:.3} %", 100.0 * progress.relative_gap())
                    }
                    None => "no point yet".into(),
                };
                self.spinner.set_message(format!(
                    "{best}, bound {:.6}, {} nodes, {} open",
                    progress.bound, progress.nodes, progress.open
                ));
            }
        }
    }

    /// Removes the moving line.
    pub(crate) fn end(&self) {
        self.spinner.finish_and_clear();
    }

    /// Writes the long summary.
    pub(crate) fn summarise(&mut self, solution: &Solution) {
        if let Some(log) = &mut self.log {
            log.finish(solution);
        }
    }
}

impl Drop for Live {
    fn drop(&mut self) {
        self.end();
    }
}

/// Writes whole lines to the standard error while the spinner makes room.
struct AboveSpinner {
    spinner: ProgressBar,
    line: Vec<u8>,
}

impl AboveSpinner {
    fn new(spinner: ProgressBar) -> Self {
        AboveSpinner { spinner, line: Vec::new() }
    }
}

impl Write for AboveSpinner {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.line.extend(bytes);
        if self.line.ends_with(b"\n") {
            self.flush()?;
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        let line = std::mem::take(&mut self.line);
        self.spinner.suspend(|| io::stderr().write_all(&line))
    }
}
