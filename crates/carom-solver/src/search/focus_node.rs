//! The focus node, which is being processed: its domain, and the path that led to it.

use std::sync::Arc;

use super::node::Decision;
use super::saved_tree::ProofMultipliers;
use crate::presolve::{Domain, Propagator};
use crate::relaxation::WarmState;

/// A node on the current path from which the search went down: its depth, and the end of the trail
/// when the search left it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Checkpoint {
    depth: usize,
    mark: usize,
}

/// The node that a worker processes.
pub(super) struct FocusNode {
    pub(super) domain: Domain,
    /// The decisions that the domain reflects.
    pub(super) path: Vec<Decision>,
    /// Nodes on that path.
    checkpoints: Vec<Checkpoint>,
    /// The end of the trail at the root.
    root_mark: usize,
    /// The cutoff that propagation uses here.
    pub(super) cutoff: f64,
    /// The state left by its relaxation, or by its parent's before it is relaxed.
    pub(super) warm: Option<WarmState>,
    /// Its name in a tree that is kept.
    pub(super) id: u32,
    /// Sides that trials have closed here, if the tree is kept.
    pub(super) closed: Vec<Decision>,
    /// The multipliers that prove its bound, if they are kept.
    pub(super) multipliers: Option<Arc<ProofMultipliers>>,
}

impl FocusNode {
    pub(super) fn root(domain: &Domain) -> Self {
        FocusNode {
            domain: domain.clone(),
            path: Vec::new(),
            checkpoints: Vec::new(),
            root_mark: domain.mark(),
            cutoff: f64::INFINITY,
            warm: None,
            id: 0,
            closed: Vec::new(),
            multipliers: None,
        }
    }

    /// Applies a decision to the domain if it tightens it; returns whether it does.
    pub(super) fn apply_if_news(&mut self, decision: &Decision) -> bool {
        let &Decision { column, is_upper, value } = decision;
        let [lower, upper] = self.domain.bounds(column);
        let news = if is_upper { value < upper } else { value > lower };
        if news {
            self.domain.apply(column, is_upper, value);
        }
        news
    }

    /// Sets both bounds of a column.
    pub(super) fn fix(&mut self, column: usize, value: f64) {
        self.domain.apply(column, false, value);
        self.domain.apply(column, true, value);
    }

    /// Goes back to the last node that the current path shares with another path.
    pub(super) fn go_back_towards(&mut self, path: &[Decision], propagator: &mut Propagator) {
        let shared = path.iter().zip(&self.path).take_while(|(a, b)| a == b).count();
        if shared == self.path.len() {
            let checkpoint = Checkpoint { depth: shared, mark: self.domain.mark() };
            if self.checkpoints.last() != Some(&checkpoint) {
                self.checkpoints.push(checkpoint);
            }
            return;
        }
        while self.checkpoints.pop_if(|c| c.depth > shared).is_some() {}
        let root = Checkpoint { depth: 0, mark: self.root_mark };
        let Checkpoint { depth, mark } = self.checkpoints.last().copied().unwrap_or(root);
        propagator.touch(self.domain.changed_since(mark));
        self.domain.undo_to(mark);
        self.path.truncate(depth);
    }
}
