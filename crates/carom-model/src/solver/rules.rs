//! Branching rules.

/// How a node is split.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum BranchingRule {
    /// Pseudocosts if there is an objective. Otherwise the latest step first, and in turns with
    /// that pseudocosts under an objective of the search's own.
    #[default]
    Automatic,
    /// By the expected bounds of both children (pseudocosts), initialised by strong branching.
    Pseudocosts,
    /// The latest step first: the step in the variable's name, or its position if names have no
    /// steps.
    LatestFirst,
}
