//! The round-and-propagate heuristic.
//!
//! Integers are fixed one after the other, the surest first, each to its rounded relaxation
//! value; propagation fixes many of the others on the way, and where a value contradicts what is
//! already fixed the other side is tried once. What survives is solved as a leaf.

use super::worker::Worker;

impl Worker<'_> {
    /// Tries to turn a relaxed point into a feasible one; whether it did. The domain is left as it
    /// was.
    pub(super) fn round_and_propagate(&mut self, point: &[f64]) -> bool {
        let mark = self.domain.mark();
        let mut order: Vec<usize> = self.own_integers().to_vec();
        let distance = |j: usize| (point[j] - point[j].round()).abs();
        order.sort_by(|&a, &b| distance(a).total_cmp(&distance(b)).then(a.cmp(&b)));
        let complete = order.into_iter().all(|j| self.fix_rounded(j, point[j]) && !self.is_late());
        let found = complete && self.solve_assignment(self.domain.mark());
        self.domain.undo_to(mark);
        found
    }

    /// Fixes one integer near `value`; `false` when both sides contradict the domain.
    pub(super) fn fix_rounded(&mut self, j: usize, value: f64) -> bool {
        if self.domain.is_fixed(j) {
            return true;
        }
        let (lower, upper) = (self.domain.lower(j), self.domain.upper(j));
        let near = value.round().clamp(lower, upper);
        let other = if value > near { near + 1.0 } else { near - 1.0 };
        let other = if other < lower || other > upper { 2.0 * near - other } else { other };
        for candidate in [near, other] {
            if !candidate.is_finite() || candidate < lower || candidate > upper {
                continue;
            }
            let mark = self.domain.mark();
            self.domain.apply(j, false, candidate);
            self.domain.apply(j, true, candidate);
            let result = self.propagate_since(mark);
            if result.is_ok() {
                return true;
            }
            self.domain.undo_to(mark);
        }
        false
    }
}
