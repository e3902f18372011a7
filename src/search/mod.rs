//! The tree search: best bound first, plunging, with every conclusion verified.
//!
//! * `node` - a node as shared bound changes, and the queue of open nodes
//! * `tree` - what all workers share: queue, best points, bounds, limits
//! * `best_points` - the incumbent and those after it
//! * `desk` - what one worker sees of the tree
//! * `live` - one thread, or several that exchange everything at once
//! * `rounds` - the deterministic search, the same for any number of threads
//! * `clock` - what the time is spent on
//! * `seed`, `guess` - what an earlier solve hands over: boxes, and a point
//! * `root` - what holds before the first split: propagation and probing
//! * `cuts` - rows that cut the relaxed point of the root off
//! * `worker` - processing one node: propagate, reduce, relax, bound, branch
//! * `descend` - from node to node: decisions applied, propagated and probed
//! * `node_relaxation` - what is relaxed at a node, how hard to try, what is believed
//! * `probing` - how much probing nodes get
//! * `leaf` - a point from fixed integers: solve, polish, verify
//! * `branching` - which column to split, and which child to visit first
//! * `pseudocosts` - what branching on a column has done to the bound so far
//! * `exclusion` - values that the relaxed point can do without, on trial
//! * `disjunction` - splitting "one of these" into its sides
//! * `guide` - priorities, splits and points that the user knows
//! * `trial` - children on trial, and what they leave behind
//! * `reduced_cost` - bounds of integers from multipliers
//! * `windows` - splitting "nothing happens in these steps", `order` - which binaries are steps
//! * `symmetry` - interchangeable columns in falling order
//! * `purify` - whole values where the relaxed point leaves a choice
//! * `heuristics` - when which heuristic runs, `allowance` - how much one may spend
//! * `rounding` - the round-and-propagate heuristic
//! * `roll_out` - the inputs of the relaxed point, and what follows from them
//! * `diving` - fixing, propagating and relaxing in turn down to a point
//! * `neighbourhood` - small searches near the best point
//! * `pump` - rounding and projection in turn
//! * `reporter` - progress events
//! * `unbounded` - recession directions
//!
//! Nothing is pruned on an unverified relaxation, and no incumbent is accepted that the caller's
//! check refuses.

mod allowance;
mod best_points;
mod branching;
mod clock;
pub mod cuts;
mod descend;
mod desk;
mod disjunction;
mod diving;
mod exclusion;
mod guess;
mod guide;
mod heuristics;
mod leaf;
mod live;
mod neighbourhood;
mod node;
mod node_relaxation;
mod order;
mod probing;
mod pseudocosts;
mod pump;
mod purify;
mod reduced_cost;
mod reporter;
mod roll_out;
mod root;
mod rounding;
mod rounds;
mod seed;
mod symmetry;
mod trace;
mod tree;
mod trial;
mod unbounded;
mod windows;
mod worker;

use crate::program::Program;
use crate::solution::{Point, Statistics, Termination};
use crate::solver::{BranchingRule, Control, Options, StopToken};
pub use guess::GuessEnd;
pub use guide::Guide;
use node::Path;
use reporter::Watch;
use root::Root;
pub use seed::{Seed, SeedBox, Seeded};
use trace::span;
use tree::Tree;
pub use windows::Windows;

/// A check of a full point against the model it came from; decides whether an incumbent is
/// accepted.
pub type Accept<'a> = dyn Fn(&[f64]) -> bool + Sync + 'a;

/// What a search needs to know.
#[derive(Clone, Copy)]
pub struct Task<'a> {
    /// The program.
    pub program: &'a Program,
    /// The same columns and rows before big-Ms were tightened, for what becomes an answer.
    pub exact: Option<&'a Program>,
    /// The check of incumbents.
    pub accept: &'a Accept<'a>,
    /// The integers that tell two points apart.
    pub key: &'a (dyn Fn(&[f64]) -> Vec<i64> + Sync),
    /// The user's point that a point stands for.
    pub describe: &'a (dyn Fn(&[f64]) -> Option<Point> + Sync),
    /// Windows of events, whose columns `program` has then; made by the search itself.
    pub windows: Option<&'a Windows<'a>>,
    /// What the user knows about the search.
    pub guide: &'a Guide<'a>,
    /// Gaps, tolerances, limits, threads.
    pub options: &'a Options,
    /// Points must be better than this (minimised objective); infinite where any will do.
    pub cutoff: f64,
    /// When the search must stop, and when the solve began.
    pub token: &'a StopToken,
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
    /// The best accepted points, best first.
    pub points: Vec<Vec<f64>>,
    /// Whether these are proved to be the best ones.
    pub pool_complete: bool,
    /// Proved lower bound; `+inf` when infeasible.
    pub bound: f64,
    /// Counts; the time is left to the caller.
    pub statistics: Statistics,
    /// The ends of the tree, where they were wanted.
    pub leaves: Vec<Closed>,
    /// What became of a guess.
    pub guess: Option<GuessEnd>,
    /// What became of the boxes of a seed.
    pub seeded: Option<Seeded>,
}

