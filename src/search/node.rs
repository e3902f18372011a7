//! Nodes and the queue of open ones.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// One bound change by branching.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Decision {
    pub(super) column: usize,
    pub(super) is_upper: bool,
    pub(super) value: f64,
}

/// An open node: the decisions from the root, and a proved bound on its subtree.
#[derive(Debug, Clone)]
pub(super) struct Node {
    pub(super) path: Vec<Decision>,
    pub(super) bound: f64,
    /// How far the last decision moved its column from the parent's relaxed value.
    pub(super) fraction: f64,
    /// Order of creation, the last tie-breaker: makes the search deterministic.
    pub(super) serial: u64,
}

impl PartialEq for Node {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Node {}

impl PartialOrd for Node {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Node {
    /// The greatest node is the one to take next: smallest bound, then deepest, then youngest.
    fn cmp(&self, other: &Self) -> Ordering {
        other
            .bound
            .total_cmp(&self.bound)
            .then(self.path.len().cmp(&other.path.len()))
            .then(self.serial.cmp(&other.serial))
    }
}

/// Open nodes, best bound first.
#[derive(Debug, Default)]
pub(super) struct NodeQueue {
    heap: BinaryHeap<Node>,
}

impl NodeQueue {
    pub(super) fn push(&mut self, node: Node) {
        self.heap.push(node);
    }

    pub(super) fn pop(&mut self) -> Option<Node> {
        self.heap.pop()
    }

    pub(super) fn len(&self) -> usize {
        self.heap.len()
    }

    /// The smallest bound of an open node; `+inf` when there is none.
    pub(super) fn best_bound(&self) -> f64 {
        self.heap.peek().map_or(f64::INFINITY, |node| node.bound)
    }
}
