//! The view and the finds of a worker of the deterministic search during a round.

use super::best_points::Accepted;
use super::node::Node;
use crate::solution::Termination;

/// The state of the tree at the start of a round, and what a worker keeps back until its end.
#[derive(Default)]
pub(super) struct RoundBuffer {
    /// The cutoff at the start, lowered by the worker's own points.
    pub(super) cutoff: f64,
    /// New open nodes.
    pub(super) nodes: Vec<Node>,
    /// Verified points.
    pub(super) points: Vec<Accepted>,
    /// Why the worker ends the search.
    pub(super) stop: Option<Termination>,
}
