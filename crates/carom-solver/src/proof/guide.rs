//! The tree of a search, as a hint where to split.

use std::collections::BTreeMap;
use std::rc::Rc;

use super::tree::ProofPart;
use crate::search::{Decision, Fork};

/// The tree of a search, as a hint where to split.
#[derive(Debug, Default)]
pub(crate) struct Guide {
    pub(super) forks: BTreeMap<u32, Fork>,
    /// The column of the lowered program behind each column of the search.
    pub(super) columns: Option<Vec<usize>>,
    /// Number of columns of the lowered program; the search may have had more.
    pub(super) count: usize,
    /// Whether the search was one of the lowered program as it is.
    pub(super) is_plain: bool,
}

impl Guide {
    /// The splits of a search.
    pub(crate) fn new(forks: Vec<Fork>, columns: Option<Vec<usize>>, count: usize) -> Self {
        Guide {
            forks: forks.into_iter().map(|fork| (fork.id(), fork)).collect(),
            columns,
            count,
            is_plain: false,
        }
    }

    pub(super) fn fork(&self, node: u32) -> Option<&Fork> {
        self.forks.get(&node)
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
        fork: &Fork,
        place: usize,
    ) -> Option<(Option<Decision>, Option<u32>)> {
        let (decision, child) = fork.decision(place)?;
        let column = match &self.columns {
            Some(columns) => columns.get(decision.column).copied(),
            None => Some(decision.column),
        };
        let column = column.filter(|column| *column < self.count);
        Some((column.map(|column| Decision { column, ..decision }), child))
    }
}
