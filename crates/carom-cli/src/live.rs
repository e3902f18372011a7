//! The lines that are seen while a program is solved: on the standard error, and below them, on a
//! terminal, a line that moves. Elsewhere a line now and then tells that something is done.

use std::io::{self, Write};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use carom::prelude::{Event, Log, Solution};
use console::Term;
use indicatif::{ProgressBar, ProgressStyle};

use crate::answer::counted;

/// Between two turns of the spinner; what takes less shows nothing.
const TURN: Duration = Duration::from_millis(150);

/// Solves that take less than this have no figures in the moving line.
const PATIENCE: Duration = Duration::from_millis(500);

/// The longest silence where nothing moves, at first. Later it is a part of the time that has
/// passed, so that a long search does not fill a file.
const SILENCE: Duration = Duration::from_secs(5);
const SILENCE_SHARE: u32 = 10;
const LONGEST_SILENCE: Duration = Duration::from_secs(60);

/// The lines and the moving line, or neither.
pub(crate) struct Live {
    spinner: ProgressBar,
    log: Option<Log<AboveSpinner>>,
    work: Arc<Work>,
    /// The thread that breaks the silence where nothing moves.
    keeper: Option<JoinHandle<()>>,
}

/// The current work, and when it was last told of.
struct Work {
    state: Mutex<WorkState>,
    /// Wakes the keeper at the end.
    ended: Condvar,
}

struct WorkState {
    began: Instant,
    /// The current work, since when, and when a line was last written.
    what: &'static str,
    since: Instant,
    told: Instant,
    is_over: bool,
}

impl Work {
    fn new(what: &'static str) -> Self {
        let now = Instant::now();
        let state = WorkState { began: now, what, since: now, told: now, is_over: false };
        Work { state: Mutex::new(state), ended: Condvar::new() }
    }

    fn lock(&self) -> MutexGuard<'_, WorkState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn tell(&self) {
        self.lock().told = Instant::now();
    }

    /// Writes a line whenever nothing was written for too long, until all is over.
    fn keep(&self) {
        let mut state = self.lock();
        while !state.is_over {
            let all = state.began.elapsed();
            let most = (all / SILENCE_SHARE).clamp(SILENCE, LONGEST_SILENCE);
            let silent = state.told.elapsed();
            if silent >= most {
                let own = state.since.elapsed().as_secs_f64();
                eprintln!("still at {}, for {own:.0} s ({:.2} s)", state.what, all.as_secs_f64());
                state.told = Instant::now();
                continue;
            }
            let waited = self.ended.wait_timeout(state, most - silent);
            state = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }
}

impl Live {
    pub(crate) fn new(quiet: bool) -> Self {
        // It is hidden where the standard error is no terminal.
        let spinner = if quiet { ProgressBar::hidden() } else { ProgressBar::new_spinner() };
        if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {wide_msg}") {
            spinner.set_style(style);
        }
        spinner.enable_steady_tick(TURN);
        let work = Arc::new(Work::new("reading"));
        let log = (!quiet).then(|| {
            let log = Log::new(AboveSpinner::new(spinner.clone(), Arc::clone(&work)));
            match Term::stderr().size_checked() {
                Some((_, columns)) => log.with_width(columns.into()),
                None => log,
            }
        });
        let is_still = !quiet && spinner.is_hidden();
        let keeper = is_still.then(|| {
            let work = Arc::clone(&work);
            thread::spawn(move || work.keep())
        });
        Live { spinner, log, work, keeper }
    }

    /// Says what is done.
    pub(crate) fn doing(&self, what: &'static str) {
        let mut state = self.work.lock();
        (state.what, state.since) = (what, Instant::now());
        drop(state);
        self.spinner.set_message(what);
    }

    /// Writes something else while the moving line makes room.
    pub(crate) fn aside(&self, write: impl FnOnce()) {
        self.spinner.suspend(write);
    }

    /// Writes lines.
    pub(crate) fn say(&mut self, lines: &str) {
        if let Some(log) = &mut self.log {
            log.say(lines);
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
            Event::Root(_) => self.doing("the search"),
            Event::Proving(_) => self.doing("the proof"),
            _ if progress.elapsed < PATIENCE => {}
            _ => {
                let best = match progress.incumbent {
                    Some(best) => {
                        format!("best {best:.6}, gap {:.3} %", 100.0 * progress.relative_gap())
                    }
                    None => "no point yet".into(),
                };
                let nodes = counted(progress.nodes as usize, "node");
                self.spinner.set_message(format!(
                    "{best}, bound {:.6}, {nodes}, {} open",
                    progress.bound, progress.open
                ));
            }
        }
    }

    /// Removes the moving line, and ends what breaks the silence.
    pub(crate) fn end(&mut self) {
        self.work.lock().is_over = true;
        self.work.ended.notify_all();
        if let Some(keeper) = self.keeper.take() {
            // It cannot panic.
            let _ = keeper.join();
        }
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
    work: Arc<Work>,
    line: Vec<u8>,
}

impl AboveSpinner {
    fn new(spinner: ProgressBar, work: Arc<Work>) -> Self {
        AboveSpinner { spinner, work, line: Vec::new() }
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
        self.work.tell();
        self.spinner.suspend(|| io::stderr().write_all(&line))
    }
}
