//! Children on trial, and what a trial leaves behind.
//!
//! A trial solves the relaxation of a child before the child exists. Its gain scores the split; a
//! trial that refutes its child closes it; its bound and its relaxed point go with the child, which
//! need not be solved again; and what propagation concludes in both children of a column holds in
//! their parent.

use super::branching::Split;
use super::node::{Decision, Known};
use super::node_relaxation::Verdict;
use super::worker::Worker;

/// Distance from the cutoff, relative to the bound, within which a trial's bound may be too rough
/// to prune with (no unit).
const NEAR_CUTOFF: f64 = 1e-4;

/// By how much a trial's point may leave the domain that its child has come to (no unit).
const OUTSIDE: f64 = 1e-6;

/// A child that a trial has left open.
#[derive(Debug, Clone)]
pub(super) struct Trial {
    /// Growth of the bound over the parent's.
    pub(super) gain: f64,
    /// Proved bound of the child.
    pub(super) bound: f64,
    /// The child's relaxed point, when there is one.
    pub(super) known: Option<Box<Known>>,
    /// Bounds of integral columns that propagation moved in the child.
    moved: Vec<Decision>,
}

/// What holds in both of two children: bounds that both moved, at the weaker of both values.
pub(super) fn common(one: &Trial, other: &Trial) -> Vec<Decision> {
    let mut facts = Vec::new();
    for a in &one.moved {
        let same = |b: &&Decision| (b.column, b.is_upper) == (a.column, a.is_upper);
        if let Some(b) = other.moved.iter().find(same) {
            let value = if a.is_upper { a.value.max(b.value) } else { a.value.min(b.value) };
            facts.push(Decision { value, ..*a });
        }
    }
    facts
}

impl Worker<'_> {
    /// Solves a child on trial and learns from it; nothing when it needs no visit.
    pub(super) fn try_child(
        &mut self,
        decision: Decision,
        value: f64,
        bound: f64,
    ) -> Option<Trial> {
        let mark = self.domain.mark();
        self.domain.apply(decision.column, decision.is_upper, decision.value);
        self.propagator.set_on_trial(true);
        let propagated = self.propagate_since(mark);
        self.propagator.set_on_trial(false);
        let mut point = Vec::new();
        let verdict = match propagated.ok().and_then(|()| self.project_node()) {
            Some(projection) => {
                self.on_trial = true;
                let verdict = self.relax(&projection.reduced, false);
                self.on_trial = false;
                if let Verdict::Relaxed { x, settled: true, .. } = &verdict {
                    point = self.complete_point(projection.lift(x));
                }
                verdict
            }
            None => Verdict::Refuted,
        };
        let moved = self.moved_since(mark, decision.column);
        self.domain.undo_to(mark);
        match verdict {
            Verdict::Refuted => {
                self.tree.count(|s| s.closed_by_trials += 1);
                None
            }
            Verdict::Relaxed { bound: child, .. } => {
                let fraction = (value - decision.value).abs();
                let gain = child - bound;
                self.pseudocosts.learn(decision.column, !decision.is_upper, gain, fraction);
                let child = self.tree.strengthen(child.min(self.cutoff));
                if child >= self.tree.cutoff() {
                    self.tree.count(|s| s.closed_by_trials += 1);
                    self.tree.close(child);
                    return None;
                }
                let known = (!point.is_empty()).then(|| Box::new(Known { point }));
                let gain = if gain.is_finite() { gain } else { 0.0 };
                Some(Trial { gain, bound: child, known, moved })
            }
            Verdict::Stopped | Verdict::Descent => {
                Some(Trial { gain: 0.0, bound: f64::NEG_INFINITY, known: None, moved })
            }
        }
    }

    /// The bounds of integral columns other than `except` that moved since a mark, as they are now.
    fn moved_since(&self, mark: usize, except: usize) -> Vec<Decision> {
        let mut moved: Vec<Decision> = Vec::new();
        let mut sides: Vec<(usize, bool)> = self
            .domain
            .changed_since(mark)
            .filter(|&(j, _)| j != except && self.task.program.integral[j])
            .collect();
        sides.sort_unstable();
        sides.dedup();
        moved.extend(sides.into_iter().map(|(column, is_upper)| {
            let [lower, upper] = self.domain.bounds(column);
            Decision { column, is_upper, value: if is_upper { upper } else { lower } }
        }));
        moved
    }

    /// Tightens the domain of the current node by what is known to hold in it. The facts become
    /// part of the path, so that the node's children have them too. Where the ends of the tree are
    /// kept they are left out: each would be an end of its own.
    pub(super) fn note_facts(&mut self, facts: &[Decision]) -> Result<(), Split> {
        if self.task.options.keep_leaves {
            return Ok(());
        }
        let (mark, known) = (self.domain.mark(), self.path.len());
        for fact in facts {
            if self.apply_if_news(fact) {
                self.path.push(*fact);
            }
        }
        if self.domain.mark() == mark || self.propagate_since(mark).is_ok() {
            return Ok(());
        }
        self.domain.undo_to(mark);
        self.path.truncate(known);
        Err(Split::nothing())
    }

    /// Whether a trial's point is good enough to be the relaxed point of the node of the domain.
    pub(super) fn may_reuse(&self, known: &Known, bound: f64) -> bool {
        let near = self.tree.cutoff() - bound <= NEAR_CUTOFF * bound.abs().max(1.0);
        let inside = || {
            known.point.iter().enumerate().all(|(j, &v)| {
                let [lower, upper] = self.domain.bounds(j);
                let slack = OUTSIDE * v.abs().max(1.0);
                v >= lower - slack && v <= upper + slack
            })
        };
        !near && inside()
    }
}
