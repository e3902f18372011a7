//! The tree of an earlier solve of nearly the same program: its splits, and the multipliers that
//! closed its ends.
//!
//! A node is closed by multipliers: they prove a bound beyond the cutoff, or that nothing is
//! feasible. Multipliers prove *some* bound on every program with the same rows, whatever its
//! limits, bounds and costs are. So the next solve tries the multipliers that closed an end of the
//! tree at the same end. Propagation and tightening may have changed that end since (see
//! `tree_warm_start`). The bound is proved as ever; where it falls short, the end is open.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::node::Decision;
use crate::presolve::Reduced;
use crate::relaxation::Prover;

/// Most dual solutions that are kept of a solve, and most numbers in all of them (32 MB).
const MOST_DUALS: usize = 2000;
const MOST_NUMBERS: usize = 4_000_000;

/// Split nodes of a large tree.
const LARGE_TREE: usize = 8;

/// Multipliers of a relaxation, and the point that belongs to them, over all rows and columns of
/// the program.
#[derive(Debug, Clone, Default)]
pub(crate) struct ProofMultipliers {
    /// Empty if the multipliers prove that nothing is feasible, rather than a bound.
    pub(crate) x: Vec<f64>,
    pub(crate) y: Vec<f64>,
}

/// An end of a tree, by the name of a node.
#[derive(Debug, Clone, Copy)]
pub(super) enum End {
    Node(u32),
    /// The side of a decision that was closed at a node.
    Side(u32, Decision),
}

/// An end as a key: a node, and the column of a side, whether its upper bound changes, and the bits
/// of the bound. Sides of one column at several values are different ends.
pub(super) type EndKey = (u32, Option<(usize, bool, u64)>);

impl End {
    pub(super) fn key(self) -> EndKey {
        match self {
            End::Node(node) => (node, None),
            End::Side(node, d) => (node, Some((d.column, d.is_upper, d.value.to_bits()))),
        }
    }
}

/// Multipliers that closed an end.
#[derive(Debug, Clone)]
pub(crate) struct SavedDuals {
    end: End,
    multipliers: Arc<ProofMultipliers>,
}

impl SavedDuals {
    pub(super) fn new(end: End, multipliers: Arc<ProofMultipliers>) -> Self {
        SavedDuals { end, multipliers }
    }
}

/// The result of trying earlier multipliers on a node.
#[derive(Debug, Clone, Copy)]
pub(super) enum ProofTrial {
    /// They close the node.
    Closed,
    /// They prove a bound below the cutoff.
    Bound(f64),
    Nothing,
}

impl ProofMultipliers {
    /// Tries these multipliers on a node.
    ///
    /// # Arguments
    ///
    /// * `picked`: a buffer for the multipliers of the node.
    pub(super) fn prove(
        &self,
        reduced: &Reduced,
        cutoff: f64,
        prover: &mut Prover,
        picked: &mut ProofMultipliers,
    ) -> ProofTrial {
        let ProofMultipliers { x, y } = picked;
        pick(&self.y, &reduced.origin, y);
        if y.len() != reduced.rows.len() {
            return ProofTrial::Nothing;
        }
        if self.x.is_empty() {
            let is_empty = prover.proves_infeasible(reduced, y);
            return if is_empty { ProofTrial::Closed } else { ProofTrial::Nothing };
        }
        pick(&self.x, &reduced.columns, x);
        let bound = prover.lower_bound(reduced, x, y);
        if bound >= cutoff { ProofTrial::Closed } else { ProofTrial::Bound(bound) }
    }
}

/// Writes the numbers at some places; 0 for places beyond the end.
fn pick(from: &[f64], places: &[usize], to: &mut Vec<f64>) {
    to.clear();
    to.extend(places.iter().map(|&k| from.get(k).copied().unwrap_or(0.0)));
}

/// The split of a node, by the names of its children.
#[derive(Debug, Clone, Default)]
pub(crate) struct SavedSplit {
    pub(super) id: u32,
    /// Sides that were closed before the split.
    pub(super) closed: Vec<Decision>,
    /// The children, each with the decision that holds in it and in none before it.
    pub(super) chain: Vec<(Decision, u32)>,
    /// The child in which none of these decisions holds.
    pub(super) rest: Option<u32>,
}

impl SavedSplit {
    /// Most nodes of a tree whose splits are kept for a later solve.
    pub(super) const MOST_NODES: u32 = 4000;

    /// The name of the node; 0 for the root.
    pub(crate) fn id(&self) -> u32 {
        self.id
    }

    /// A decision of the split, in order, each without those before it, and the node inside of it;
    /// `None` for a side that is closed.
    pub(crate) fn decision(&self, place: usize) -> Option<(Decision, Option<u32>)> {
        match self.closed.get(place) {
            Some(&side) => Some((side, None)),
            None => {
                let &(decision, child) = self.chain.get(place - self.closed.len())?;
                Some((decision, Some(child)))
            }
        }
    }

    /// The node outside of all decisions.
    pub(crate) fn rest(&self) -> Option<u32> {
        self.rest
    }
}

/// The tree of an earlier solve.
#[derive(Debug, Clone, Default)]
pub(crate) struct SavedTree {
    splits: BTreeMap<u32, SavedSplit>,
    /// The multipliers that closed nodes and sides.
    ends: BTreeMap<EndKey, Arc<ProofMultipliers>>,
}

impl SavedTree {
    /// The tree that the saved multipliers and splits of a solve describe.
    pub(crate) fn new(duals: &[SavedDuals], splits: &[SavedSplit]) -> Self {
        let mut all = SavedTree::default();
        for SavedDuals { end, multipliers } in duals {
            all.ends.insert(end.key(), multipliers.clone());
        }
        for split in splits {
            let mut split = split.clone();
            // A part that was open after a warm start was split later.
            if let Some(before) = all.splits.remove(&split.id) {
                split.closed.splice(..0, before.closed);
            }
            all.splits.insert(split.id, split);
        }
        all
    }

    /// The split of a node; `None` if none was kept.
    pub(super) fn split(&self, node: u32) -> Option<&SavedSplit> {
        self.splits.get(&node)
    }

    /// Whether any node was split.
    pub(super) fn has_splits(&self) -> bool {
        !self.splits.is_empty()
    }

    /// Whether the tree is large enough for efforts that save nodes.
    pub(super) fn is_large(&self) -> bool {
        self.splits.len() >= LARGE_TREE
    }

    /// The multipliers that closed an end; `None` if none were kept.
    pub(super) fn of(&self, end: End) -> Option<&Arc<ProofMultipliers>> {
        self.ends.get(&end.key())
    }

    /// Most dual solutions that are kept of a search over so many columns and rows.
    pub(super) fn max_duals(columns: usize, rows: usize) -> usize {
        MOST_DUALS.min(MOST_NUMBERS / (columns + rows).max(1))
    }
}
