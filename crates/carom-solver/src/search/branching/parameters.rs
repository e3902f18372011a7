//! The parameters of branching.

/// The parameters of branching.
#[derive(Debug)]
pub(super) struct BranchingParameters {
    /// Most trials of new columns at a node.
    pub(super) trials: usize,
    /// Most trials of new columns at a node where a disjunction could be split instead, because its
    /// sides were tried already.
    pub(super) trials_beside_disjunction: usize,
    /// Trials in a row without a better column, after which the rest is taken at its pseudocosts.
    pub(super) idle_trials: usize,
    /// Most trials for fixings at a node that find nothing.
    pub(super) fixing_idle_trials: usize,
    /// Largest credit for such trials, in trials.
    pub(super) fixing_credit: f64,
    /// Credit that a fixing adds, in trials.
    pub(super) credit_per_fixing: f64,
    /// Credit that a node without credit adds, in trials.
    pub(super) credit_per_node: f64,
    /// Beside the tree of an earlier solve, fixings by trials are tried only at nodes whose own
    /// tree is expected to have at least so many nodes.
    pub(super) fixing_tree: f64,
}

pub(super) const BRANCHING: BranchingParameters = BranchingParameters {
    trials: 8,
    trials_beside_disjunction: 2,
    idle_trials: 4,
    fixing_idle_trials: 8,
    fixing_credit: 16.0,
    credit_per_fixing: 2.0,
    credit_per_node: 0.05,
    fixing_tree: 2.0,
};
