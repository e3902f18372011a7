//! Points from fixed integers: solve what is left, polish, verify, offer.

use std::hash::{DefaultHasher, Hash, Hasher};

use super::clock::Activity;
use super::node_relaxation::Verdict;
use super::worker::Worker;
use crate::presolve::{Reduced, Reduction};
use crate::relaxation::{polish, polish_leaf};
use crate::tolerance;

impl Worker<'_> {
    /// Fixes all integers to the rounded values of `point`, solves the rest and offers the
    /// result; whether it was accepted. The domain is left as it was.
    pub(super) fn try_assignment(&mut self, point: &[f64]) -> bool {
        let mark = self.domain.mark();
        for &j in self.own_integers() {
            let value = point[j].round();
            self.domain.apply(j, false, value.max(self.domain.lower(j)));
            self.domain.apply(j, true, value.min(self.domain.upper(j)));
        }
        let found = self.solve_assignment(mark);
        self.domain.undo_to(mark);
        found
    }

    /// Solves the leaf that the domain has become since `mark` and offers its point.
    pub(super) fn solve_assignment(&mut self, mark: usize) -> bool {
        if self.propagate_since(mark).is_err() {
            return false;
        }
        // The same integers lead to the same point.
        if !self.is_leaf() || !self.is_new_assignment() {
            return false;
        }
        let program = self.task.exact.unwrap_or(self.program());
        let Reduction::Reduced(reduced) = self.reducer.reduce(program, &self.domain) else {
            return false;
        };
        match self.relax(&reduced, false) {
            Verdict::Relaxed { x, .. } => self.offer_leaf(&reduced, &x),
            _ => false,
        }
    }

    /// Whether the integers of the domain, all fixed, were not seen here before.
    fn is_new_assignment(&mut self) -> bool {
        let mut hasher = DefaultHasher::new();
        for &j in &self.program().integers {
            self.domain.lower(j).to_bits().hash(&mut hasher);
        }
        self.accounts.assignments.insert(hasher.finish())
    }

    /// Polishes a leaf's point and offers it; `false` when the check refuses it.
    pub(super) fn offer_leaf(&mut self, reduced: &Reduced, x: &[f64]) -> bool {
        let activity = self.clock.switch(Activity::Verification);
        let found = self.offer_verified(reduced, x);
        self.clock.switch(activity);
        found
    }

    fn offer_verified(&mut self, reduced: &Reduced, x: &[f64]) -> bool {
        let mut polished = x.to_vec();
        polish(reduced, &mut polished, &self.token);
        // Bounds are proved inside a radius only; a point outside must not be measured by them.
        let open = |j: usize| reduced.lower[j].is_infinite() || reduced.upper[j].is_infinite();
        for candidate in [&polished[..], x] {
            let far = |(j, v): (usize, &f64)| v.abs() > tolerance::FREE_RADIUS && open(j);
            if candidate.iter().enumerate().any(far) {
                continue;
            }
            let mut point = self.complete_point(reduced.lift(candidate));
            for &j in &self.program().integers {
                point[j] = point[j].round();
            }
            if self.offer_accepted(&point) {
                return true;
            }
            // Columns that the reduction has fixed inside narrow bounds may have to move.
            polish_leaf(self.task.exact.unwrap_or(self.program()), &mut point, &self.token);
            if self.offer_accepted(&point) {
                return true;
            }
        }
        false
    }

    fn offer_accepted(&mut self, point: &[f64]) -> bool {
        let accepted = (self.task.accept)(point);
        if accepted {
            self.tree.offer(self.program().objective(point), point.to_vec());
        }
        accepted
    }
}
