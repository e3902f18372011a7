//! Nodes as compact bound changes, and the queue of open ones.
//!
//! A node is its last decision and a shared pointer to those before it. Siblings share their
//! ancestors, so an open node costs its entry in the queue and at most a few bound changes, however
//! deep it is. Bound changes are freed with the last node below them.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering as Memory};

use super::root_point::RootPoint;
use super::saved_tree::ProofMultipliers;
use crate::relaxation::WarmState;

/// One bound change by branching.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Decision {
    /// The column.
    pub column: usize,
    /// Whether the upper bound changes.
    pub is_upper: bool,
    /// The new bound, in the column's unit.
    pub value: f64,
}

/// Counts the steps of a tree that are alive.
pub type StepCount = Arc<AtomicUsize>;

/// A decision, and those before it.
#[derive(Debug)]
struct PathStep {
    parent: Option<Arc<PathStep>>,
    value: f64,
    /// Twice the column, plus one for an upper bound.
    bound: u32,
    depth: u32,
    count: StepCount,
}

impl Drop for PathStep {
    fn drop(&mut self) {
        self.count.fetch_sub(1, Memory::Relaxed);
        // Not by recursion: a path may be longer than a stack.
        let mut next = self.parent.take();
        while let Some(mut step) = next.and_then(Arc::into_inner) {
            next = step.parent.take();
        }
    }
}

/// The decisions from the root to a node.
#[derive(Debug, Clone, Default)]
pub struct Path {
    last: Option<Arc<PathStep>>,
}

impl Path {
    /// Bytes of a step, with the two counts of its pointer.
    pub(super) const STEP_BYTES: usize = size_of::<PathStep>() + 2 * size_of::<usize>();

    /// This path and a decision more.
    pub fn then(&self, decision: &Decision, count: &StepCount) -> Self {
        count.fetch_add(1, Memory::Relaxed);
        let step = PathStep {
            parent: self.last.clone(),
            value: decision.value,
            bound: 2 * decision.column as u32 + u32::from(decision.is_upper),
            depth: self.len() as u32 + 1,
            count: count.clone(),
        };
        Path { last: Some(Arc::new(step)) }
    }

    /// Number of decisions.
    pub fn len(&self) -> usize {
        self.last.as_ref().map_or(0, |step| step.depth as usize)
    }

    /// Whether it leads to the root.
    pub fn is_empty(&self) -> bool {
        self.last.is_none()
    }

    /// The decisions, the last one first.
    pub(super) fn backwards(&self) -> impl Iterator<Item = Decision> + '_ {
        let steps = std::iter::successors(self.last.as_deref(), |step| step.parent.as_deref());
        steps.map(|step| Decision {
            column: step.bound as usize / 2,
            is_upper: step.bound % 2 == 1,
            value: step.value,
        })
    }

    pub(super) fn last(&self) -> Option<Decision> {
        self.backwards().next()
    }

    /// Writes the decisions in their order into a buffer.
    pub fn write_to(&self, buffer: &mut Vec<Decision>) {
        buffer.clear();
        buffer.extend(self.backwards());
        buffer.reverse();
    }
}

/// The result of a node's relaxation that is known before the node is visited.
#[derive(Debug, Clone)]
pub(super) struct KnownRelaxation {
    /// The relaxed point, over all columns.
    pub(super) point: Vec<f64>,
    /// The state left by the relaxation.
    pub(super) warm: Option<WarmState>,
}

/// An open node: the decisions from the root, and a proved bound on its subtree.
#[derive(Debug, Clone)]
pub struct Node {
    /// The decisions from the root.
    pub path: Path,
    /// The proved bound, in the unit of the (minimised) objective.
    pub bound: f64,
    /// The part of the whole tree that it stands for, as if all children of a node were alike (no
    /// unit).
    pub(super) share: f64,
    /// The distance by which the last decision moved its column from the parent's relaxed value.
    pub(super) fraction: f64,
    /// The relaxation of a trial, if there was one.
    pub(super) known: Option<Box<KnownRelaxation>>,
    /// The state left by the parent's relaxation.
    pub(super) warm: Option<WarmState>,
    /// Order of creation, the last tie-breaker: makes the search deterministic.
    pub serial: u64,
    /// Its name in a tree that is kept for a later solve; 0 for the root.
    pub(super) id: u32,
    /// The multipliers that proved its bound, if they are kept.
    pub(super) multipliers: Option<Arc<ProofMultipliers>>,
}

impl Node {
    /// The root of a tree.
    pub fn root() -> Self {
        let (path, bound) = (Path::default(), f64::NEG_INFINITY);
        Node {
            path,
            bound,
            share: 1.0,
            fraction: 0.0,
            known: None,
            warm: None,
            serial: 0,
            id: 0,
            multipliers: None,
        }
    }

    /// The root of a tree whose relaxed point may be known.
    pub(super) fn relaxed_root(root: Option<&RootPoint>) -> Self {
        let Some(root) = root else { return Node::root() };
        if !root.is_final() {
            return Node { bound: root.bound, ..Node::root() };
        }
        let known =
            Some(Box::new(KnownRelaxation { point: root.x.clone(), warm: root.warm.clone() }));
        Node { bound: root.bound, known, ..Node::root() }
    }
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
pub struct NodeQueue {
    heap: BinaryHeap<Node>,
    /// The sum of the shares of its nodes.
    share: f64,
}

impl NodeQueue {
    /// Adds an open node.
    pub fn push(&mut self, node: Node) {
        self.share += node.share;
        self.heap.push(node);
    }

    /// Takes the next node.
    pub fn pop(&mut self) -> Option<Node> {
        let node = self.heap.pop();
        self.let_go(node)
    }

    fn let_go(&mut self, node: Option<Node>) -> Option<Node> {
        self.share = match (&node, self.heap.is_empty()) {
            (Some(node), false) => self.share - node.share,
            _ => 0.0,
        };
        node
    }

    /// The part of the whole tree that its nodes stand for.
    pub(super) fn share(&self) -> f64 {
        self.share
    }

    /// Takes the deepest node, the youngest one of several. Takes time in proportion to all nodes.
    pub(super) fn pop_deepest(&mut self) -> Option<Node> {
        let mut nodes = std::mem::take(&mut self.heap).into_vec();
        let order = |(_, node): &(usize, &Node)| (node.path.len(), node.serial);
        let deepest = nodes.iter().enumerate().max_by_key(order).map(|(k, _)| k);
        let node = deepest.map(|k| nodes.swap_remove(k));
        self.heap = nodes.into();
        self.let_go(node)
    }

    pub(super) fn len(&self) -> usize {
        self.heap.len()
    }

    /// The smallest bound of an open node; `+inf` when there is none.
    pub fn best_bound(&self) -> f64 {
        self.heap.peek().map_or(f64::INFINITY, |node| node.bound)
    }

    /// All open nodes, in no order.
    pub(super) fn iter(&self) -> impl Iterator<Item = &Node> {
        self.heap.iter()
    }
}
