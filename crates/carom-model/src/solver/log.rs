//! A log for people, in columns.

use std::fmt;
use std::io::{self, Write};

use web_time::{Duration, Instant};

use super::log_columns::LogColumns;
use super::progress::{Event, Progress};
use crate::number::{DIGITS, counted, rounded};
use crate::solution::{
    FacetCounts, Heuristic, ProofReport, RelaxationCounts, Solution, Termination, Verification,
};

/// Lines between two headings.
const LINES_PER_HEADING: u64 = 25;

/// The narrowest terminal (characters).
const LEAST_WIDTH: usize = 40;

/// The least width of the columns of a search for the shortest horizon (characters).
const HORIZON_WIDTH: usize = 80;

/// Violations that are named.
const NAMED_VIOLATIONS: usize = 3;

/// Shortest time between two lines that report nothing new, at first. Later it is a part of the
/// time that has passed, so that a long search does not fill the screen.
const REPORT_INTERVAL: Duration = Duration::from_secs(1);
const REPORT_SHARE: u32 = 10;
const LONGEST_INTERVAL: Duration = Duration::from_secs(60);

/// A progress callback that writes what presolve has left, the bound of the root before and after
/// cuts, and then a line for the root, for every new best point, where the search begins again with
/// facets, and about once a second at first, later less often.
///
/// The columns are: nodes processed, nodes open, largest depth, iterations of all relaxations, best
/// objective, bound, relative gap in percent, an [estimate](Progress::explored) of the part of the
/// tree that is done, in percent, and seconds. Narrow lines have fewer of them, see
/// [`with_width`](Self::with_width). A line for a new best point begins with the mark of its
/// heuristic, see [`Heuristic::mark`](crate::solution::Heuristic::mark); the marks are explained
/// above the first line.
///
/// Objectives and bounds below 1e-12 of the largest one in the log are shown as 0.
///
/// Events of searches for the shortest horizon, of systems, scenes and others, write themselves:
/// `event.record(&mut log)`.
///
/// ```
/// use carom::prelude::*;
///
/// let mut model = Model::new("m");
/// let x = model.binary("x")?;
/// model.maximize(x)?;
///
/// let mut log = Log::new(Vec::new()); // or `std::io::stderr()`
/// let mut callback = |event: &Event| log.record(event);
/// let mut control = Control::default().with_progress(&mut callback);
/// let solution = BranchAndBound::default().solve_with(&model, &mut control)?;
/// log.finish(&solution);
/// let text = String::from_utf8(log.into_inner().unwrap()).unwrap();
/// assert!(text.contains("incumbent"));
/// assert!(text.contains("optimal"));
/// # Ok::<(), carom::Error>(())
/// ```
pub struct Log<W: Write> {
    writer: W,
    /// The most characters of a line.
    width: usize,
    columns: LogColumns,
    lines: u64,
    /// The bound of the root before cuts, until the root is done.
    relaxed: Option<f64>,
    /// The best objective of the last line.
    told: Option<f64>,
    /// When the last line was written, in time since its solve began.
    last: Option<Duration>,
    failed: Option<io::Error>,
    /// The search of which a solve is a part.
    searched: Option<Searched>,
}

/// State of the log of a search that solves many programs.
struct Searched {
    began: Instant,
    /// When the last line was written, in time since the search began.
    last: Duration,
    lines: u64,
    /// Up to how many steps are refuted, and for how many there is a plan.
    at_work: (usize, Option<usize>),
    /// The numbers of steps that sets have refuted since the last line.
    by_sets: Vec<usize>,
}

impl<W: Write> Log<W> {
    /// A log that writes to `writer`, with lines of any length.
    pub fn new(writer: W) -> Self {
        Log {
            writer,
            width: usize::MAX,
            columns: LogColumns::new(usize::MAX),
            lines: 0,
            relaxed: None,
            told: None,
            last: None,
            failed: None,
            searched: None,
        }
    }

