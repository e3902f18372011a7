//! From node to node: decisions applied to the domain, propagated, and probed.

use std::cell::Cell;

use super::clock::Activity;
use super::node::Decision;
use super::worker::Worker;
use crate::presolve::{Conflict, probe_again};

impl Worker<'_> {
    /// Brings the domain to a node: on from the current path where it is a prefix, else from the
    /// root.
    pub(super) fn enter(&mut self, path: &[Decision]) -> Result<(), Conflict> {
        let shared = path.len() >= self.path.len() && path[..self.path.len()] == self.path[..];
        if !shared {
            self.propagator.touch(self.domain.changed_since(self.root));
            self.domain.undo_to(self.root);
            self.path.clear();
        }
        self.cutoff = self.propagator.set_cutoff(self.task.program, self.tree.cutoff());
        let mark = self.domain.mark();
        let fresh = &path[self.path.len()..];
        for decision in fresh {
            self.domain.apply(decision.column, decision.is_upper, decision.value);
        }
        let program = self.task.program;
        let activity = self.clock.switch(Activity::Propagation);
        let mut result = self.propagator.propagate_since(program, &mut self.domain, mark);
        self.clock.switch(Activity::Probing);
        if result.is_ok() && self.root_done {
            result = self.probe_node();
        }
        self.root_done = true;
        self.clock.switch(activity);
        if result.is_ok() {
            self.path.extend_from_slice(fresh);
        } else {
            self.domain.undo_to(mark);
        }
        result
    }

    /// Probes as much as probing has paid so far.
    fn probe_node(&mut self) -> Result<(), Conflict> {
        let trials = self.probing.trials();
        let (before, done) = (self.domain.mark(), Cell::new(0));
        let go_on = || {
            done.set(done.get() + 1);
            self.tree.limit_reached().is_none()
        };
        let (domain, propagator) = (&mut self.domain, &mut self.propagator);
        let order = (&self.late_first[..], trials);
        let record = &mut self.probing.record;
        let result = probe_again(self.task.program, domain, propagator, order, record, &go_on);
        let decided = |&(j, _): &(usize, bool)| self.task.program.integral[j];
        let gains = self.domain.changed_since(before).filter(decided).count();
        self.probing.book(done.get(), gains, result.is_err());
        result
    }

    /// Propagates what changed since a mark.
    pub(super) fn propagate_since(&mut self, mark: usize) -> Result<(), Conflict> {
        let activity = self.clock.switch(Activity::Propagation);
        let result = self.propagator.propagate_since(self.task.program, &mut self.domain, mark);
        self.clock.switch(activity);
        result
    }
}
