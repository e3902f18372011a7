//! The tree of a program whose root may turn out to be weak.
//!
//! Most programs need few nodes, and their roots are strong enough. A search that goes on for long
//! looks for facets in its pauses. If these lift the root above the bound that it has come to, it
//! begins again with them.

use super::cut::CutOutcome;
use super::events::{PartOfSolve, Told};
use crate::program::Program;
use crate::search::cuts::{FacetRounds, LiftedRoot};
use crate::search::{
    Pauses, Root, RootCuts, SearchResult, SolveTask, Start, StartPoint, search, search_with_pauses,
};
use crate::solution::{Heuristic, Termination};
use crate::solver::{Control, Event, Progress};

/// Whether a search of a task may begin again.
pub(super) fn may_begin_again(task: SolveTask<'_>, control: &Control<'_>) -> bool {
    task.options.cuts
        && !task.options.parts().keep_leaves
        && task.options.parts().facet_nodes < u64::MAX
        && task.options.pool == 1
        && !task.judge.finds_rows()
        && !task.program.is_feasibility_problem()
        && !control.has_exchange()
}

/// Searches the tree of a task, and begins again with facets if they are better than its nodes.
///
/// # Arguments
///
/// * `begun`: the program before it was cut.
pub(super) fn search_with_facets(
    task: SolveTask<'_>,
    begun: &Program,
    root: &Root,
    cut: &mut CutOutcome,
    given: Option<&Start>,
    control: &mut Control<'_>,
) -> SearchResult {
    let SolveTask { program, options, token, .. } = task;
    let start = cut.start(given);
    let mut rounds = FacetRounds::new([begun, program], root, options, token);
    let (mut is_lifted, mut told) = (false, Told::nothing(program.sign));
    let mut paused = None;
    let mut ends = |progress: &Progress| {
        let mut cascade = task.cascades.take();
        let bound = program.sign * progress.bound;
        let incumbent = progress.incumbent.map_or(f64::INFINITY, |value| program.sign * value);
        is_lifted = rounds.go_on([bound, incumbent], progress.iterations, &mut cascade);
        task.cascades.give_back(cascade);
        told = Told::up_to(program.sign, progress.incumbent);
        paused = Some(*progress);
        is_lifted
    };
    let pauses = Pauses { nodes: options.parts().facet_nodes, ends: &mut ends };
    let mut before = search_with_pauses(task, control, start.as_ref(), Some(pauses));
    let is_paused = is_lifted && before.termination == Termination::NodeLimit;
    if !is_paused || before.contradiction.is_some() {
        return before;
    }
    // The proof of the new tree does not have the old one's.
    let has_proof = options.proof_path().is_some();
    let bound = if has_proof { f64::NEG_INFINITY } else { before.bound };
    let Some(LiftedRoot { strengthened: lifted, root, counts, kept }) = rounds.strengthened(bound)
    else {
        return search(task, control, start.as_ref());
    };
    if let Some(mut progress) = paused {
        progress.elapsed = token.elapsed();
        control.report(&Event::BegunAgain(counts, progress));
    }
    if has_proof {
        let none = || Box::new(RootCuts::none(begun, &root));
        cut.cuts.get_or_insert_with(none).add(&lifted.cuts);
    }
    let found_by = before.found_by.unwrap_or(Heuristic::Leaf);
    let point = std::mem::take(&mut before.points).into_iter().next();
    let point = point.map(|values| StartPoint { values, found_by, is_reported: false });
    let start = Start { point, is_rounded: Some(true), ..Start::default() };
    let left = |limit: u64| limit.saturating_sub(before.statistics.nodes);
    let options = &match options.node_limit {
        Some(limit) => options.clone().with_node_limit(left(limit)),
        None => options.clone(),
    };
    let own = SolveTask { program: &lifted.program, root: Some(&root), options, ..task };
    let figures = |own: &Progress| {
        let mut progress = *own;
        progress.nodes += before.statistics.nodes;
        progress.relaxations += before.statistics.relaxations;
        progress.iterations += before.statistics.iterations;
        progress.bound = program.sign * (program.sign * own.bound).max(bound);
        progress
    };
    let part = PartOfSolve {
        is_first: false,
        figures: &figures,
        objective: &|value| Some(value),
        told: Some(&told),
        token: &token.child(None),
    };
    let mut found = part.run(control, |control| search(own, control, Some(&start)));
    found.statistics.add(&before.statistics);
    found.statistics.facets.add(&counts);
    found.facets = Some(kept);
    found.completion = before.completion;
    if found.contradiction.is_none() {
        found.bound = found.bound.max(bound);
    }
    found
}