    /// Sets the width of a terminal (characters, at least 40). Lines about a search have the
    /// columns that fit, and texts are broken between words.
    #[must_use]
    pub fn with_width(mut self, width: usize) -> Self {
        self.width = width.max(LEAST_WIDTH);
        self.columns = LogColumns::new(self.width);
        self
    }

    /// Writes the line of an event. After an error of the writer nothing more is written, and
    /// [`into_inner`](Self::into_inner) returns the error.
    pub fn record(&mut self, event: &Event) {
        let progress = event.progress();
        let seconds = progress.elapsed.as_secs_f64();
        // What is earlier than the last line is of another solve.
        if self.last.is_some_and(|last| progress.elapsed < last) {
            (self.last, self.told) = (None, None);
        }
        let is_news = progress.incumbent.is_some() && progress.incumbent != self.told;
        match event {
            Event::Presolved(size, _) => {
                self.told = None;
                return self.text(format_args!("presolve left {size} ({seconds:.2} s)"));
            }
            Event::Relaxed(_) => {
                self.relaxed = Some(progress.bound);
                let bound = self.columns.number(progress.bound);
                let iterations = counted(progress.iterations, "iteration");
                return self.text(format_args!(
                    "bound of the root {bound}, after {iterations} ({seconds:.2} s)"
                ));
            }
            Event::Proving(_) => {
                return self.text(format_args!("the proof is written ({seconds:.2} s)"));
            }
            Event::Root(_) => {
                if self.relaxed.take().is_some_and(|first| first != progress.bound) {
                    let bound = self.columns.number(progress.bound);
                    let cuts = counted(progress.cuts, "cut");
                    self.text(format_args!("bound after {cuts} {bound} ({seconds:.2} s)"));
                }
            }
            Event::BegunAgain(counts, _) => {
                let facets = self.facets_line(counts);
                return self.text(format_args!(
                    "the search begins again after {}: {facets} ({seconds:.2} s)",
                    counted(progress.nodes, "node"),
                ));
            }
            // The line of the root has told of it.
            Event::Incumbent(_) if !is_news => return,
            Event::Incumbent(_) => {}
            Event::Progress(_) => {
                let is_early = |last| progress.elapsed < last + interval(last);
                if !is_news && self.last.is_some_and(is_early) {
                    return;
                }
            }
        }
        let mark = match is_news {
            true => progress.found_by.map_or('*', |heuristic| heuristic.mark()),
            false => ' ',
        };
        (self.last, self.told) = (Some(progress.elapsed), progress.incumbent);
        if self.lines == 0 {
            self.explain_marks();
        }
        if self.lines.is_multiple_of(LINES_PER_HEADING) {
            let heading = self.columns.heading();
            self.write(format_args!("{heading}\n"));
        }
        self.lines += 1;
        let line = self.columns.row(mark, progress);
        self.write(format_args!("{line}\n"));
    }

    /// Explains what is not told by the heading.
    fn explain_marks(&mut self) {
        let marks = Heuristic::ALL.map(|source| format!("{} {source}", source.mark()));
        self.text(format_args!("new best points are marked by their source: {}", marks.join(", ")));
        if self.columns.shows_explored() {
            self.text(format_args!(
                "tree % estimates the part of the tree that is done, as if all its parts were even"
            ));
        }
    }

