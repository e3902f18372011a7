//! The tree search: best bound first, plunging, with every conclusion verified.
//!
//! The files, from the input of a search to its driver. Input and output:
//!
//! * `task`, `found` - the task and its result
//! * `start` - integers to complete, and a point to beat
//! * `saved_tree` - the tree of an earlier solve and the multipliers that closed its ends
//!
//! The tree:
//!
//! * `node` - a node as shared bound changes, and the queue of open nodes
//! * `comparison` - of the strengthened program with the original at accepted points
//! * `best_points` - the incumbent and those after it
//! * `pseudocosts` - the average effect of branching on a column
//! * `tree` - shared by all workers: queue, best points, bounds, limits
//! * `tree_view` - one worker's view of the tree
//! * `reporter` - progress events, `pause` - questions whether the search ends
//! * `shared_tree` - a tree that several processes search together
//!
//! The program:
//!
//! * `indifferent_binaries` - integral values where the relaxed point leaves a choice
//! * `root_point` - the relaxed point of the root, for the rest of these and the first node
//! * `root` - propagation and probing before the first split
//! * `perspective` - tighter costs of columns that binaries switch off
//! * `perspective_cones` - these costs as cones, for large programs
//! * `outer_approximation`, `cone_pool` - cuts of cones, at the root and at nodes
//! * `cone_method` - cuts or conic programs at nodes
//! * `cuts` - rows that cut off the relaxed point of the root
//! * `node_cuts`, `node_cut_pool` - those of nodes
//!
//! The focus node:
//!
//! * `focus_node` - its domain and path; `clock` - the time by activity
//! * `context` - the focus node, its propagator and its methods for relaxations
//! * `local_bounds` - tightening and propagating the domain of the node
//! * `switch_node` - from node to node, `node_probing` - the budget of probing
//! * `node_relaxation` - its relaxation
//! * `unbounded` - an unbounded root
//! * `reduced_cost` - reduced-cost fixing
//! * `settled_binaries` - binaries whose value no other column changes
//! * `leaf_reduction` - its program once all integers are fixed
//! * `leaf` - a point from fixed integers: solve, polish, verify
//!
//! Processing:
//!
//! * `heuristics` - points from relaxed points
//! * `branching` - the column to split, and the child to visit first
//! * `close_node` - nodes that have no children
//! * `tree_warm_start` - the root divided as the tree of an earlier solve was
//! * `children` - the children of a split
//! * `worker` - processing one node: propagate, reduce, relax, bound, branch
//! * `parallel` - several workers
//! * `driver` - one search from start to end
//!
//! No node is pruned by an unverified relaxation, and no incumbent is accepted that the caller's
//! check refuses.

mod best_points;
mod branching;
mod children;
mod clock;
mod close_node;
mod comparison;
mod cone_method;
mod cone_pool;
mod context;
pub(crate) mod cuts;
mod driver;
mod focus_node;
mod found;
mod heuristics;
mod indifferent_binaries;
mod leaf;
mod leaf_reduction;
mod local_bounds;
mod loosened_leaf;
mod node;
mod node_cut_pool;
mod node_cuts;
mod node_probing;
mod node_relaxation;
mod outer_approximation;
mod parallel;
mod pause;
mod perspective;
mod perspective_cones;
mod pseudocosts;
mod reduced_cost;
mod reporter;
mod root;
mod root_point;
mod saved_tree;
mod settled_binaries;
mod shared_tree;
mod start;
mod switch_node;
mod task;
mod trace;
mod tree;
mod tree_view;
mod tree_warm_start;
mod unbounded;
mod worker;

pub(crate) use close_node::opposite;
pub use comparison::Contradiction;
pub(crate) use driver::{complete, first_point, search_with_pauses, wants_first_point};
pub use driver::{search, search_unstrengthened};
pub(crate) use found::ClosedNode;
pub use found::SearchResult;
pub(crate) use outer_approximation::{ConeApproximation, approximate_cones};
pub(crate) use pause::Pauses;
pub use perspective::{Switched, switched_squares, with_slopes};
pub(crate) use perspective::{lifting_slopes, with_perspective};
pub use perspective_cones::squares_as_cones;
pub(crate) use perspective_cones::with_perspective_cones;
pub(crate) use root::Root;
pub(crate) use root_point::{PilotResult, RootCuts};
pub(crate) use saved_tree::{SavedDuals, SavedSplit, SavedTree};
pub(crate) use start::Completion;
pub use start::{Start, StartPoint};
pub use task::{PointJudge, SolveTask};
pub(crate) use tree::granularity;

// For `internals` only.
pub use best_points::{Accepted, BestPoints};
pub use branching::{FixingCredit, growth_rate};
pub use heuristics::{Allowance, Frontier, Kinks};
pub use indifferent_binaries::{groups, round_groups, shift_to_integers, ungrouped_binaries};
pub use node::{Decision, Node, NodeQueue, Path, StepCount};
pub use node_probing::NodeProbing;
pub use pseudocosts::{LEAST_GAIN, Pseudocosts};
