//! Rules of the search that can be chosen.

/// Which column a node is split on, where the user's own rule
/// ([`Branching`](super::Branching)) has no opinion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum BranchingRule {
    /// Pseudocosts where there is an objective, event windows where there is none.
    #[default]
    Automatic,
    /// By the growth of the bound that is expected of both children, initialised by trying them.
    Pseudocosts,
    /// The latest step first: that of the variable's name, or its position where names have none.
    LatestFirst,
    /// "No event in these steps", or at least one: binaries that the rows link into a chain are
    /// events of a horizon, and windows of it are halved. Pseudocosts or the latest step first
    /// where there is no chain, and where no window is open.
    EventWindows,
}