/// An end of the tree: refuted, cut off, solved, or still open.
#[derive(Debug, Clone)]
pub struct Closed {
    /// Changes of bounds on the way from the root: column, whether it is the upper bound, value.
    pub decisions: Vec<(usize, bool, f64)>,
    /// The bound proved for it.
    pub bound: f64,
}

impl Closed {
    fn new(path: &Path, bound: f64) -> Self {
        let decisions = path.backwards().map(|d| (d.column, d.is_upper, d.value)).collect();
        Closed { decisions, bound }
    }
}

impl Found {
    /// The answer if a limit came before the search.
    pub fn stopped(reason: Termination) -> Self {
        Found {
            termination: reason,
            pool_complete: false,
            bound: f64::NEG_INFINITY,
            ..Found::infeasible()
        }
    }

    /// The answer where infeasibility was proved without a search.
    pub fn infeasible() -> Self {
        Found {
            termination: Termination::Infeasible,
            points: Vec::new(),
            pool_complete: true,
            bound: f64::INFINITY,
            statistics: Statistics::default(),
            leaves: Vec::new(),
            guess: None,
            seeded: None,
        }
    }
}

/// Searches the tree of a program, from a seed where there is one.
pub fn search(task: Task<'_>, control: &mut Control<'_>, seed: Option<&Seed>) -> Found {
    span!(
        INFO,
        "search",
        rows = task.program.row_count(),
        columns = task.program.column_count(),
        integers = task.program.integers.len()
    );
    let rounds = task.options.deterministic;
    let workers = if rounds { rounds::WORKERS } else { task.options.threads };
    // The user's callback may end this search and no other.
    let token = &task.token.child(None);
    let ordered = ordered(task, seed);
    let task = Task { program: ordered.as_ref().unwrap_or(task.program), token, ..task };
    let mut root = Root::new(task.program, token, task.options.probing);
    if let Some(reason) = token.ended().filter(|_| root.conflict.is_none()) {
        return Found::stopped(reason);
    }
    let windows = windows(task, &root);
    let task = Task {
        program: windows.as_ref().map_or(task.program, Windows::program),
        windows: windows.as_ref(),
        ..task
    };
    root.extend(task.program, token);
    let tree = Tree::new(task, seed, workers);
    let mut watch = Watch::new(control);
    if rounds {
        rounds::run(task, &tree, &root, &mut watch);
    } else {
        live::run(task, &tree, &root, &mut watch);
    }
    // What other threads found while the caller's had nothing to do.
    watch.report(&tree);
    tree.into_found()
}

/// The program with its interchangeable columns in falling order, where it has any. Not where points
/// are told apart by their integers, or come from elsewhere: they would have to be sorted.
fn ordered(task: Task<'_>, seed: Option<&Seed>) -> Option<Program> {
    let options = task.options;
    let plain = options.pool <= 1 && !options.keep_leaves && seed.is_none();
    if !options.symmetry || !plain || task.windows.is_some() || task.guide.steers() {
        return None;
    }
    let orderings = symmetry::orderings(task.program);
    let row = |(a, b)| (vec![(a, 1.0), (b, -1.0)], [0.0, f64::INFINITY]);
    let rows: Vec<_> = orderings.into_iter().map(row).collect();
    let mut program = task.program.clone();
    (!rows.is_empty()).then(|| program.append(&[], &rows))??;
    Some(program)
}

/// The windows of events that the options ask for, where the program has any. Kept leaves are about
/// the program's own columns, so there are none then.
fn windows<'a>(task: Task<'a>, root: &Root) -> Option<Windows<'a>> {
    let wanted = match task.options.branching {
        BranchingRule::EventWindows => true,
        BranchingRule::Automatic => task.program.is_feasibility_problem(),
        _ => false,
    };
    if !wanted || task.options.keep_leaves || task.windows.is_some() || root.conflict.is_some() {
        return None;
    }
    Windows::new(task.program, &root.domain, &order::in_time(task.program)?)
}
