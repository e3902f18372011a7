//! When which heuristic runs.

use std::collections::BTreeSet;

use super::allowance::Allowance;
use super::clock::Activity;
use super::exclusion::Exclusion;
use super::trace::span;
use super::worker::Worker;
use crate::solution::Heuristic;

/// Nodes between two runs of rounding, while there is no point and afterwards.
const PAUSE: u64 = 5;
const LONG_PAUSE: u64 = 50;

/// The accounts of the heuristics of one worker.
pub(super) struct Accounts {
    /// Nodes since the rounding heuristic last ran.
    since_rounding: u64,
    /// Nodes that this worker has processed.
    pub(super) nodes: u64,
    /// Interior-point iterations of this worker, those of its small searches included.
    pub(super) iterations: u64,
    pub(super) exclusion: Exclusion,
    /// Fingerprints of the integers that were solved as leaves by heuristics.
    pub(super) assignments: BTreeSet<u64>,
    pub(super) diving: Allowance,
    pub(super) neighbourhood: Allowance,
    pub(super) local_branching: Allowance,
}

impl Accounts {
    pub(super) fn new() -> Self {
        Accounts {
            since_rounding: u64::MAX,
            nodes: 0,
            iterations: 0,
            exclusion: Exclusion::new(),
            assignments: BTreeSet::new(),
            diving: Allowance::default(),
            neighbourhood: Allowance::default(),
            local_branching: Allowance::default(),
        }
    }
}

impl Worker<'_> {
    /// Looks for points near the relaxed point of the current node.
    pub(super) fn look_for_points(&mut self, point: &[f64], bound: f64, at_root: bool) {
        let on = self.task.options.heuristics;
        let activity = self.clock.switch(Activity::Heuristic);
        let whole = self.is_whole(point);
        if whole {
            self.try_whole_point(point);
        }
        let pause = if self.tree.cutoff() == f64::INFINITY { PAUSE } else { LONG_PAUSE };
        if at_root || self.accounts.since_rounding >= pause {
            self.accounts.since_rounding = 0;
            if on.rounding {
                span!(DEBUG, "heuristic", name = "rounding");
                let before = self.tree.begin(Heuristic::Rounding);
                self.round_and_propagate(point);
                self.tree.end(before);
            }
            if on.roll_out && !self.program().is_feasibility_problem() {
                span!(DEBUG, "heuristic", name = "roll-out");
                let before = self.tree.begin(Heuristic::RollOut);
                self.roll_out(point);
                self.tree.end(before);
            }
            self.try_proposals(point, bound);
        }
        self.accounts.since_rounding = self.accounts.since_rounding.saturating_add(1);
        if on.pump && at_root && !whole {
            self.pump_at_root(point, bound);
        }
        if on.diving && !whole {
            self.dive_where_it_pays(point, bound);
        }
        if on.neighbourhood || on.local_branching {
            self.search_near_incumbent(point, bound);
        }
        self.clock.switch(activity);
    }

    /// Tries a point that has become whole by settling what had a choice.
    pub(super) fn look_for_settled_point(&mut self, raw: &[f64], settled: &[f64]) {
        if raw != settled && self.is_whole(settled) {
            let activity = self.clock.switch(Activity::Heuristic);
            self.try_whole_point(settled);
            self.clock.switch(activity);
        }
    }

    fn try_whole_point(&mut self, point: &[f64]) {
        span!(DEBUG, "heuristic", name = "relaxation");
        let before = self.tree.begin(Heuristic::Relaxation);
        self.try_assignment(point);
        self.tree.end(before);
    }

    /// Whether all integers of a point are whole.
    pub(super) fn is_whole(&self, point: &[f64]) -> bool {
        let integrality = self.task.options.integrality;
        let whole = |j: &usize| (point[*j] - point[*j].round()).abs() <= integrality;
        self.program().integers.iter().all(whole)
    }
}
