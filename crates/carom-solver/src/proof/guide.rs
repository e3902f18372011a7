//! The tree of a search, as a hint where to split.

use std::collections::BTreeMap;
use std::rc::Rc;

use super::tree::ProofPart;
use crate::presolve::root::Origins;
use crate::search::{Decision, RootCuts, SavedSplit};

/// The tree of a search, as a hint where to split.
#[derive(Debug, Default)]
pub(crate) struct Guide {
    pub(super) splits: BTreeMap<u32, SavedSplit>,
    /// Where the program of the search comes from in the lowered one.
    pub(super) origins: Option<Origins>,
    /// The cuts of its root.
    pub(super) cuts: Option<Box<RootCuts>>,
    /// Number of columns of the lowered program; the search may have had more.
    pub(super) count: usize,
    /// Whether the search was one of the lowered program as it is.
    pub(super) is_plain: bool,
}

impl Guide {
    /// The splits of a search.
    pub(crate) fn new(
        splits: Vec<SavedSplit>,
        origins: Option<Origins>,
        count: usize,
        cuts: Option<Box<RootCuts>>,
    ) -> Self {
        Guide {
            splits: splits.into_iter().map(|saved| (saved.id(), saved)).collect(),
            origins,
            cuts,
            count,
            is_plain: false,
        }
    }

    pub(super) fn saved_split(&self, node: u32) -> Option<&SavedSplit> {
        self.splits.get(&node)
    }

    /// Where a child goes on; without a name it is an end.
    pub(super) fn part(self: Rc<Self>, child: Option<u32>) -> ProofPart {
        match child {
            Some(node) => ProofPart::Node(self, node),
            None => ProofPart::End(self),
        }
    }

    /// The decision at a place of a node's splits, and the node inside of it; `None` behind the
    /// last one. The decision is `None` if it is about no column of the lowered program.
    pub(super) fn split(
        &self,
        saved: &SavedSplit,
        place: usize,
    ) -> Option<(Option<Decision>, Option<u32>)> {
        let (decision, child) = saved.decision(place)?;
        let Some(origins) = &self.origins else {
            return Some(((decision.column < self.count).then_some(decision), child));
        };
        let place = decision.column;
        let column = origins.columns.get(place).copied().filter(|column| *column < self.count);
        let named = column.map(|column| {
            let meaning = origins.meanings[place];
            let is_upper = decision.is_upper == (meaning.factor > 0.0);
            Decision { column, is_upper, value: meaning.value(decision.value) }
        });
        Some((named, child))
    }
}
