//! The phase before a program is strengthened: a point to begin with.
//!
//! The integers of a start are completed to a point. Without a start, a large program under a limit
//! of time gets a point that needs no relaxation, in case that the limit comes before the search
//! has a better one; so does a program of binaries with few costs or none, whose first point is
//! often the answer.

use std::ops::ControlFlow;

use crate::program::Program;
use crate::search::{
    SearchResult, SolveTask, Start, StartPoint, complete, first_point, wants_first_point,
};
use crate::solution::{Heuristic, Termination};
use crate::solver::{Control, Event, Incumbent, Progress};

/// Least entries of the rows of a program whose first relaxation may take longer than a limit
/// allows.
const LARGE_ENTRIES: usize = 10_000;

/// Largest share of the remaining time that the point of a large program may take (no unit).
const TIME_SHARE: f64 = 0.5;

/// The result of looking for a point before the search.
pub(super) struct PreliminaryResult {
    found: SearchResult,
    /// Whether the search begins with the point; else the point only serves where the search has
    /// none.
    is_start: bool,
    /// Whether the user has been told of the point.
    is_reported: bool,
}

impl PreliminaryResult {
    /// Looks for a point; `None` if there is no reason to.
    pub(super) fn new(task: SolveTask<'_>, start: Option<&Start>) -> Option<PreliminaryResult> {
        match start {
            Some(start) if is_completed(task, start) => Some(PreliminaryResult {
                found: complete(task, start),
                is_start: true,
                is_reported: false,
            }),
            Some(Start { point: Some(_), .. }) => None,
            _ => {
                let found = point_before_relaxing(task)?;
                let begun = PreliminaryResult { found, is_start: false, is_reported: false };
                (!begun.found.points.is_empty()).then_some(begun)
            }
        }
    }

    /// The start of the search: the given one, with the point in place of the integers.
    pub(super) fn start(&self, given: Option<&Start>) -> Option<Start> {
        if !self.is_start {
            return given.cloned();
        }
        let is_reported = self.is_reported;
        let point = start_point(&self.found, Heuristic::Start);
        let point = point.map(|point| StartPoint { is_reported, ..point });
        Some(Start { integers: Vec::new(), point, ..given.cloned().unwrap_or_default() })
    }

    /// Whether no search is needed, because there is a point and no other costs less.
    pub(super) fn suffices(&self, task: SolveTask<'_>) -> bool {
        let SolveTask { program, options, .. } = task;
        let one_is_enough = options.pool == 1 && !options.parts().keep_leaves;
        one_is_enough && self.found.points.first().is_some_and(|x| is_cheapest(program, x))
    }

    /// Reports the point that the search begins with: a controller may take it while the search
    /// looks for a better one. [`ControlFlow::Break`] ends the solve.
    pub(super) fn announce(
        &mut self,
        task: SolveTask<'_>,
        control: &mut Control<'_>,
    ) -> ControlFlow<()> {
        self.is_reported = self.is_start && !self.found.points.is_empty() && control.is_watched();
        match self.is_reported {
            true => report(task, &self.found, control),
            false => ControlFlow::Continue(()),
        }
    }

    /// Becomes the answer of a solve that the user has ended.
    pub(super) fn into_last_point(self) -> SearchResult {
        SearchResult { termination: Termination::Interrupted, ..self.found }
    }

    /// Becomes the answer without a search.
    pub(super) fn into_answer(
        self,
        task: SolveTask<'_>,
        control: &mut Control<'_>,
    ) -> SearchResult {
        if !self.is_reported {
            // The search is over.
            let _ = report(task, &self.found, control);
        }
        let bound =
            self.found.points.first().map_or(f64::NEG_INFINITY, |x| task.program.objective(x));
        SearchResult { termination: Termination::Optimal, bound, ..self.found }
    }

    /// Adds its point, bound and counts to the result of the search that followed.
    pub(super) fn add_to(
        self,
        task: SolveTask<'_>,
        found: &mut SearchResult,
        control: &mut Control<'_>,
    ) {
        let PreliminaryResult { found: begun, is_start, is_reported } = self;
        let mut counts = begun.statistics;
        let value = |found: &SearchResult| found.points.first().map(|x| task.value(x));
        let is_less = |(own, other)| own < other;
        let is_better =
            found.termination.is_limit() && value(&begun).zip(value(found)).is_some_and(is_less);
        let is_first = found.points.is_empty() && found.termination != Termination::Infeasible;
        if is_first || is_better {
            if !is_reported {
                // The search is over.
                let _ = report(task, &begun, control);
            }
            found.points.splice(0..0, begun.points);
            found.points.truncate(task.options.pool);
            found.found_by = begun.found_by;
        } else {
            counts.forget_incumbents();
        }
        found.statistics.add(&counts);
        if found.termination.is_limit() && begun.bound.is_finite() {
            found.bound = found.bound.max(begun.bound);
        }
        if is_start {
            found.completion = begun.completion;
        }
    }
}

/// Whether the integers of a start are completed before the search. A solve of a prepared model
/// that may be stopped looks for a point even where the last solve has left none.
fn is_completed(task: SolveTask<'_>, start: &Start) -> bool {
    !start.integers.is_empty() || (start.saved_tree.is_some() && task.options.may_stop())
}

/// Whether the bounds alone prove that no point costs less: also where there is no objective.
fn is_cheapest(program: &Program, x: &[f64]) -> bool {
    let is_cheap = |(j, &cost): (usize, &f64)| match cost {
        0.0 => true,
        cost => x[j] == if cost > 0.0 { program.lower[j] } else { program.upper[j] },
    };
    program.quadratic.compute_nnz() == 0 && program.linear.iter().enumerate().all(is_cheap)
}

fn point_before_relaxing(task: SolveTask<'_>) -> Option<SearchResult> {
    let (program, options) = (task.program, task.options);
    // Any point is an answer, or one that costs nothing.
    if wants_first_point(program) && options.pool == 1 && options.heuristics.rounding {
        return Some(first_point(task));
    }
    let left = task.token.left()?;
    let entries: usize = (0..program.row_count()).map(|row| program.row(row).0.len()).sum();
    if entries <= LARGE_ENTRIES || program.integers.is_empty() || !options.heuristics.rounding {
        return None;
    }
    let token = &task.token.child(Some(left.mul_f64(TIME_SHARE)));
    Some(first_point(SolveTask { token, ..task }))
}

/// The best point of a search, as the start of another one.
pub(super) fn start_point(found: &SearchResult, otherwise: Heuristic) -> Option<StartPoint> {
    let values = found.points.first()?.clone();
    let found_by = found.found_by.unwrap_or(otherwise);
    Some(StartPoint { values, found_by, is_reported: false })
}

/// Reports a point that was found before the search, once it is the best one.
fn report(task: SolveTask<'_>, found: &SearchResult, control: &mut Control<'_>) -> ControlFlow<()> {
    let none = ControlFlow::Continue(());
    let Some(values) = found.points.first().filter(|_| control.is_watched()) else { return none };
    let program = task.program;
    let Some(point) = task.judge.point(values) else { return none };
    let value = program.sign * program.objective(values);
    let unknown = program.sign * f64::NEG_INFINITY;
    let mut figures = Progress::new(0, 0, 0, Some(value), unknown, task.token.elapsed());
    let found_by = found.found_by.unwrap_or(Heuristic::Rounding);
    (figures.found_by, figures.constant) = (Some(found_by), program.sign * program.constant);
    control.report(&Event::Incumbent(figures));
    control.report_incumbent(&Incumbent::new(&point, value, found_by, figures))
}
