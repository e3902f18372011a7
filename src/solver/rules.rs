//! Branching rules.

/// How a node is split.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum BranchingRule {
    /// Pseudocosts if there is an objective. Otherwise event windows, and in turns with them pseudocosts
    /// under an objective of the search's own.
    #[default]
    Automatic,
    /// By the expected bounds of both children (pseudocosts), initialised by strong branching.
    Pseudocosts,
    /// The latest step first: the step in the variable's name, or its position if names have no
    /// steps.
    LatestFirst,
    /// Event windows: "no event in these steps", or at least one. Binaries that the rows link into
    /// a chain are the events of a horizon, and windows of it are halved. If there is no chain or
    /// no open window, pseudocosts or the latest step.
    EventWindows,
}
