//! Programs without an objective: two ways of searching in turns.
//!
//! Without an objective, a relaxation only tells whether a node is empty. A tree that splits the
//! latest step first decides many programs of horizons in a few nodes. For other programs an
//! artificial objective helps, although any point is an answer: splits are chosen by the gains of
//! relaxed values, and cuts are looked for. Nobody knows beforehand which of the two is faster, so
//! they take turns with growing limits. All turns together take a small multiple of the nodes of
//! the faster way alone.

use super::events::PartOfSolve;
use super::search::search_once;
use super::solve::EarlierResults;
use crate::program::Program;
use crate::search::{SearchResult, SolveTask};
use crate::solution::{Statistics, Termination};
use crate::solver::{BranchingRule, Control, Progress};

/// Nodes of the first turn.
const FIRST_LIMIT: u64 = 100;

/// Growth of the limit from turn to turn (no unit).
const LIMIT_GROWTH: u64 = 4;

/// Whether the program of a task is searched in turns.
pub(super) fn alternates(task: SolveTask<'_>) -> bool {
    let SolveTask { program, options, .. } = task;
    program.is_feasibility_problem()
        && options.branching == BranchingRule::Automatic
        && options.pool == 1
        && !options.parts().keep_leaves
        && !task.judge.finds_rows()
        && program.integers.iter().any(|&j| is_binary(program, j))
}

/// Searches a program without an objective in turns, with and without an artificial objective.
pub(super) fn search_in_turns(
    task: SolveTask<'_>,
    known: &EarlierResults<'_>,
    control: &mut Control<'_>,
) -> SearchResult {
    let with_objective = &with_objective(task.program);
    let mut before = Statistics::default();
    let mut limit = FIRST_LIMIT;
    for turn in 0_u64.. {
        let left = task.options.node_limit.map(|all| all.saturating_sub(before.nodes));
        let is_last = left.is_some_and(|left| left <= limit);
        let node_limit = left.map_or(limit, |left| left.min(limit));
        let options = task.options.clone().with_node_limit(node_limit);
        let mut found = if turn % 2 == 0 {
            let start = known.start.filter(|_| turn == 0);
            let known = EarlierResults { start, ..*known };
            let task = SolveTask { options: &options, ..task };
            run_turn(task, &before, control, |control| search_once(task, &known, control))
        } else {
            // The first point ends it.
            let options = options.with_absolute_gap(f64::INFINITY);
            let known = EarlierResults { start: None, tightened: None, ..*known };
            let own = SolveTask { program: with_objective, options: &options, ..task };
            let found =
                run_turn(task, &before, control, |control| search_once(own, &known, control));
            without_objective(found, task)
        };
        found.statistics.add(&before);
        let is_over = match found.termination {
            Termination::NodeLimit => is_last,
            Termination::Stalled => turn % 2 == 0,
            _ => true,
        };
        if is_over || !found.points.is_empty() {
            return found;
        }
        before = found.statistics;
        limit = limit.saturating_mul(LIMIT_GROWTH);
    }
    SearchResult::stopped(Termination::NodeLimit)
}

/// Runs a turn. Its events include the counts of earlier turns, and show no objective.
fn run_turn(
    task: SolveTask<'_>,
    before: &Statistics,
    control: &mut Control<'_>,
    search: impl FnOnce(&mut Control<'_>) -> SearchResult,
) -> SearchResult {
    let value = task.program.sign * task.program.offset;
    let figures = |own: &Progress| {
        let mut progress = *own;
        progress.nodes = own.nodes + before.nodes;
        progress.relaxations = own.relaxations + before.relaxations;
        progress.iterations = own.iterations + before.iterations;
        // The turns search the tree again and again.
        progress.explored = None;
        progress.incumbent = own.incumbent.map(|_| value);
        progress.bound = if own.bound.is_finite() { value } else { own.bound };
        progress
    };
    let turn = PartOfSolve {
        is_first: before.nodes == 0,
        figures: &figures,
        objective: &|_| Some(value),
        told: None,
        token: &task.token.child(None),
    };
    turn.run(control, search)
}

/// The result of a search with the artificial objective, as an answer without an objective: no
/// point is better than another.
fn without_objective(found: SearchResult, task: SolveTask<'_>) -> SearchResult {
    let bound = if found.bound == f64::INFINITY { found.bound } else { task.program.offset };
    // The splits guide a proof that there is no point, whatever the objective was.
    let splits = if task.options.proof_path().is_some() { found.splits } else { Vec::new() };
    SearchResult { bound, duals: Vec::new(), splits, strengthened: None, ..found }
}

/// The program with the artificial objective, the number of binaries that are 1: conditions that do
/// not hold and events that do not happen restrict nothing.
fn with_objective(program: &Program) -> Program {
    let mut own = program.clone();
    for &j in program.integers.iter().filter(|&&j| is_binary(program, j)) {
        own.linear[j] = 1.0;
    }
    own
}

fn is_binary(program: &Program, j: usize) -> bool {
    program.lower[j] == 0.0 && program.upper[j] == 1.0
}
