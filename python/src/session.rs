//! A solve on a thread of its own, and the wait for it on the thread that called.
//!
//! The solving thread knows nothing of Python. The calling thread is detached from the interpreter
//! while it waits, so that others run, and comes back to ask for signals, to print lines and to call
//! back. So an interrupt is heard at once, whatever the solve is at, and a panic ends the solving
//! thread alone.

use std::io::{self, Write};
use std::ops::ControlFlow;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

use carom::Error;
use carom::solution::Solution;
use carom::solver::{Control, Event, Incumbent, Interrupt, Log};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::PyModule;

use crate::errors::broken;
use crate::numbers::bytes;
use crate::settings::Task;

/// How long an interrupt waits until the solve hears of it.
const HEARING: Duration = Duration::from_millis(50);

/// As much as a main thread has; that of other threads is a quarter of it.
const STACK_BYTES: usize = 8 << 20;

/// What the solving thread says.
enum Message<T> {
    Found(Found),
    Line(String),
    Done(T),
}

/// A new best point.
struct Found {
    values: Vec<f64>,
    objective: f64,
    bound: f64,
    gap: f64,
    nodes: u64,
    seconds: f64,
}

/// A solution, and how long the call of the solver took (s).
pub(crate) struct Solved {
    pub(crate) solution: Solution,
    pub(crate) seconds: f64,
}

/// The solving thread's end.
pub(crate) struct Solving<T> {
    messages: Sender<Message<T>>,
    /// Whether to go on after a point.
    replies: Receiver<bool>,
}

/// The calling thread's end.
pub(crate) struct Calling<T> {
    messages: Receiver<Message<T>>,
    replies: Sender<bool>,
}

/// Who watches a solve, and what stops it.
pub(crate) struct Watch<'a> {
    pub(crate) interrupt: Interrupt,
    pub(crate) callback: Option<&'a Py<PyAny>>,
    /// How many variables are shown.
    pub(crate) columns: usize,
}

/// Both ends of a talk.
pub(crate) fn link<T>() -> (Calling<T>, Solving<T>) {
    let (message, messages) = channel();
    let (reply, replies) = channel();
    (Calling { messages, replies: reply }, Solving { messages: message, replies })
}

/// Starts a thread that solves.
pub(crate) fn spawn(work: impl FnOnce() + Send + 'static) -> PyResult<thread::JoinHandle<()>> {
    Ok(thread::Builder::new().name("carom".into()).stack_size(STACK_BYTES).spawn(work)?)
}

/// Does work on a thread of its own and waits for it.
pub(crate) fn run<T: Send + 'static>(
    py: Python<'_>,
    watch: &Watch<'_>,
    work: impl FnOnce(&Solving<T>) -> T + Send + 'static,
) -> PyResult<T> {
    let (mut calling, solving) = link();
    let thread = spawn(move || {
        let done = work(&solving);
        solving.done(done);
    })?;
    let answer = calling.wait(py, watch);
    // How it ended is known from what it said.
    let _ = py.detach(|| thread.join());
    answer
}

impl<T> Solving<T> {
    /// Says what came of the work. If nobody listens, nobody needs it.
    pub(crate) fn done(&self, done: T) {
        let _ = self.messages.send(Message::Done(done));
    }

    fn line(&self, line: String) {
        let _ = self.messages.send(Message::Line(line));
    }

    /// Shows a point, and waits until the caller says whether to go on.
    fn show(&self, best: &Incumbent<'_>) -> ControlFlow<()> {
        let found = Found {
            values: best.point.as_slice().to_vec(),
            objective: best.objective,
            bound: best.progress.bound,
            gap: best.progress.relative_gap(),
            nodes: best.progress.nodes,
            seconds: best.progress.elapsed.as_secs_f64(),
        };
        let is_heard = self.messages.send(Message::Found(found)).is_ok();
        match is_heard && self.replies.recv() == Ok(true) {
            true => ControlFlow::Continue(()),
            false => ControlFlow::Break(()),
        }
    }

    /// Solves under a control that reports to the caller.
    pub(crate) fn solve(
        &self,
        task: &Task,
        solve: impl FnOnce(&mut Control<'_>) -> Result<Solution, Error>,
    ) -> Result<Solved, Error> {
        let mut show = |best: &Incumbent<'_>| self.show(best);
        let mut log = task.is_verbose.then(|| Log::new(Lines { of: self, text: Vec::new() }));
        let mut record = |event: &Event| log.iter_mut().for_each(|log| log.record(event));
        let mut control = Control::default().with_interrupt(&task.interrupt);
        if task.is_watched {
            control = control.with_incumbent(&mut show);
        }
        if task.is_verbose {
            control = control.with_progress(&mut record);
        }
        if let Some(start) = &task.start {
            control = control.with_start(start);
        }
        let began = Instant::now();
        let solution = solve(&mut control)?;
        let seconds = began.elapsed().as_secs_f64();
        log.iter_mut().for_each(|log| log.finish(&solution));
        Ok(Solved { solution, seconds })
    }
}

/// A writer whose lines the caller prints.
struct Lines<'a, T> {
    of: &'a Solving<T>,
    text: Vec<u8>,
}

impl<T> Write for Lines<'_, T> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.text.extend(bytes);
        while let Some(end) = self.text.iter().position(|byte| *byte == b'\n') {
            let line: Vec<u8> = self.text.drain(..=end).collect();
            self.of.line(String::from_utf8_lossy(&line).trim_end().to_owned());
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl<T: Send> Calling<T> {
    /// Waits until the work is done. An interrupt by Ctrl-C stops it and is heard no further; an
    /// exception of the callback or of a handler of signals stops it and is raised then.
    pub(crate) fn wait(&mut self, py: Python<'_>, watch: &Watch<'_>) -> PyResult<T> {
        let mut raised: Option<PyErr> = None;
        let mut stop = |error: PyErr| {
            watch.interrupt.trigger();
            if !error.is_instance_of::<PyKeyboardInterrupt>(py) {
                raised.get_or_insert(error);
            }
        };
        let done = loop {
            let messages = &mut self.messages;
            match py.detach(move || messages.recv_timeout(HEARING)) {
                Ok(Message::Done(done)) => break done,
                Ok(Message::Line(line)) => print(py, &line).unwrap_or_else(&mut stop),
                Ok(Message::Found(found)) => {
                    let goes_on = watch.call(py, &found).unwrap_or_else(|error| {
                        stop(error);
                        false
                    });
                    // A thread that has ended asks no more.
                    let _ = self.replies.send(goes_on);
                }
                Err(RecvTimeoutError::Timeout) => {
                    py.check_signals().unwrap_or_else(&mut stop);
                }
                Err(RecvTimeoutError::Disconnected) => return Err(broken()),
            }
        };
        raised.map_or(Ok(done), Err)
    }
}

impl Watch<'_> {
    /// Calls back with a point; whether to go on.
    fn call(&self, py: Python<'_>, found: &Found) -> PyResult<bool> {
        let Some(callback) = self.callback else { return Ok(true) };
        let shown = found.values.get(..self.columns).unwrap_or(&found.values);
        let Found { objective, bound, gap, nodes, seconds, .. } = *found;
        let said = callback.call1(py, (bytes(py, shown), objective, bound, gap, nodes, seconds))?;
        Ok(!said.is_truthy(py)?)
    }
}

/// Prints a line as Python does, so that notebooks show it.
fn print(py: Python<'_>, line: &str) -> PyResult<()> {
    PyModule::import(py, "builtins")?.getattr("print")?.call1((line,))?;
    Ok(())
}
