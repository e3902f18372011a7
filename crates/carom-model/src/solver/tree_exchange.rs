//! Trees that several processes search together: what a search offers between two nodes to whoever
//! carries nodes and points from process to process.
//!
//! All processes solve the same model with the same options, so each of them comes to the same
//! presolved program by itself. Nodes and points are exchanged in its columns.

use crate::solution::{Statistics, Termination};

/// An open node of a tree, over the columns of the presolved program.
#[doc(hidden)]
#[derive(Debug, Clone, PartialEq)]
pub struct OpenNode {
    /// The proved bound of its subtree, in the unit of the (minimised) objective.
    pub bound: f64,
    /// The decisions from the root: a column, whether its upper bound changes, and the new bound.
    pub decisions: Vec<(u32, bool, f64)>,
}

/// The state of one process's part of a tree. Values are those of the minimised objective.
#[doc(hidden)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PartState {
    /// Open nodes, with the one that comes next.
    pub open: usize,
    /// The smallest bound of an open node; infinite if there is none.
    pub floor: f64,
    /// The smallest bound of a part that was closed without being infeasible; infinite if there is
    /// none.
    pub closed: f64,
    /// The smallest bound of a part that could be neither finished nor split; infinite if there is
    /// none.
    pub stalled: f64,
    /// Nodes processed.
    pub nodes: u64,
    /// The value from which on a node cannot improve the best point.
    pub cutoff: f64,
    /// Whether points make presolve or cuts doubtful, so that the whole answer is.
    pub is_doubtful: bool,
    /// Why the search of this part is over, if it is.
    pub ended: Option<Termination>,
}

/// The part of a tree that other processes hold.
#[doc(hidden)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elsewhere {
    /// The smallest bound of an open node; infinite if there is none.
    pub floor: f64,
    /// Open nodes.
    pub open: usize,
    /// Nodes processed.
    pub nodes: u64,
}

impl Default for Elsewhere {
    fn default() -> Self {
        Elsewhere { floor: f64::INFINITY, open: 0, nodes: 0 }
    }
}

/// One process's part of a tree, between two nodes.
#[doc(hidden)]
pub trait TreePart {
    /// Its state.
    fn state(&self) -> PartState;

    /// The open nodes, with the one that comes next.
    fn open_nodes(&self) -> Vec<OpenNode>;

    /// Takes so many of the open nodes out, every second one from the best bound on, so that what
    /// stays is as good.
    fn take(&mut self, count: usize) -> Vec<OpenNode>;

    /// Takes all open nodes out, with the one that comes next.
    fn take_all(&mut self) -> Vec<OpenNode>;

    /// Adds open nodes. Nodes that do not fit the program are refused: `false`, and none is added.
    fn put(&mut self, nodes: Vec<OpenNode>) -> bool;

    /// The best point, and its value.
    fn incumbent(&self) -> Option<(f64, Vec<f64>)>;

    /// Offers a point, which the model itself checks; whether it is the best one now.
    fn offer(&mut self, point: Vec<f64>) -> bool;

    /// Notes what other processes hold, for the bound and the events.
    fn note_elsewhere(&mut self, elsewhere: Elsewhere);

    /// Takes in the bounds of what was closed elsewhere without being infeasible, and of what could
    /// be neither finished nor split.
    fn note_closed(&mut self, closed: f64, stalled: f64);

    /// Notes that points elsewhere make presolve or cuts doubtful, which ends the search.
    fn note_doubt(&mut self);

    /// The counts so far.
    fn statistics(&self) -> Statistics;

    /// Adds the counts of other processes.
    fn add_statistics(&mut self, counts: &Statistics);

    /// Ends the search.
    fn stop(&mut self, reason: Termination);
}

/// Carries nodes and points between the parts of a tree.
#[doc(hidden)]
pub trait TreeExchange {
    /// A search begins; whether the nodes below the root are this process's. All processes search
    /// the root, and the others forget its children.
    ///
    /// # Arguments
    ///
    /// * `program`: a number that is the same only for the same presolved program.
    /// * `is_last`: whether no other tree follows, as one does where a program has independent
    ///   blocks. All processes begin the same trees in the same order.
    fn begin(&mut self, program: u64, is_last: bool) -> bool;

    /// Is called after every node, and when there is none: then again and again until it returns
    /// `false`, which ends the search of this process. The last call comes after the search was
    /// stopped.
    fn meet(&mut self, part: &mut dyn TreePart, is_idle: bool) -> bool;
}
