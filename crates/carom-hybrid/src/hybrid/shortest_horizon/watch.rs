//! The receivers of a search's events: a callback in its options, and the log for people.

use std::fmt;
use std::io::Write;
use std::sync::{Arc, Mutex, PoisonError};

use super::event::HorizonEvent;
use super::options::ShortestOptions;
use super::outcome::{HorizonRefutation, HorizonVerdict};
use crate::number::counted;
use crate::solver::Log;

/// Receives the events of searches.
#[derive(Clone, Default)]
pub(super) struct Watch(Option<Arc<Mutex<Callback>>>);

type Callback = dyn FnMut(&HorizonEvent) + Send;

impl fmt::Debug for Watch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.is_some() { "Watch" } else { "nobody" })
    }
}

impl ShortestOptions {
    /// Sets who is told what the search does: which horizons are refuted, which one is solved, its
    /// bound and nodes. A [`Log`] writes that for people. It holds for every search with these
    /// options: of systems, scenes, robust plans and the paper's vehicle. Events come on the thread
    /// of the search.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// let mut cart = HybridSystem::new(0.1); // s
    /// let x = cart.state("x", -9.0, 9.0)?; // m
    /// let v = cart.state("v", -9.0, 9.0)?; // m/s
    /// let a = cart.input("a", -1.0, 1.0)?; // m/s²
    /// cart.mode("roll")?.rates([x.is(v), v.is(a)])?;
    /// let (start, goal) = ([x.equals(0.0), v.equals(0.0)], [x.equals(1.0), v.equals(0.0)]);
    /// let mut log = Log::new(std::io::stderr());
    /// let options = ShortestOptions::default().with_progress(move |event| event.record(&mut log));
    /// let found = cart.shortest_with(start, goal, &options, &mut BranchAndBound::default())?;
    /// assert_eq!(found.steps, Some(20));
    /// # Ok::<(), carom::Error>(())
    /// ```
    #[must_use]
    pub fn with_progress(mut self, callback: impl FnMut(&HorizonEvent) + Send + 'static) -> Self {
        self.watch = Watch(Some(Arc::new(Mutex::new(callback))));
        self
    }

    /// The same for a search that nobody asked for.
    pub(super) fn unwatched(mut self) -> Self {
        self.watch = Watch::default();
        self
    }

    /// Tells an event to who watches.
    pub(super) fn tell(&self, event: &HorizonEvent) {
        if let Some(callback) = &self.watch.0 {
            (callback.lock().unwrap_or_else(PoisonError::into_inner))(event);
        }
    }
}

impl HorizonEvent {
    /// Writes the line of this event to a log, see [`ShortestOptions::with_progress`]: how many
    /// steps are refuted by reach sets; what each solve has decided; and about once a second at
    /// first, later less often, the solve at work.
    ///
    /// The columns of the solve at work are: its number of steps, up to how many steps are refuted,
    /// the fewest steps for which there is a plan, nodes processed, nodes open, the bound of the
    /// solve, and seconds since the search began.
    pub fn record<W: Write>(&self, log: &mut Log<W>) {
        match self {
            HorizonEvent::Started { steps: _, refuted, feasible } => {
                log.set_at_work(*refuted, *feasible);
            }
            HorizonEvent::Solving { steps, progress } => {
                write_refuted(log);
                log.solving(*steps, progress);
            }
            HorizonEvent::Decided(attempt) => {
                let steps = attempt.steps;
                if attempt.verdict == HorizonVerdict::Refuted(HorizonRefutation::Sets) {
                    log.refuted_by_sets().push(steps);
                    return;
                }
                write_refuted(log);
                log.line(format_args!("{attempt}"));
            }
            HorizonEvent::Logged(proof) => {
                write_refuted(log);
                let what = if proof.is_complete() { "complete" } else { "not complete" };
                log.line(format_args!("the log of {} is {what}", counted(proof.steps, "step")));
                let failure = proof.report.as_ref().and_then(|report| report.failure.as_ref());
                failure.iter().for_each(|failure| log.line(format_args!("{failure}")));
            }
        }
    }
}

/// Writes which numbers of steps sets have refuted since the last line.
fn write_refuted<W: Write>(log: &mut Log<W>) {
    let steps = std::mem::take(log.refuted_by_sets());
    match (steps.first(), steps.last()) {
        (Some(first), Some(last)) if steps.len() == last.abs_diff(*first) + 1 && first < last => {
            log.line(format_args!("{first} to {last} steps: refuted by reach sets"));
        }
        _ => {
            for steps in steps {
                log.line(format_args!("{}: refuted by reach sets", counted(steps, "step")));
            }
        }
    }
}
