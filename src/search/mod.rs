//! The tree search: best bound first, plunging, with every conclusion verified.
//!
//! A file sees only those above it in this list, so that each can be read without those below.
//!
//! What is asked and found:
//!
//! * `task`, `found` - the question and the answer
//! * `seed` - what an earlier solve hands over: boxes, and a point
//! * `column_guidance` - priorities, splits and points that the user knows
//!
//! The tree:
//!
//! * `node` - a node as shared bound changes, and the queue of open nodes
//! * `best_points` - the incumbent and those after it
//! * `pseudocosts` - what branching on a column has done to the bound so far
//! * `tree` - what all workers share: queue, best points, bounds, limits
//! * `tree_view` - what one worker sees of the tree, with a `local_queue` of nodes that others may
//!   steal, or a `round_buffer`
//! * `reporter` - progress events
//!
//! The program:
//!
//! * `cuts` - rows that cut the relaxed point of the root off
//! * `symmetry` - interchangeable columns in falling order
//! * `event_windows` - splitting "nothing happens in these steps", `time_order` - which binaries are
//!   steps
//! * `indifferent_binaries` - whole values where the relaxed point leaves a choice
//! * `root` - what holds before the first split: propagation and probing
//!
//! The node in hand:
//!
//! * `focus_node` - its domain, and the way that led to it; `clock` - what the time is spent on
//! * `context` - the node in hand with what propagates and relaxes it
//! * `local_bounds` - tightening and propagating the domain of the node
//! * `switch_node` - from node to node, `node_probing` - how much probing nodes get
//! * `node_relaxation` - what is relaxed, and what for
//! * `unbounded` - a root whose objective falls without limit
//! * `reduced_cost` - bounds of integers from multipliers
//! * `leaf` - a point from fixed integers: solve, polish, verify
//!
//! What is done with it:
//!
//! * `heuristics` - points from relaxed points
//! * `branching` - which column to split, and which child to visit first
//! * `children`, `close_node` - the children of a split, and nodes that have none
//! * `worker` - processing one node: propagate, reduce, relax, bound, branch
//! * `parallel` - workers side by side
//! * `driver` - one search from start to end
//!
//! Nothing is pruned on an unverified relaxation, and no incumbent is accepted that the caller's
//! check refuses.

mod best_points;
mod branching;
mod children;
mod clock;
mod close_node;
mod column_guidance;
mod context;
pub(crate) mod cuts;
mod driver;
mod event_windows;
mod focus_node;
mod found;
mod heuristics;
mod indifferent_binaries;
mod leaf;
mod local_bounds;
mod local_queue;
mod node;
mod node_probing;
mod node_relaxation;
mod parallel;
mod pseudocosts;
mod reduced_cost;
mod reporter;
mod root;
mod round_buffer;
mod seed;
mod switch_node;
mod symmetry;
mod task;
mod time_order;
mod trace;
mod tree;
mod tree_view;
mod unbounded;
mod worker;

pub use column_guidance::ColumnGuidance;
pub use driver::search;
pub(crate) use found::ClosedNode;
pub use found::Found;
pub(crate) use seed::{GuessEnd, Seed, SeedBox};
pub use task::{Accept, Task};
