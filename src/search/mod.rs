//! The tree search: best bound first, plunging, with every conclusion verified.
//!
//! * `node` - a node as a list of decisions, and the queue of open nodes
//! * `tree` - what all workers share: queue, incumbent, bounds, limits
//! * `root` - what holds before the first split: propagation and probing
//! * `worker` - processing one node: propagate, reduce, relax, bound, branch
//! * `descend` - from node to node: decisions applied, propagated and probed
//! * `node_relaxation` - what is relaxed at a node, how hard to try, what is believed
//! * `probing` - how much probing nodes get
//! * `leaf` - a point from fixed integers: solve, polish, verify
//! * `branching` - which column to split, and which child to visit first
//! * `disjunction` - splitting "one of these" into its sides
//! * `purify` - whole values where the relaxed point leaves a choice
//! * `rounding` - the round-and-propagate heuristic
//! * `reporter` - progress events
//! * `unbounded` - recession directions
//!
//! Nothing is pruned on an unverified relaxation, and no incumbent is accepted that the caller's
//! check refuses.

mod branching;
mod descend;
mod disjunction;
mod leaf;
mod node;
mod node_relaxation;
mod probing;
mod purify;
mod reporter;
mod root;
mod rounding;
mod tree;
mod unbounded;
mod worker;

use web_time::Instant;

use crate::program::Program;
use crate::solution::{Statistics, Termination};
use crate::solver::{Control, Options};
use reporter::Reporter;
use root::Root;
use tree::Tree;
use worker::Worker;

/// A check of a full point against the model it came from; decides whether an incumbent is
/// accepted.
pub type Accept<'a> = dyn Fn(&[f64]) -> bool + Sync + 'a;

/// What a search needs to know.
#[derive(Clone, Copy)]
pub struct Task<'a> {
    /// The program.
    pub program: &'a Program,
    /// The check of incumbents.
    pub accept: &'a Accept<'a>,
    /// Gaps, tolerances, limits, threads.
    pub options: &'a Options,
    /// When the solve began.
    pub start: Instant,
}

impl std::fmt::Debug for Task<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Task").field("options", self.options).finish_non_exhaustive()
    }
}

/// What a search found. Objective values are those of the minimised program.
#[derive(Debug, Clone)]
pub struct Found {
    /// Why it stopped.
    pub termination: Termination,
    /// The best accepted point.
    pub incumbent: Option<Vec<f64>>,
    /// Proved lower bound; `+inf` when infeasible.
    pub bound: f64,
    /// Counts; the time is left to the caller.
    pub statistics: Statistics,
}

/// Searches the tree of a program.
pub fn search(task: Task<'_>, control: &mut Control<'_>) -> Found {
    let tree = Tree::new(task, control.interrupt().clone());
    let root = Root::new(task.program, &tree);
    let mut reporter = Reporter::new();
    run(task, &tree, &root, (&mut reporter, control));
    // What other threads found while the caller's had nothing to do.
    reporter.report(&tree, control);
    tree.into_found()
}

#[cfg(not(target_family = "wasm"))]
fn run(task: Task<'_>, tree: &Tree<'_>, root: &Root, watch: (&mut Reporter, &mut Control<'_>)) {
    std::thread::scope(|scope| {
        for id in 1..task.options.threads {
            scope.spawn(move || Worker::new(task, tree, root, id).run(None));
        }
        Worker::new(task, tree, root, 0).run(Some(watch));
    });
}

#[cfg(target_family = "wasm")]
fn run(task: Task<'_>, tree: &Tree<'_>, root: &Root, watch: (&mut Reporter, &mut Control<'_>)) {
    Worker::new(task, tree, root, 0).run(Some(watch));
}
