//! Priorities, splits and points that the user knows: asked for, checked, and taken where they fit.

use std::borrow::Cow;

use super::branching::Split;
use super::worker::Worker;
use crate::error::Error;
use crate::model::Model;
use crate::presolve::root::Postsolve;
use crate::program::Program;
use crate::solution::Heuristic;
use crate::solver::{Guidance, NodeView, SplitAt};

/// A [`Guidance`] for the columns of a program whose first columns are the model's variables, or for
/// what presolve has left of them.
#[derive(Debug)]
pub struct Guide<'a> {
    model: &'a Model,
    /// By variable; empty where there are none.
    priorities: Vec<i32>,
    guidance: Guidance<'a>,
    origin: Option<Origin<'a>>,
}

/// Where the columns of a presolved program come from.
#[derive(Debug, Clone)]
struct Origin<'a> {
    postsolve: &'a Postsolve,
    /// Bounds of the original's columns.
    bounds: Vec<[f64; 2]>,
}

impl<'a> Guide<'a> {
    /// For a model, from what its user says.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`](crate::ErrorKind::ForeignHandle) for the priority of a variable
    /// of another model.
    pub fn new(model: &'a Model, guidance: &Guidance<'a>) -> Result<Self, Error> {
        let priorities = guidance.priorities(model)?;
        Ok(Guide { model, priorities, guidance: guidance.clone(), origin: None })
    }

    /// The same for what presolve has left of a program.
    pub fn presolved<'b>(&self, postsolve: &'b Postsolve, original: &Program) -> Guide<'b>
    where
        'a: 'b,
    {
        let bounds = if self.steers() {
            original.lower.iter().zip(&original.upper).map(|(&l, &u)| [l, u]).collect()
        } else {
            Vec::new()
        };
        Guide {
            model: self.model,
            priorities: self.priorities.clone(),
            guidance: self.guidance.clone(),
            origin: Some(Origin { postsolve, bounds }),
        }
    }

    /// Whether the user splits nodes.
    pub fn splits(&self) -> bool {
        self.guidance.branching().is_some()
    }

    /// Whether the user proposes points.
    pub fn proposes(&self) -> bool {
        !self.guidance.proposals().is_empty()
    }

    /// Bounds and values of the model's variables, and of what else there is.
    fn in_model<'x>(&self, bounds: Vec<[f64; 2]>, x: &'x [f64]) -> (Vec<[f64; 2]>, Cow<'x, [f64]>) {
        let Some(Origin { postsolve, bounds: original }) = &self.origin else {
            return (bounds, Cow::Borrowed(x));
        };
        let mut all = original.clone();
        for (&j, own) in postsolve.columns().iter().zip(bounds) {
            if let Some(entry) = all.get_mut(j) {
                *entry = own;
            }
        }
        (all, Cow::Owned(postsolve.point(x)))
    }

    /// Values of the model's variables as values of the program's columns.
    fn carried(&self, values: Vec<(usize, f64)>) -> Vec<(usize, f64)> {
        match &self.origin {
            Some(origin) => origin.postsolve.carry(&values),
            None => values,
        }
    }

    /// For a search inside the search: the same priorities, no questions.
    pub(super) fn idle(&self) -> Guide<'a> {
        let (model, priorities) = (self.model, self.priorities.clone());
        Guide { model, priorities, guidance: Guidance::default(), origin: self.origin.clone() }
    }

    /// Whether the user splits nodes or proposes points.
    pub(super) fn steers(&self) -> bool {
        self.splits() || self.proposes()
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
        let variable = match &self.origin {
            Some(origin) => origin.postsolve.columns().get(column).copied(),
            None => Some(column),
        };
        variable.and_then(|j| self.priorities.get(j)).copied().unwrap_or(0)
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
        let guide = self.task.guide;
        let (bounds, x) = guide.in_model(bounds, x);
        let node = NodeView::new(guide.model, &bounds, &x, self.path.len(), program.sign * bound);
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
            for (j, value) in self.task.guide.carried(proposed) {
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
