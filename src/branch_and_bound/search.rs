//! The phase of the tree, and the order of the phases around it.

use super::alternation::{alternates, search_in_turns};
use super::cut::{Cut, cut};
use super::solve::Known;
use super::start::Begun;
use super::tighten::Tightened;
use crate::search::{Found, Task, search, search_unstrengthened};
use crate::solver::Control;

/// Solves the program of a task: looks for a point to begin with, and searches.
pub(super) fn search_task(task: Task<'_>, known: &Known<'_>, control: &mut Control<'_>) -> Found {
    let mut begun = Begun::new(task, known.start);
    if let Some(point) = begun.take() {
        match point.answer(task, control) {
            Ok(found) => return found,
            Err(point) => begun = Some(point),
        }
    }
    let start = match &begun {
        Some(begun) => begun.start(known.start),
        None => known.start.cloned(),
    };
    let known = Known { start: start.as_ref(), ..*known };
    let mut found = if alternates(task) {
        search_in_turns(task, &known, control)
    } else {
        search_once(task, &known, control)
    };
    if let Some(begun) = begun {
        begun.add_to(task, &mut found, control);
    }
    found
}

/// Tightens the program of a task, cuts it and searches its tree.
pub(super) fn search_once(task: Task<'_>, known: &Known<'_>, control: &mut Control<'_>) -> Found {
    let Task { program: exact, options, token, .. } = task;
    let tightened = match known.tightened {
        Some(tightened) => tightened.within_bounds(task),
        None => Tightened::new(exact, options, token),
    };
    let Tightened { program, mut root } = tightened;
    let task = Task { program: &program, exact: Some(exact), ..task };
    let cuts = options.cuts && !options.keep_leaves && !known.skips_cuts;
    let cut = if cuts { cut(task, &mut root, known.start) } else { Cut::default() };
    let program = cut.program.as_ref().unwrap_or(task.program);
    let task = Task { program, root: Some(&root), ..task };
    let mut found = search(task, control, cut.start(known.start).as_ref());
    if let Some(what) = found.contradiction {
        debug_assert!(false, "a strengthened program is wrong: {what:?}");
        found = search_unstrengthened(task, found, control);
    }
    cut.add_to(&mut found);
    let value = |x: &Vec<f64>| program.objective(x);
    let best = found.points.first().map_or(f64::INFINITY, value);
    let is_judged = cuts && found.statistics.contradictions == 0;
    found.strengthened = is_judged.then(|| cut.closed(best));
    found
}
