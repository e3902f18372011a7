//! From node to node: decisions applied to the domain, propagated, and probed.

use super::clock::Activity;
use super::node::Decision;
use super::worker::Worker;
use crate::presolve::{Conflict, probe_again};

/// A node on the current path: its depth, and where the trail ended when it was left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stop {
    depth: usize,
    mark: usize,
}

impl Worker<'_> {
    /// Brings the domain to a node: on from its nearest ancestor that the current path went through,
    /// with all that was concluded there.
    pub(super) fn enter(&mut self, path: &[Decision]) -> Result<(), Conflict> {
        self.go_back_towards(path);
        self.cutoff = self.propagator.set_cutoff(self.task.program, self.tree.cutoff());
        let mark = self.domain.mark();
        let fresh = &path[self.path.len()..];
        for decision in fresh {
            self.apply_if_news(decision);
        }
        let program = self.task.program;
        let activity = self.clock.switch(Activity::Propagation);
        let mut result = self.propagator.propagate_since(program, &mut self.domain, mark);
        let probes = result.is_ok() && self.root_done && self.task.options.probing;
        if probes {
            self.clock.switch(Activity::Probing);
            result = self.probe_node();
        }
        self.root_done = true;
        self.clock.switch(activity);
        if result.is_err() {
            self.domain.undo_to(mark);
            return result;
        }
        self.path.extend_from_slice(fresh);
        if probes && !self.task.options.keep_leaves {
            // What trials found becomes part of the path: no child has to find it again.
            let found = self.probing.record.found().iter();
            let facts =
                found.map(|&(column, is_upper, value)| Decision { column, is_upper, value });
            self.path.extend(facts);
        }
        Ok(())
    }

    /// Applies a decision to the domain unless it says nothing new there; whether it does.
    pub(super) fn apply_if_news(&mut self, decision: &Decision) -> bool {
        let &Decision { column, is_upper, value } = decision;
        let [lower, upper] = self.domain.bounds(column);
        let news = if is_upper { value < upper } else { value > lower };
        if news {
            self.domain.apply(column, is_upper, value);
        }
        news
    }

    /// Undoes what does not hold at the end of a path.
    fn go_back_towards(&mut self, path: &[Decision]) {
        let shared = path.iter().zip(&self.path).take_while(|(a, b)| a == b).count();
        if shared == self.path.len() {
            let stop = Stop { depth: shared, mark: self.domain.mark() };
            if self.stops.last() != Some(&stop) {
                self.stops.push(stop);
            }
            return;
        }
        // No-goods are tidied where no bound comes from them: at the root.
        let tidies = self.propagator.has_untidy_no_goods();
        while self.stops.pop_if(|stop| tidies || stop.depth > shared).is_some() {}
        let root = Stop { depth: 0, mark: self.root };
        let Stop { depth, mark } = self.stops.last().copied().unwrap_or(root);
        self.propagator.touch(self.domain.changed_since(mark));
        self.domain.undo_to(mark);
        self.path.truncate(depth);
        if tidies {
            self.propagator.tidy_no_goods();
        }
    }

    /// Probes as much as probing has paid so far.
    fn probe_node(&mut self) -> Result<(), Conflict> {
        let trials = self.probing.trials();
        let before = self.domain.mark();
        let (domain, propagator) = (&mut self.domain, &mut self.propagator);
        let order = (&self.late_first[..], trials);
        let record = &mut self.probing.record;
        let result = probe_again(self.task.program, domain, propagator, order, record, &self.token);
        let decided = |&(j, _): &(usize, bool)| self.task.program.integral[j];
        let gains = self.domain.changed_since(before).filter(decided).count();
        let tried = self.probing.record.tried();
        self.probing.book(tried, gains, result.is_err());
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