    /// Writes a summary: the outcome, the times by activity and the points by heuristic.
    pub fn finish(&mut self, solution: &Solution) {
        let statistics = solution.statistics();
        let mut number = |value: f64| self.columns.number(solution.cleaned(value));
        let objective = solution.objective().map_or("-".to_owned(), &mut number);
        let bound = match solution.termination() {
            Termination::Unbounded => "-".to_owned(),
            _ => number(solution.bound()),
        };
        self.text(format_args!(
            "{}: objective {objective}, bound {bound}, {} in {:.2} s ({:.0} a second)",
            solution.termination(),
            counted(statistics.nodes, "node"),
            statistics.time.as_secs_f64(),
            statistics.nodes_per_second(),
        ));
        for note in solution.notes() {
            self.text(format_args!("{note}"));
        }
        if let Some(check) = solution.refused() {
            self.text(format_args!("{}", refusal(check)));
        }
        if let Some(check) = solution.verification().filter(|_| solution.point().is_some()) {
            let violation = rounded(check.largest_residual(), 3);
            self.text(format_args!("largest violation of the point: {violation}"));
        }
        if let Some(report) = solution.proof() {
            self.text(format_args!("{}", proof_line(report)));
        }
        self.text(format_args!(
            "{}, {}, depth {}, at most {} open, {}",
            counted(statistics.relaxations, "relaxation"),
            counted(statistics.iterations, "iteration"),
            statistics.depth,
            statistics.max_open,
            counted(statistics.tree_bytes, "byte"),
        ));
        let RelaxationCounts { dual_simplex, active_set, interior_point, clarabel, given_up } =
            statistics.relaxation_counts;
        self.text(format_args!(
            "relaxations: dual simplex {dual_simplex}, active set {active_set}, interior point \
             {interior_point}, Clarabel {clarabel}; the first method gave up {}",
            counted(given_up, "time"),
        ));
        if statistics.facets.facets > 0 {
            let facets = self.facets_line(&statistics.facets);
            self.text(format_args!("{facets}"));
        }
        if statistics.blocks > 0 {
            let blocks = counted(statistics.blocks, "block");
            self.text(format_args!("{blocks}, one after the other"));
        }
        self.text(format_args!(
            "ended: propagation {}, relaxation {}, bound {}, leaf {}; split {}, unfinished {}",
            statistics.refuted_by_propagation,
            statistics.refuted_by_relaxation,
            statistics.cut_off,
            statistics.leaves,
            statistics.split,
            statistics.unfinished,
        ));
        let total = statistics.times.total().as_secs_f64().max(f64::MIN_POSITIVE);
        let share = |(name, time): (&str, Duration)| {
            format!("{name} {:.0} %", 100.0 * time.as_secs_f64() / total)
        };
        let shares: Vec<String> = statistics.times.parts().into_iter().map(share).collect();
        self.text(format_args!("time: {}", shares.join(", ")));
        for (heuristic, count) in statistics.heuristics.iter().filter(|(_, c)| c.calls > 0) {
            self.text(format_args!(
                "{} {heuristic}: {}, {}, {} of them the best so far",
                heuristic.mark(),
                counted(count.calls, "call"),
                counted(count.points, "point"),
                count.incumbents
            ));
        }
    }

    /// How many facets there are, of how many unions, and what they lift.
    fn facets_line(&mut self, counts: &FacetCounts) -> String {
        let [before, after] =
            [counts.root_before, counts.root_after].map(|value| self.columns.number(value));
        format!("{counts} lift the root from {before} to {after}")
    }

    /// Writes a text among the lines, broken between words where it is too long for a line.
    pub fn say(&mut self, text: &str) {
        self.text(format_args!("{text}"));
    }

    /// The writer.
    ///
    /// # Errors
    ///
    /// The first error of the writer.
    pub fn into_inner(self) -> io::Result<W> {
        self.failed.map_or(Ok(self.writer), Err)
    }

    /// The search that is watched; it begins with its first event.
    fn searched(&mut self) -> &mut Searched {
        self.searched.get_or_insert_with(|| Searched {
            began: Instant::now(),
            last: Duration::ZERO,
            lines: 0,
            at_work: (0, None),
            by_sets: Vec::new(),
        })
    }

    /// Says up to how many steps a search has refuted, and for how many there is a plan.
    #[doc(hidden)]
    pub fn set_at_work(&mut self, refuted: usize, feasible: Option<usize>) {
        self.searched().at_work = (refuted, feasible);
    }

    /// The numbers of steps that sets have refuted since the last line.
    #[doc(hidden)]
    pub fn refuted_by_sets(&mut self) -> &mut Vec<usize> {
        &mut self.searched().by_sets
    }

    /// Writes a line about a search, with the seconds since it began.
    #[doc(hidden)]
    pub fn line(&mut self, text: fmt::Arguments<'_>) {
        let searched = self.searched();
        searched.last = searched.began.elapsed();
        let seconds = searched.last.as_secs_f64();
        self.text(format_args!("{text} ({seconds:.2} s)"));
    }

