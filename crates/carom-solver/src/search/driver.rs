//! One search from its start to its end.

use super::context::Context;
use super::found::SearchResult;
use super::heuristics::{complete_start, look_for_first_point, suits_jumps};
use super::node_relaxation::reduce_node;
use super::parallel::{deterministic, opportunistic};
use super::pause::Pauses;
use super::reporter::Reporter;
use super::root::Root;
use super::saved_tree::{End, ProofMultipliers, ProofTrial};
use super::shared_tree;
use super::start::{Start, StartPoint};
use super::task::SolveTask;
use super::trace::span;
use super::tree::Tree;
use super::tree_view::TreeView;
use crate::program::Program;
use crate::solution::Heuristic;
use crate::solver::Control;

/// Searches the tree of a program, from a start if there is one.
pub fn search(
    task: SolveTask<'_>,
    control: &mut Control<'_>,
    start: Option<&Start>,
) -> SearchResult {
    search_with_pauses(task, control, start, None)
}

/// Searches the tree of a program, which ends in a pause if that says so.
pub(crate) fn search_with_pauses<'a>(
    task: SolveTask<'_>,
    control: &'a mut Control<'_>,
    start: Option<&Start>,
    pauses: Option<Pauses<'a>>,
) -> SearchResult {
    span!(
        INFO,
        "search",
        rows = task.program.row_count(),
        columns = task.program.column_count(),
        integers = task.program.integers.len()
    );
    // The user's callback may end this search and no other.
    let token = &task.token.child(None);
    let task = SolveTask { token, ..task };
    let own;
    let root = match task.root {
        Some(root) => root,
        None => {
            own = Root::new(task.program, token, task.options.parts().probing);
            &own
        }
    };
    if let Some(reason) = token.ended().filter(|_| root.conflict.is_none()) {
        // The bound of the root and the point of the start are kept.
        let bounded = root.point.is_none().then(|| root.bounded(&task));
        let tree = Tree::new(task, bounded.as_ref().unwrap_or(root), start, search_nested, 1);
        tree.stop(reason);
        Reporter::new(control).report(&tree);
        return tree.into_found();
    }
    let exchange = control.take_exchange();
    let alone;
    let task = if exchange.is_some() {
        alone = task.options.clone().with_threads(1).with_deterministic(false);
        SolveTask { options: &alone, ..task }
    } else {
        task
    };
    let rounds = task.options.deterministic;
    let workers = if rounds { deterministic::WORKERS } else { task.options.threads };
    let tree = Tree::new(task, root, start, search_nested, workers);
    let mut reporter = Reporter::new(control);
    if start.and_then(|start| start.point.as_ref()).is_some_and(|point| point.is_reported) {
        reporter.skip_incumbent(&tree);
    }
    (reporter.exchange, reporter.pauses) = (exchange, pauses);
    if let Some(exchange) = reporter.exchange.as_deref_mut() {
        reporter.drops_nodes = shared_tree::begin(&tree, exchange);
    }
    if rounds {
        deterministic::run(&tree, &mut reporter);
    } else {
        opportunistic::run(&tree, &mut reporter);
    }
    // Other threads may have found points while the caller's had nothing to do.
    reporter.report(&tree);
    tree.into_found()
}

/// Searches a smaller program inside a search.
fn search_nested(task: SolveTask<'_>) -> SearchResult {
    search(SolveTask { root: None, ..task }, &mut Control::default(), None)
}

/// Searches the program of a task as it was before it was strengthened, once an accepted point has
/// contradicted the strengthened one. Begins with that point, and counts what was done before.
pub fn search_unstrengthened(
    task: SolveTask<'_>,
    before: SearchResult,
    control: &mut Control<'_>,
) -> SearchResult {
    let program = task.exact.unwrap_or(task.program);
    let options = &task.options.clone().with_probing(false).with_cuts(false);
    let task = SolveTask { program, exact: Some(program), root: None, options, ..task };
    let found_by = before.found_by.unwrap_or(Heuristic::Leaf);
    let point = before.points.into_iter().next();
    let point = point.map(|values| StartPoint { values, found_by, is_reported: false });
    let mut found = search(task, control, Some(&Start::from_point(point)));
    found.statistics.add(&before.statistics);
    found
}

/// Completes the integers of a start, and searches no further. Returns the point that a search can
/// begin with, and the bound that the multipliers of an earlier root prove.
pub(crate) fn complete(task: SolveTask<'_>, start: &Start) -> SearchResult {
    let mut bound = f64::NEG_INFINITY;
    let found = at_root(task, Some(start), |ctx| {
        bound = earlier_bound(ctx);
        complete_start(ctx);
    });
    SearchResult { bound: found.bound.max(bound), ..found }
}

/// Whether a point of a program is looked for before its first relaxation, however much time there
/// is.
pub(crate) fn wants_first_point(program: &Program) -> bool {
    suits_jumps(program)
}

/// Looks for a point of a program without solving a relaxation of the whole program.
pub(crate) fn first_point(task: SolveTask<'_>) -> SearchResult {
    at_root(task, None, look_for_first_point)
}

/// Runs a heuristic at the root, and returns its finds. A root that is not known is propagated and
/// not probed.
fn at_root(
    task: SolveTask<'_>,
    start: Option<&Start>,
    look: impl FnOnce(&mut Context<'_>),
) -> SearchResult {
    let own;
    let root = match task.root {
        Some(root) => root,
        None => {
            own = Root::new(task.program, task.token, false);
            &own
        }
    };
    if root.conflict.is_some() {
        return SearchResult::infeasible();
    }
    let tree = Tree::new(task, root, start, search_nested, 1);
    let mut ctx = Context::new(TreeView::immediate(&tree, 0));
    look(&mut ctx);
    tree.take_in(&mut tree.lock(), ctx.tree.take_report());
    ctx.retire();
    tree.into_found()
}

/// The bound on this root that the multipliers of an earlier root prove; `-inf` if they prove none.
fn earlier_bound(ctx: &mut Context<'_>) -> f64 {
    let saved = ctx.tree.saved_tree().and_then(|tree| tree.of(End::Node(0)).cloned());
    let Some((saved, root)) = saved.zip(reduce_node(ctx)) else { return f64::NEG_INFINITY };
    let memory = &mut ProofMultipliers::default();
    let tried = saved.prove(&root, f64::INFINITY, ctx.cascade.prover(), memory);
    ctx.cascade.reducer().reuse(root);
    match tried {
        ProofTrial::Bound(bound) => bound,
        _ => f64::NEG_INFINITY,
    }
}
