//! A point of a large program under a limit of time, found before anything is relaxed.

use super::stage::{Search, Stage};
use crate::search::{Found, Seed, Task, first_point};
use crate::solution::{Heuristic, Termination};
use crate::solver::{Control, Event, Incumbent, Progress};

/// Entries of the rows of a program whose first relaxation may take longer than a limit allows.
const LARGE: usize = 10_000;

/// The part of the time that is left which a first point may take (no unit).
const SHARE: f64 = 0.25;

/// A point that was found before the search.
pub(super) struct FirstPoint(Found);

impl Stage<'_> {
    /// A point of a large program in case that a time limit comes before the first relaxation is solved.
    pub(super) fn first_point(
        &self,
        search: &Search<'_>,
        seed: Option<&Seed>,
    ) -> Option<FirstPoint> {
        let Search { program, accept, describe, options, token } = *search;
        let left = token.left()?;
        let has_start = seed.is_some_and(|seed| seed.point.is_some() || !seed.guess.is_empty());
        let entries: usize = (0..program.row_count()).map(|row| program.row(row).0.len()).sum();
        let is_large = entries > LARGE && !program.integers.is_empty();
        if !is_large || has_start || !options.heuristics.rounding {
            return None;
        }
        let token = &token.child(Some(left.mul_f64(SHARE)));
        let found = first_point(Task {
            program,
            exact: None,
            root: None,
            accept,
            key: &|_: &[f64]| Vec::new(),
            describe,
            guidance: self.guidance,
            ladders: self.ladders,
            options,
            cutoff: f64::INFINITY,
            token,
        });
        (!found.points.is_empty()).then_some(FirstPoint(found))
    }
}

impl FirstPoint {
    /// Whether no search is needed, because any point will do.
    pub(super) fn suffices(search: &Search<'_>) -> bool {
        let Search { program, options, .. } = search;
        program.is_feasibility_problem() && options.pool == 1 && !options.keep_leaves
    }

    /// Becomes the answer without a search.
    pub(super) fn answer(self, search: &Search<'_>, control: &mut Control<'_>) -> Found {
        report(search, &self.0, control);
        let bound = search.program.offset;
        Found { termination: Termination::Optimal, bound, ..self.0 }
    }

    /// Becomes the answer of a search that has ended at a limit without a point.
    pub(super) fn serve(self, search: &Search<'_>, found: &mut Found, control: &mut Control<'_>) {
        if found.points.is_empty() && found.termination.is_limit() {
            let FirstPoint(own) = self;
            report(search, &own, control);
            (found.points, found.found_by) = (own.points, own.found_by);
            found.statistics.add(&own.statistics);
        }
    }
}

/// Reports a point that was found before the search, once it is the best one.
fn report(search: &Search<'_>, found: &Found, control: &mut Control<'_>) {
    let Some(values) = found.points.first().filter(|_| control.is_watched()) else { return };
    let Search { program, describe, token, .. } = search;
    let Some(point) = describe(values) else { return };
    let value = program.sign * program.objective(&values[..program.column_count()]);
    let unknown = program.sign * f64::NEG_INFINITY;
    let mut figures = Progress::new(0, 0, 0, Some(value), unknown, token.elapsed());
    let found_by = found.found_by.unwrap_or(Heuristic::Rounding);
    (figures.found_by, figures.constant) = (Some(found_by), program.sign * program.constant);
    control.report(&Event::Incumbent(figures));
    // The search is over.
    let _ = control.report_incumbent(&Incumbent::new(&point, value, found_by, figures));
}
