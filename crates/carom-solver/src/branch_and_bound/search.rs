//! The phase of the tree, and the order of the phases around it.

use super::alternation::{alternates, search_in_turns};
use super::cut::{CutOutcome, cut};
use super::facets::{may_begin_again, search_with_facets};
use super::solve::EarlierResults;
use super::start::PreliminaryResult;
use super::tighten::Tightened;
use crate::mutations;
use crate::search::{
    ConeApproximation, SearchResult, SolveTask, approximate_cones, search, search_unstrengthened,
};
use crate::solver::Control;
use std::borrow::Cow;

/// Solves the program of a task: looks for a point to begin with, and searches.
pub(super) fn search_task(
    task: SolveTask<'_>,
    known: &EarlierResults<'_>,
    control: &mut Control<'_>,
) -> SearchResult {
    let tight = known.tightened.map(|Tightened { program, root }| SolveTask {
        program,
        exact: Some(task.program),
        root: Some(root),
        ..task
    });
    let mut begun = PreliminaryResult::new(tight.unwrap_or(task), known.start);
    if let Some(begun) = begun.take_if(|begun| begun.suffices(task)) {
        return begun.into_answer(task, control);
    }
    if let Some(begun) = begun.take_if(|begun| begun.announce(task, control).is_break()) {
        return begun.into_last_point();
    }
    let start = match &begun {
        Some(begun) => begun.start(known.start),
        None => known.start.cloned(),
    };
    let known = EarlierResults { start: start.as_ref(), ..*known };
    let mut found = if alternates(task) && !control.has_exchange() {
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
pub(super) fn search_once(
    task: SolveTask<'_>,
    known: &EarlierResults<'_>,
    control: &mut Control<'_>,
) -> SearchResult {
    let SolveTask { program: exact, options, token, .. } = task;
    let tightened = match known.tightened {
        Some(Tightened { program, root }) => {
            Tightened { program: Cow::Borrowed(&**program), root: root.clone() }
        }
        None => Tightened::new(exact, options, token),
    };
    let Tightened { program, mut root } = tightened;
    let (mut program, mut cone_cuts) = (program, Vec::new());
    // An interrupt may come before the search has relaxed the root itself.
    let mut bound_before = f64::NEG_INFINITY;
    if !program.cones.is_empty() {
        let mut cascade = task.cascades.take();
        let ConeApproximation { program: cut_off, bound } =
            approximate_cones(&program, &root, options, token, &mut cascade, known.cone_cuts);
        task.cascades.give_back(cascade);
        bound_before = bound;
        if let Some((cut_off, cuts)) = cut_off {
            cone_cuts = cuts;
            root.carry_over(&cut_off, token);
            program = Cow::Owned(cut_off);
        }
    }
    let task = SolveTask { program: &program, exact: Some(exact), ..task };
    let cuts = options.cuts && !options.parts().keep_leaves && !known.skips_cuts;
    let mut cut =
        if cuts { cut(task, &mut root, known.start, control) } else { CutOutcome::default() };
    let cut_program = cut.program.take();
    let program = cut_program.as_ref().unwrap_or(task.program);
    let begun = task.program;
    let task = SolveTask { program, ..task };
    let may_begin_again = may_begin_again(task, control);
    let kept = known.facets.filter(|_| may_begin_again);
    let lifted = kept.and_then(|kept| {
        let mut cascade = task.cascades.take();
        let lifted = kept.strengthen([begun, program], &mut root, options, token, &mut cascade);
        task.cascades.give_back(cascade);
        lifted
    });
    let program = lifted.as_ref().map_or(program, |(lifted, _)| &lifted.program);
    let task = SolveTask { program, root: Some(&root), ..task };
    let mut found = if may_begin_again {
        search_with_facets(task, begun, &root, &mut cut, known.start, control)
    } else {
        search(task, control, cut.start(known.start).as_ref())
    };
    if let Some((kept, (_, counts))) = kept.zip(lifted.as_ref()) {
        found.statistics.facets = counts.with(&found.statistics.facets);
        found.facets = found.facets.map(|new| kept.with(new));
    }
    if let Some(what) = found.contradiction {
        debug_assert!(mutations::has_any(), "a strengthened program is wrong: {what:?}");
        found = search_unstrengthened(task, found, control);
    }
    cut.add_to(&mut found);
    if found.termination.is_limit() && found.statistics.contradictions == 0 {
        found.bound = found.bound.max(bound_before);
    }
    found.cone_cuts = cone_cuts;
    found.root_cuts = cut.cuts.take();
    let value = |x: &Vec<f64>| program.objective(x);
    let best = found.points.first().map_or(f64::INFINITY, value);
    let is_judged = cuts && found.statistics.contradictions == 0;
    found.strengthened = is_judged.then(|| cut.closed(best));
    found
}
