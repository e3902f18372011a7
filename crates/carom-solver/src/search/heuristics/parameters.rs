//! The parameters of the heuristics.

/// The parameters of the heuristics.
#[derive(Debug)]
pub(super) struct HeuristicParameters {
    /// Nodes between two runs of rounding while there is no point.
    pub(super) pause_without_point: u64,
    /// Nodes between two runs of rounding once there is a point.
    pub(super) pause_with_point: u64,
    /// Largest gap between a good point and the bound, relative to the value of the point.
    pub(super) good_point_gap: f64,
    /// Interior-point iterations that a heuristic may take whatever the search has cost, while
    /// there is no point.
    pub(super) free_iterations: u64,
    /// Share of the iterations of the whole search that a heuristic may take while every call is a
    /// success.
    pub(super) iteration_share: f64,
    /// Iterations that must be left for a dive to begin.
    pub(super) dive_iterations: u64,
    /// Most relaxations of a dive.
    pub(super) dive_steps: usize,
    /// A step of a dive fixes one in so many of the fractional integers.
    pub(super) dive_divisor: usize,
    /// Iterations that must be left for a neighbourhood search to begin.
    pub(super) neighbourhood_iterations: u64,
    /// Fewest and most nodes of a neighbourhood search.
    pub(super) neighbourhood_nodes: [u64; 2],
    /// Largest distance at which the best point and the relaxed one agree on an integer (no unit).
    pub(super) agreement: f64,
    /// Least share of the open integers that a neighbourhood search fixes.
    pub(super) fixed_share: f64,
    /// Share of the gap by which a new point of a neighbourhood search must be better.
    pub(super) gap_share: f64,
    /// Most relaxations of all completions of a start.
    pub(super) completion_relaxations: usize,
    /// Most relaxations of all completions in a prepared solve that no limit may stop. There, the
    /// warm start of the tree finds points as well.
    pub(super) prepared_relaxations: usize,
    /// Shares of the integers of a start, from its beginning, that are tried.
    pub(super) start_shares: [f64; 3],
    /// Largest share of the time for a first point in which integers are tried at their cheap ends
    /// (no unit).
    pub(super) cheap_ends_share: f64,
    /// Largest width of a continuous column that counts as known in a roll-out, relative to the
    /// width at first; in the column's unit if it had no bounds.
    pub(super) known_width: f64,
}

pub(super) const HEURISTICS: HeuristicParameters = HeuristicParameters {
    pause_without_point: 5,
    pause_with_point: 50,
    good_point_gap: 0.5,
    free_iterations: 50,
    iteration_share: 0.15,
    dive_iterations: 50,
    dive_steps: 20,
    dive_divisor: 2,
    neighbourhood_iterations: 150,
    neighbourhood_nodes: [10, 200],
    agreement: 0.1,
    fixed_share: 0.4,
    gap_share: 0.02,
    completion_relaxations: 12,
    prepared_relaxations: 1,
    start_shares: [1.0, 0.5, 0.25],
    cheap_ends_share: 0.2,
    known_width: 1e-4,
};