    /// Writes a line about the solve at work of a search, if the last line is some time ago.
    #[doc(hidden)]
    pub fn solving(&mut self, steps: usize, progress: &Progress) {
        let searched = self.searched();
        let elapsed = searched.began.elapsed();
        if elapsed < searched.last + interval(searched.last) {
            return;
        }
        let is_first = searched.lines.is_multiple_of(LINES_PER_HEADING);
        (searched.last, searched.lines) = (elapsed, searched.lines + 1);
        let (refuted, feasible) = searched.at_work;
        let bound = self.columns.number(progress.bound);
        if self.width < HORIZON_WIDTH {
            let (steps, nodes) = (counted(steps, "step"), counted(progress.nodes, "node"));
            return self.line(format_args!("{steps} at work: {nodes}, bound {bound}"));
        }
        if is_first {
            self.write(format_args!(
                "  {:>7} {:>9} {:>9} {:>9} {:>8} {:>16} {:>9}\n",
                "steps", "refuted", "a plan of", "nodes", "open", "bound", "seconds"
            ));
        }
        let feasible = feasible.map_or("-".to_owned(), |steps| steps.to_string());
        let (nodes, open) = (progress.nodes, progress.open);
        let seconds = elapsed.as_secs_f64();
        self.write(format_args!(
            "  {steps:>7} {refuted:>9} {feasible:>9} {nodes:>9} {open:>8} {bound:>16} {seconds:>9.2}\n"
        ));
    }

    /// Writes lines of text.
    fn text(&mut self, text: fmt::Arguments<'_>) {
        let text = text.to_string();
        for line in text.lines() {
            let broken = broken(line, self.width);
            self.write(format_args!("{broken}\n"));
        }
    }

    fn write(&mut self, text: fmt::Arguments<'_>) {
        if self.failed.is_none() {
            self.failed = self.writer.write_fmt(text).err();
        }
    }
}

impl<W: Write> fmt::Debug for Log<W> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Log").field("lines", &self.lines).finish_non_exhaustive()
    }
}

/// The time between two lines that report nothing new, after some time.
fn interval(elapsed: Duration) -> Duration {
    (elapsed / REPORT_SHARE).clamp(REPORT_INTERVAL, LONGEST_INTERVAL)
}

/// The violations of the nearest refused point of a stalled search, in a line.
fn refusal(check: &Verification) -> String {
    let violations = check.violations();
    let named: Vec<String> =
        violations.iter().take(NAMED_VIOLATIONS).map(ToString::to_string).collect();
    let more = match violations.len().saturating_sub(NAMED_VIOLATIONS) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    format!(
        "stalled at points that the check refused: the nearest violates {}{more}",
        named.join(", ")
    )
}

/// The state of a proof, in a line.
fn proof_line(report: &ProofReport) -> String {
    let claim = match report.bound {
        Some(bound) => format!("of the bound {}", rounded(bound, DIGITS)),
        None => "that there is no point".to_owned(),
    };
    let (commands, bytes) = (counted(report.commands, "command"), counted(report.bytes, "byte"));
    match (&report.failure, report.is_complete) {
        (Some(failure), _) => failure.clone(),
        (None, true) => format!("proof {claim}: {commands}, {bytes}"),
        (None, false) => format!("proof {claim}: not complete, {commands}, {bytes}"),
    }
}

/// A line, broken between words into lines of at most so many characters; all but the first are
/// indented.
fn broken(line: &str, width: usize) -> String {
    if line.chars().count() <= width {
        return line.to_owned();
    }
    let (mut text, mut length) = (String::new(), 0);
    for word in line.split(' ') {
        let own = word.chars().count();
        if length > 0 && length + 1 + own > width {
            text += "\n  ";
            length = 2;
        } else if !text.is_empty() {
            text.push(' ');
            length += 1;
        }
        text += word;
        length += own;
    }
    text
}
