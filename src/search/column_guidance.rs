//! The user's priorities, splits and points, translated to columns and checked.

use std::borrow::Cow;
use std::fmt;

use crate::error::Error;
use crate::model::Model;
use crate::presolve::root::Postsolve;
use crate::program::Program;
use crate::solution::Point;
use crate::solver::{Branching, Guidance, NodeView, Proposal};

/// A [`Guidance`] for the columns of a program whose first columns are the model's variables, or for
/// what presolve has left of them.
#[derive(Debug)]
pub struct ColumnGuidance<'a> {
    model: &'a Model,
    /// By variable; empty if there are none.
    priorities: Vec<i32>,
    /// By variable of the model: whether it is an integer.
    integral: Vec<bool>,
    guidance: Guidance<'a>,
    origin: Option<Origin<'a>>,
    excludes: Option<Excludes<'a>>,
}

/// Whether a row that the user returns for a point excludes it.
#[derive(Clone, Copy)]
struct Excludes<'a>(&'a (dyn Fn(&Point) -> bool + Sync));

impl fmt::Debug for Excludes<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Excludes")
    }
}

/// Where the columns of a presolved program come from.
#[derive(Debug, Clone)]
struct Origin<'a> {
    postsolve: &'a Postsolve,
    /// Bounds of the original's columns.
    bounds: Vec<[f64; 2]>,
}

impl<'a> ColumnGuidance<'a> {
    /// For a model, from what its user says.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`](crate::ErrorKind::ForeignHandle) for the priority of a variable
    /// of another model.
    pub fn new(model: &'a Model, guidance: &Guidance<'a>) -> Result<Self, Error> {
        let priorities = guidance.priorities(model)?;
        let guidance = guidance.clone();
        let integral = model.variables().map(|variable| variable.kind().is_integral()).collect();
        let (origin, excludes) = (None, None);
        Ok(ColumnGuidance { model, priorities, integral, guidance, origin, excludes })
    }

    /// The same with a judge of verified points: whether rows that they tell of exclude them.
    pub(crate) fn with_judge(self, excludes: &'a (dyn Fn(&Point) -> bool + Sync)) -> Self {
        ColumnGuidance { excludes: Some(Excludes(excludes)), ..self }
    }

    /// Whether a verified point is excluded; the point is only computed if there is a judge.
    pub(super) fn excludes(&self, point: impl FnOnce() -> Option<Point>) -> bool {
        let judged = |Excludes(excludes)| point().is_none_or(|point| excludes(&point));
        self.excludes.is_some_and(judged)
    }

    /// The same for what presolve has left of a program.
    pub fn presolved<'b>(&self, postsolve: &'b Postsolve, original: &Program) -> ColumnGuidance<'b>
    where
        'a: 'b,
    {
        let bounds = if self.steers() {
            original.lower.iter().zip(&original.upper).map(|(&l, &u)| [l, u]).collect()
        } else {
            Vec::new()
        };
        ColumnGuidance {
            model: self.model,
            priorities: self.priorities.clone(),
            integral: self.integral.clone(),
            guidance: self.guidance.clone(),
            origin: Some(Origin { postsolve, bounds }),
            excludes: self.excludes,
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

    /// Whether a column is an integer of the model, and not an auxiliary one: these tell points apart.
    pub(super) fn tells_apart(&self, column: usize) -> bool {
        let variable = match &self.origin {
            Some(origin) => origin.postsolve.columns().get(column).copied(),
            None => Some(column),
        };
        variable.and_then(|j| self.integral.get(j)) == Some(&true)
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
    pub(super) fn carried(&self, values: Vec<(usize, f64)>) -> Vec<(usize, f64)> {
        match &self.origin {
            Some(origin) => origin.postsolve.carry(&values),
            None => values,
        }
    }

    /// For a search inside the search: the same priorities, no questions.
    pub(crate) fn idle(&self) -> ColumnGuidance<'a> {
        let (model, priorities) = (self.model, self.priorities.clone());
        ColumnGuidance {
            model,
            priorities,
            integral: self.integral.clone(),
            guidance: Guidance::default(),
            origin: self.origin.clone(),
            excludes: self.excludes,
        }
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

    /// The user's rule of branching.
    pub(super) fn branching(&self) -> Option<&'a dyn Branching> {
        self.guidance.branching()
    }

    /// The user's sources of points.
    pub(super) fn proposals(&self) -> &[&'a dyn Proposal] {
        self.guidance.proposals()
    }

    /// Shows a node in values of the model's variables, with the bounds of the columns behind them.
    ///
    /// # Arguments
    ///
    /// * `bounds`: of the program's columns at the node.
    /// * `x`: its relaxed point.
    /// * `bound`: its bound, in the model's own sense.
    pub(super) fn show<T>(
        &self,
        bounds: Vec<[f64; 2]>,
        x: &[f64],
        depth: usize,
        bound: f64,
        to: impl FnOnce(&NodeView<'_>, &[[f64; 2]]) -> T,
    ) -> T {
        let (bounds, x) = self.in_model(bounds, x);
        let node = NodeView::new(self.model, &bounds, &x, depth, bound);
        to(&node, &bounds)
    }
}
