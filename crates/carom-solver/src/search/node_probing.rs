//! The budget of probing at nodes, which follows its success.
//!
//! On some programs a few trials refute nodes without a relaxation. On others, hundreds of trials
//! per node find nothing and cost more than the relaxations. So trials are paid from a credit that
//! every success raises.

use crate::presolve::{ProbingRecord, Trials};

/// Most trials at a node, and those that are always allowed, to notice when probing begins to pay.
const MOST_TRIALS: usize = 200;
const LEAST_TRIALS: usize = 4;

/// Trials in a row that may find nothing before a node's probing ends. What is excluded at one step
/// lets the next one be excluded, so successes come in runs.
const NODE_FAILED_TRIALS: usize = 10;

/// The credit at first and at most, in trials; about that of ten full nodes.
const MOST_CREDIT: i64 = 2000;

/// The credit for a bound of an integer that probing moves, and for a refuted node, in trials. A
/// tenth of these left a pendulum of 40 steps open after 40 s that takes 0.4 s; more changes
/// little.
const CREDIT_PER_BOUND: i64 = 50;
const CREDIT_PER_REFUTATION: i64 = 400;

/// The account of one worker.
#[derive(Debug)]
pub struct NodeProbing {
    credit: i64,
    /// Whether the root, probed before the search, is still to come.
    at_root: bool,
    /// The record of earlier trials.
    pub(super) record: ProbingRecord,
}

impl NodeProbing {
    /// An account with full credit, for a program with so many columns.
    pub fn new(columns: usize) -> Self {
        NodeProbing { credit: MOST_CREDIT, at_root: true, record: ProbingRecord::new(columns) }
    }

    /// Whether the next node is to be probed: every one but the first.
    pub(super) fn is_due(&mut self) -> bool {
        !std::mem::take(&mut self.at_root)
    }

    /// Trials for the next node.
    pub fn trials(&self) -> Trials {
        let most = usize::try_from(self.credit).unwrap_or(0).clamp(LEAST_TRIALS, MOST_TRIALS);
        Trials { most, patience: NODE_FAILED_TRIALS }
    }

    /// Books what a node's probing took and brought.
    pub fn book(&mut self, trials: usize, bounds: usize, refuted: bool) {
        let trials = i64::try_from(trials).unwrap_or(i64::MAX);
        let bounds = i64::try_from(bounds).unwrap_or(i64::MAX);
        let refuted = if refuted { CREDIT_PER_REFUTATION } else { 0 };
        let gain =
            bounds.saturating_mul(CREDIT_PER_BOUND).saturating_add(refuted).saturating_sub(trials);
        self.credit = self.credit.saturating_add(gain).clamp(-MOST_CREDIT, MOST_CREDIT);
    }
}
