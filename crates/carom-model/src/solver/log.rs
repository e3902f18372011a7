//! A log for people, in columns.

use std::fmt;
use std::io::{self, Write};

use web_time::{Duration, Instant};

use super::progress::{Event, Progress};
use crate::number::{percent, rounded};
use crate::solution::{Heuristic, RelaxationCounts, Solution, Verification};

/// Lines between two headings.
const LINES_PER_HEADING: u64 = 25;

/// Violations that are named.
const NAMED_VIOLATIONS: usize = 3;

/// Shortest time between two lines that report nothing new, at first. Later it is a part of the
/// time that has passed, so that a long search does not fill the screen.
const REPORT_INTERVAL: Duration = Duration::from_secs(1);
const REPORT_SHARE: u32 = 10;
const LONGEST_INTERVAL: Duration = Duration::from_secs(60);

/// A progress callback that writes what presolve has left, the bound of the root before and after
/// cuts, and then a line for the root, for every new best point, and about once a second at first,
/// later less often.
///
/// The columns are: nodes processed, nodes open, largest depth, best objective, bound, relative gap
/// in percent, and seconds. A line for a new best point begins with the mark of its heuristic, see
/// [`Heuristic::mark`](crate::solution::Heuristic::mark); the marks are explained above the first
/// line.
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
    lines: u64,
    /// The bound of the root before cuts, until the root is done.
    relaxed: Option<f64>,
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
    /// A log that writes to `writer`.
    pub fn new(writer: W) -> Self {
        Log { writer, lines: 0, relaxed: None, last: None, failed: None, searched: None }
    }

    /// Writes the line of an event. After an error of the writer nothing more is written, and
    /// [`into_inner`](Self::into_inner) returns the error.
    pub fn record(&mut self, event: &Event) {
        let progress = event.progress();
        let seconds = progress.elapsed.as_secs_f64();
        let mark = match event {
            Event::Presolved(size, _) => {
                return self.write(format_args!("presolve left {size} ({seconds:.2} s)\n"));
            }
            Event::Relaxed(_) => {
                self.relaxed = Some(progress.bound);
                let bound = number(progress.bound);
                return self.write(format_args!("bound of the root {bound} ({seconds:.2} s)\n"));
            }
            Event::Root(_) => {
                if self.relaxed.take().is_some_and(|first| first != progress.bound) {
                    let bound = number(progress.bound);
                    self.write(format_args!("bound after cuts {bound} ({seconds:.2} s)\n"));
                }
                ' '
            }
            Event::Incumbent(_) => progress.found_by.map_or('*', |heuristic| heuristic.mark()),
            // What is earlier than the last line is of another solve.
            Event::Progress(_)
                if self.last.is_some_and(|last| {
                    (last..last + interval(last)).contains(&progress.elapsed)
                }) =>
            {
                return;
            }
            Event::Progress(_) => ' ',
        };
        self.last = Some(progress.elapsed);
        if self.lines == 0 {
            let marks = Heuristic::ALL.map(|source| format!("{} {source}", source.mark()));
            self.write(format_args!(
                "new best points are marked by their source: {}\n",
                marks.join(", ")
            ));
        }
        if self.lines.is_multiple_of(LINES_PER_HEADING) {
            self.write(format_args!(
                "  {:>9} {:>8} {:>6} {:>16} {:>16} {:>9} {:>9}\n",
                "nodes", "open", "depth", "incumbent", "bound", "gap %", "seconds"
            ));
        }
        self.lines += 1;
        let Progress { nodes, open, depth, bound, .. } = *progress;
        let incumbent = progress.incumbent.map_or("-".to_owned(), number);
        let gap = percent(progress.relative_gap());
        let bound = number(bound);
        self.write(format_args!(
            "{mark} {nodes:>9} {open:>8} {depth:>6} {incumbent:>16} {bound:>16} {gap:>9} \
             {seconds:>9.2}\n"
        ));
    }

    /// Writes a summary: the outcome, the times by activity and the points by heuristic.
    pub fn finish(&mut self, solution: &Solution) {
        let statistics = solution.statistics();
        let objective = solution.objective().map_or("-".to_owned(), number);
        self.write(format_args!(
            "{}: objective {objective}, bound {}, {} nodes in {:.2} s ({:.0} a second)\n",
            solution.termination(),
            number(solution.bound()),
            statistics.nodes,
            statistics.time.as_secs_f64(),
            statistics.nodes_per_second(),
        ));
        for note in solution.notes() {
            self.write(format_args!("{note}\n"));
        }
        if let Some(check) = solution.refused() {
            self.write(format_args!("{}\n", refusal(check)));
        }
        self.write(format_args!(
            "{} relaxations, {} iterations, depth {}, at most {} open, {} bytes\n",
            statistics.relaxations,
            statistics.iterations,
            statistics.depth,
            statistics.max_open,
            statistics.tree_bytes,
        ));
        let RelaxationCounts { dual_simplex, active_set, interior_point, clarabel, given_up } =
            statistics.relaxation_counts;
        self.write(format_args!(
            "relaxations: dual simplex {dual_simplex}, active set {active_set}, interior point \
             {interior_point}, Clarabel {clarabel}; the first method gave up {given_up} times\n"
        ));
        if statistics.blocks > 0 {
            self.write(format_args!("{} blocks, one after the other\n", statistics.blocks));
        }
        self.write(format_args!(
            "ended: propagation {}, relaxation {}, bound {}, leaf {}; split {}, unfinished {}\n",
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
        self.write(format_args!("time: {}\n", shares.join(", ")));
        for (heuristic, count) in statistics.heuristics.iter().filter(|(_, c)| c.calls > 0) {
            self.write(format_args!(
                "{} {heuristic}: {} calls, {} points, {} of them the best so far\n",
                heuristic.mark(),
                count.calls,
                count.points,
                count.incumbents
            ));
        }
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
        self.write(format_args!("{text} ({seconds:.2} s)\n"));
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
        if is_first {
            self.write(format_args!(
                "  {:>7} {:>9} {:>9} {:>9} {:>8} {:>16} {:>9}\n",
                "steps", "refuted", "a plan of", "nodes", "open", "bound", "seconds"
            ));
        }
        let feasible = feasible.map_or("-".to_owned(), |steps| steps.to_string());
        let (nodes, open, bound) = (progress.nodes, progress.open, number(progress.bound));
        let seconds = elapsed.as_secs_f64();
        self.write(format_args!(
            "  {steps:>7} {refuted:>9} {feasible:>9} {nodes:>9} {open:>8} {bound:>16} {seconds:>9.2}\n"
        ));
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

/// Ten significant digits, or eight where that is too long for a column.
fn number(value: f64) -> String {
    let plain = rounded(value, 10);
    if plain.len() <= 16 { plain } else { format!("{value:.7e}") }
}
