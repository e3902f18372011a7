//! Priorities, splits and points that the user knows: asked for, checked, and taken where they fit.

use super::branching::Split;
use super::worker::Worker;
use crate::error::Error;
use crate::model::Model;
use crate::program::Program;
use crate::solution::Heuristic;
use crate::solver::{Guidance, NodeView, SplitAt};

/// A [`Guidance`] for the columns of a program whose first columns are the model's variables.
#[derive(Debug)]
pub struct Guide<'a> {
    model: &'a Model,
    /// By variable; empty where there are none.
    priorities: Vec<i32>,
    guidance: Guidance<'a>,
}

impl<'a> Guide<'a> {
    /// For a model, from what its user says.
    ///
    /// # Errors
    ///
    /// [`Error::ForeignHandle`] for the priority of a variable of another model.
    pub fn new(model: &'a Model, guidance: &Guidance<'a>) -> Result<Self, Error> {
        let priorities = guidance.priorities(model)?;
        Ok(Guide { model, priorities, guidance: guidance.clone() })
    }

    /// For a search inside the search: the same priorities, no questions.
    pub(super) fn idle(&self) -> Guide<'a> {
        let (model, priorities) = (self.model, self.priorities.clone());
        Guide { model, priorities, guidance: Guidance::default() }
    }

    /// Whether the user splits nodes or proposes points.
    pub(super) fn steers(&self) -> bool {
        self.guidance.branching().is_some() || !self.guidance.proposals().is_empty()
    }

    /// Whether the user says nothing.
    pub fn is_idle(&self) -> bool {
        !self.steers() && !self.has_priorities()
    }

    /// Whether some columns go before others.
    pub(super) fn has_priorities(&self) -> bool {
        !self.priorities.is_empty()
    }

    /// The priority of a column; auxiliary ones have that of variables without.
    pub(super) fn priority(&self, column: usize) -> i32 {
        self.priorities.get(column).copied().unwrap_or(0)
    }
}

/// By how much a value may be outside the bounds (no unit).
const HAIR: f64 = 1e-6;

/// The split in columns, where it divides a node: the column, and the last value of the lower part.
fn checked(
    program: &Program,
    node: &NodeView<'_>,
    bounds: &[[f64; 2]],
    split: SplitAt,
) -> Option<(usize, f64)> {
    let column = node.column(split.variable)?;
    let [lower, upper] = *bounds.get(column)?;
    // Relaxed values leave their bounds by a hair, and one at the upper bound means the last whole
    // value before it.
    let inside = lower - HAIR <= split.value && split.value <= upper + HAIR;
    let divides = program.integral[column] && lower < upper && split.value.is_finite() && inside;
    divides.then(|| (column, split.value.floor().max(lower).min(upper - 1.0)))
}

impl Worker<'_> {
    /// Shows the current node to whoever wants to see it.
    fn show<T>(
        &self,
        x: &[f64],
        bound: f64,
        to: impl FnOnce(&NodeView<'_>, &[[f64; 2]]) -> T,
    ) -> T {
        let program = self.program();
        let bounds: Vec<[f64; 2]> =
            (0..program.column_count()).map(|j| self.domain.bounds(j)).collect();
        let model = self.task.guide.model;
        let node = NodeView::new(model, &bounds, x, self.path.len(), program.sign * bound);
        to(&node, &bounds)
    }

    /// The split that the user wants, where it divides the current node.
    pub(super) fn split_of_user(&self, x: &[f64], bound: f64) -> Option<Split> {
        let rule = self.task.guide.guidance.branching()?;
        let (asked, found) = self.show(x, bound, |node, bounds| {
            let split = rule.split(node);
            (split.is_some(), split.and_then(|s| checked(self.program(), node, bounds, s)))
        });
        self.tree.count(|s| match (asked, &found) {
            (_, Some(_)) => s.user_splits += 1,
            (true, None) => s.refused_splits += 1,
            (false, None) => {}
        });
        let (column, value) = found?;
        Some(Split::at(column, value, x[column], bound))
    }

    /// Tries the points that the user proposes at the current node. The domain is left as it was.
    pub(super) fn try_proposals(&mut self, x: &[f64], bound: f64) {
        for source in self.task.guide.guidance.proposals() {
            let before = self.tree.begin(Heuristic::Proposal);
            let proposed = self.show(x, bound, |node, _| {
                let columns = source.propose(node).into_iter();
                let known = columns.filter_map(|(v, value)| node.column(v).map(|j| (j, value)));
                known.collect::<Vec<_>>()
            });
            let mark = self.domain.mark();
            for (j, value) in proposed {
                if self.program().integral[j] && value.is_finite() {
                    self.fix_guessed(j, value);
                }
            }
            self.round_and_propagate(x);
            self.domain.undo_to(mark);
            self.tree.end(before);
        }
    }
}
