//! The nodes of a worker's current plunge, which others may steal.

use std::cell::Cell;

use crossbeam_deque::Worker as Deque;

use super::node::Node;

/// A worker's own open nodes: it takes the youngest, thieves take the oldest.
pub(super) struct LocalQueue {
    nodes: Deque<Node>,
    /// A lower bound on all of `nodes`.
    base: Cell<f64>,
}

impl Default for LocalQueue {
    fn default() -> Self {
        LocalQueue::new(Deque::new_lifo())
    }
}

impl LocalQueue {
    pub(super) fn new(nodes: Deque<Node>) -> Self {
        LocalQueue { nodes, base: Cell::new(f64::INFINITY) }
    }

    pub(super) fn push(&self, node: Node) {
        let base = if self.nodes.is_empty() { f64::INFINITY } else { self.base.get() };
        self.base.set(base.min(node.bound));
        self.nodes.push(node);
    }

    /// The youngest node.
    pub(super) fn pop(&self) -> Option<Node> {
        self.nodes.pop()
    }

    /// The smaller of a bound and those of all nodes here.
    pub(super) fn floor(&self, bound: f64) -> f64 {
        if self.nodes.is_empty() { bound } else { bound.min(self.base.get()) }
    }
}
