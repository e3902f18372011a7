//! Diving: fix some integers, propagate, relax, and so on down to a point.
//!
//! Each step fixes half of the fractional integers and solves the relaxation again, roughly. What
//! is surest goes first: what is nearest to a whole value, what hardly moves the bound by the
//! pseudocosts, or what is nearest to the best point; dives take turns at these. A step that leads
//! nowhere is taken back once and done the other way. Dives are paid from an allowance, and a dive
//! whose allowance ends rounds what is left.

use super::node_relaxation::Verdict;
use super::purify::purify;
use super::trace::span;
use super::worker::Worker;
use crate::solution::Heuristic;

/// Iterations that must be left for a dive to begin.
const LEAST: u64 = 50;

/// Most relaxations of a dive.
const STEPS: usize = 20;

/// A step fixes one in so many of the fractional integers.
const PART: usize = 2;

/// What is surest.
#[derive(Debug, Clone, Copy)]
enum Guide {
    /// Nearest to a whole value.
    Fraction,
    /// The side that moves the bound less, by pseudocosts.
    Pseudocosts,
    /// Nearest to the best point.
    Incumbent,
}

/// An integer to fix: how sure it is (smaller is surer), the column, and a value on the side of the
/// whole one that is meant.
type Candidate = (f64, usize, f64);

impl Worker<'_> {
    /// Dives from the relaxed point of the current node, where the allowance has room for it.
    pub(super) fn dive_where_it_pays(&mut self, point: &[f64], bound: f64) {
        let cutoff = self.tree.cutoff();
        // Without an objective a plunge of the tree is a dive already.
        let free = cutoff == f64::INFINITY
            && self.tree.id == 0
            && !self.program().is_feasibility_problem();
        let left = self.accounts.diving.left(self.accounts.iterations, free);
        if left < LEAST || bound == f64::NEG_INFINITY || bound >= cutoff {
            return;
        }
        span!(DEBUG, "heuristic", name = "diving");
        let before = self.accounts.iterations;
        let source = self.tree.begin(Heuristic::Diving);
        self.dive(point, before + left);
        self.tree.end(source);
        let spent = self.accounts.iterations - before;
        self.accounts.diving.book(spent, self.tree.cutoff() < cutoff);
    }

    /// Dives until the worker has taken `last` iterations. The domain is left as it was.
    fn dive(&mut self, point: &[f64], last: u64) {
        let incumbent = self.tree.incumbent();
        let guide = match (self.accounts.diving.calls() % 3, &incumbent) {
            (0, _) => Guide::Pseudocosts,
            (1, Some(_)) => Guide::Incumbent,
            _ => Guide::Fraction,
        };
        let incumbent = incumbent.map(|(_, point)| point);
        let start = self.domain.mark();
        let mut point = point.to_vec();
        let mut turned_back = false;
        for _ in 0..STEPS {
            let candidates = self.candidates(&point, guide, incumbent.as_deref());
            let Some(&(_, first, value)) = candidates.first() else { break };
            let mark = self.domain.mark();
            let mut next = None;
            if candidates.iter().all(|&(_, j, value)| self.fix_rounded(j, value)) {
                next = self.relax_dive();
            }
            if next.is_none() && !turned_back && !self.token.is_over() {
                turned_back = true;
                self.domain.undo_to(mark);
                if self.exclude(first, value) {
                    next = self.relax_dive();
                }
            }
            let Some(found) = next else {
                self.domain.undo_to(start);
                return;
            };
            point = found;
            if self.is_leaf() || self.is_whole(&point) || self.accounts.iterations >= last {
                break;
            }
        }
        if self.is_whole(&point) {
            self.try_assignment(&point);
        } else {
            self.round_and_propagate(&point);
        }
        self.domain.undo_to(start);
    }

    /// The fractional integers that the next step fixes, the surest first.
    fn candidates(&self, point: &[f64], guide: Guide, best: Option<&[f64]>) -> Vec<Candidate> {
        let integrality = self.task.options.integrality;
        let distance = |j: usize| (point[j] - point[j].round()).abs();
        let fractional = self.own_integers().iter().copied().filter(|&j| distance(j) > integrality);
        let candidate = |j: usize| {
            let (x, below) = (point[j], point[j].floor());
            match (guide, best) {
                (Guide::Incumbent, Some(best)) => {
                    let aim = if best[j] > x { below + 0.75 } else { below + 0.25 };
                    ((x - best[j]).abs(), j, aim)
                }
                (Guide::Pseudocosts, _) => {
                    let [down, up] = self.pseudocosts.gains(j, x);
                    let aim = if up < down { below + 0.75 } else { below + 0.25 };
                    (down.min(up) / down.max(up), j, aim)
                }
                _ => (distance(j), j, x),
            }
        };
        let mut candidates: Vec<Candidate> = fractional.map(candidate).collect();
        candidates.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        candidates.truncate(candidates.len().div_ceil(PART));
        candidates
    }

    /// Excludes the side of a column that was meant; `false` where nothing is left then.
    fn exclude(&mut self, j: usize, value: f64) -> bool {
        let (near, mark) = (value.round(), self.domain.mark());
        let up = value > near;
        let beyond = if up { near + 1.0 } else { near - 1.0 };
        let [lower, upper] = self.domain.bounds(j);
        if beyond < lower || beyond > upper {
            return false;
        }
        self.domain.apply(j, !up, beyond);
        self.propagate_since(mark).is_ok()
    }

    /// The relaxed point of what the dive has come to; nothing where no better point is in there.
    fn relax_dive(&mut self) -> Option<Vec<f64>> {
        let projection = self.project_node()?;
        self.on_trial = true;
        let verdict = self.relax(&projection.reduced, false);
        self.on_trial = false;
        let Verdict::Relaxed { bound, x, .. } = verdict else { return None };
        if self.tree.strengthen(bound) >= self.tree.cutoff() {
            return None;
        }
        let mut point = self.complete_point(projection.lift(&x));
        let integrality = self.task.options.integrality;
        purify(self.task.program, &self.domain, self.groups, integrality, &mut point);
        Some(point)
    }
}
