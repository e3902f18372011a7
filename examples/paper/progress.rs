//! Progress on a terminal: a bar for all cases, and a line for each thread with its refuted and
//! open horizons.

use carom::hybrid::{HorizonEvent, HorizonVerdict};
use indicatif::{MultiProgress, ProgressBar, ProgressStyle};

/// The bar and the lines, shown only on a terminal.
pub(crate) struct Bars {
    all: MultiProgress,
    cases: ProgressBar,
}

impl Bars {
    pub(crate) fn new(cases: usize) -> Self {
        let all = MultiProgress::new();
        let cases = all.add(ProgressBar::new(cases as u64));
        if let Ok(style) = ProgressStyle::with_template("{bar:24} {pos}/{len} cases, {elapsed}") {
            cases.set_style(style);
        }
        Bars { all, cases }
    }

    /// A line for a thread.
    pub(crate) fn line(&self) -> Line {
        let bar = self.all.add(ProgressBar::new_spinner());
        if let Ok(style) = ProgressStyle::with_template("  {wide_msg}") {
            bar.set_style(style);
        }
        Line(bar)
    }

    pub(crate) fn done_one(&self) {
        self.cases.inc(1);
    }

    /// Restores the terminal; errors are ignored.
    pub(crate) fn clear(&self) {
        let _ = self.all.clear();
    }
}

/// The line of one thread.
#[derive(Clone)]
pub(crate) struct Line(ProgressBar);

impl Line {
    pub(crate) fn say(&self, what: &str) {
        self.0.set_message(what.to_owned());
    }

    /// Begins to show a search. If waiting is free, a refuted horizon refutes every smaller one.
    pub(crate) fn search(&self, label: String, waiting_is_free: bool) -> Horizons {
        Horizons {
            line: self.clone(),
            label,
            waiting_is_free,
            refuted: 0,
            feasible: None,
            by_sets: 0,
            solves: 0,
        }
    }
}

/// The refuted and the open horizons of one search.
pub(crate) struct Horizons {
    line: Line,
    label: String,
    waiting_is_free: bool,
    /// Every horizon up to this one is refuted.
    refuted: usize,
    /// The smallest horizon found feasible.
    feasible: Option<usize>,
    by_sets: usize,
    solves: usize,
}

impl Horizons {
    /// Processes an event and shows the state of the search.
    pub(crate) fn note(&mut self, event: &HorizonEvent) {
        match event {
            HorizonEvent::Started { refuted, feasible, .. } => {
                (self.refuted, self.feasible) = (*refuted, *feasible);
            }
            HorizonEvent::Decided(attempt) => {
                if attempt.is_solve() {
                    self.solves += 1;
                } else {
                    self.by_sets += 1;
                }
                match attempt.verdict {
                    HorizonVerdict::Feasible => self.feasible = Some(attempt.steps),
                    HorizonVerdict::Refuted(_)
                        if self.waiting_is_free || attempt.steps == self.refuted + 1 =>
                    {
                        self.refuted = self.refuted.max(attempt.steps);
                    }
                    _ => {}
                }
            }
            HorizonEvent::Logged(proof) => {
                self.line.say(&format!("{}: log of {} steps", self.label, proof.steps));
                return;
            }
            _ => return,
        }
        self.line.say(&self.text());
    }

    fn text(&self) -> String {
        let low = self.refuted + 1;
        let open = match self.feasible {
            Some(feasible) if feasible == low => format!("shortest {feasible}"),
            Some(feasible) => format!("open {low} to {}, feasible {feasible}", feasible - 1),
            None => format!("open from {low}"),
        };
        format!(
            "{}: refuted to {} (sets {}, solves {}), {open}",
            self.label, self.refuted, self.by_sets, self.solves
        )
    }
}
