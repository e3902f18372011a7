//! Pauses of a search: whether it ends there, because another one takes its place.

use crate::solver::Progress;

/// The growth of the number of nodes from pause to pause.
const PAUSE_GROWTH: u64 = 2;

/// Asks again and again, after so many nodes and then after ever more, whether the search ends.
pub(crate) struct Pauses<'a> {
    /// Nodes before the next pause.
    pub(crate) nodes: u64,
    /// Whether the search ends.
    pub(crate) ends: &'a mut dyn FnMut(&Progress) -> bool,
}

impl Pauses<'_> {
    /// Pauses if it is time. Returns whether the search ends.
    pub(super) fn is_end(&mut self, progress: &Progress) -> bool {
        if progress.nodes < self.nodes {
            return false;
        }
        self.nodes = progress.nodes.saturating_mul(PAUSE_GROWTH);
        (self.ends)(progress)
    }
}
