//! The phase of the tree, and the phases around it for the program of a task.

use super::alternation::{alternates, search_in_turns};
use super::cut::{Cut, cut};
use super::solve::Known;
use super::start::{Begun, go_on_from, start_point};
use super::tighten::Tightened;
use crate::search::{Found, Start, Task, search, search_unstrengthened};
use crate::solution::{Heuristic, Termination};
use crate::solver::{BranchingRule, Control, Options};

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
    // Callbacks would see two searches.
    let may_search_twice = task.options.node_limit.is_none() && !control.is_watched();
    let mut found = if known.expects_no_tree && may_search_twice {
        search_root_first(task, &known, control)
    } else {
        search_by_any_way(task, &known, control)
    };
    if let Some(begun) = begun {
        begun.add_to(task, &mut found, control);
    }
    found
}

/// Searches once, or in turns where it is not known which way is faster.
fn search_by_any_way(task: Task<'_>, known: &Known<'_>, control: &mut Control<'_>) -> Found {
    if alternates(task) {
        search_in_turns(task, known, control)
    } else {
        search_once(task, known, control)
    }
}

/// Searches no further than the root, and tightens the program for the values of the parameters if that
/// is not enough: if a tree is unexpected, tightening is likely to save it.
fn search_root_first(task: Task<'_>, known: &Known<'_>, control: &mut Control<'_>) -> Found {
    let (node_limit, branching) = (Some(1), BranchingRule::LatestFirst);
    let options = &Options { node_limit, branching, ..task.options.clone() };
    let at_root = Known { skips_cuts: true, ..*known };
    let mut root = search_once(Task { options, ..task }, &at_root, control);
    if !matches!(root.termination, Termination::NodeLimit | Termination::Stalled) {
        return root;
    }
    let given = known.start.cloned().unwrap_or_default();
    let point = start_point(&root, Heuristic::Rounding).or(given.point);
    let start = &Start { point, ..given };
    let known = Known { start: Some(start), tightened: None, ..*known };
    let mut found = search_by_any_way(task, &known, control);
    // It has the same root.
    root.statistics.nodes -= root.statistics.nodes.min(1);
    go_on_from(root, &mut found);
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
    // Columns of event windows come after the program's.
    let value = |x: &Vec<f64>| program.objective(&x[..program.column_count()]);
    let best = found.points.first().map_or(f64::INFINITY, value);
    let is_judged = cuts && found.statistics.contradictions == 0;
    found.strengthened = is_judged.then(|| cut.closed(best));
    found
}
