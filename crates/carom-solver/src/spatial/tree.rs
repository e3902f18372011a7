//! The open nodes of a search.

use std::collections::BinaryHeap;
use std::sync::Arc;

use crate::presolve::Domain;
use crate::relaxation::WarmState;

/// A box that is still to be searched.
#[derive(Debug, Clone)]
pub(super) struct SpatialNode {
    /// A proved bound.
    pub(super) bound: f64,
    pub(super) depth: u64,
    /// Bounds of columns that differ from those of the root: lower and upper ones.
    pub(super) bounds: Vec<(u32, [f64; 2])>,
    /// The relaxed point of the parent.
    pub(super) x: Option<Arc<Vec<f64>>>,
    pub(super) warm: Option<WarmState>,
    /// The column of the split, and what it has taken from the parent's point.
    pub(super) split: Option<(usize, f64)>,
}

impl SpatialNode {
    /// The bounds of a domain that differ from those of the root.
    pub(super) fn bounds_of(root: &Domain, domain: &Domain) -> Vec<(u32, [f64; 2])> {
        let all = 0..domain.column_count();
        let changed = all.filter(|&j| root.bounds(j) != domain.bounds(j));
        changed.map(|j| (j as u32, domain.bounds(j))).collect()
    }

    fn bytes(&self) -> usize {
        size_of::<SpatialNode>() + self.bounds.len() * size_of::<(u32, [f64; 2])>()
    }
}

/// Least bound first; of equal ones, the deeper one.
struct ByBound(SpatialNode);

impl PartialEq for ByBound {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for ByBound {}

impl PartialOrd for ByBound {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for ByBound {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        other.0.bound.total_cmp(&self.0.bound).then(self.0.depth.cmp(&other.0.depth))
    }
}

/// The open nodes: one to go on with, and others by their bounds.
#[derive(Default)]
pub(super) struct OpenNodes {
    heap: BinaryHeap<ByBound>,
    bytes: usize,
}

impl OpenNodes {
    pub(super) fn push(&mut self, node: SpatialNode) {
        self.bytes += node.bytes();
        self.heap.push(ByBound(node));
    }

    /// The node with the least bound.
    pub(super) fn pop(&mut self) -> Option<SpatialNode> {
        let node = self.heap.pop()?.0;
        self.bytes -= node.bytes();
        Some(node)
    }

    /// The least bound.
    pub(super) fn bound(&self) -> Option<f64> {
        self.heap.peek().map(|node| node.0.bound)
    }

    pub(super) fn len(&self) -> usize {
        self.heap.len()
    }

    /// The memory of the nodes, in bytes.
    pub(super) fn bytes(&self) -> usize {
        self.bytes
    }
}
