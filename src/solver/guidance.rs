//! Guidance by the user: branching priorities, branching rules and points to try. It steers the
//! search but never affects the answer: bounds are proved and points verified as usual.

use std::fmt;

use crate::error::{Error, ErrorKind};
use crate::interval::Interval;
use crate::model::{Model, ModelTag, Variable};

/// Guidance for the search of one model, passed to
/// [`Control::with_guidance`](super::Control::with_guidance).
///
/// Backends ignore the parts that they cannot use; no answer depends on it.
///
/// ```
/// use carom::prelude::*;
/// use carom::solver::{Guidance, NodeView, SplitAt};
///
/// let mut model = Model::new("rooms");
/// let x = model.integer("x", 0.0, 9.0)?;
/// let y = model.integer("y", 0.0, 9.0)?;
/// model.add("both", (2.0 * x + 2.0 * y).within(7.0, 30.0))?;
/// model.minimize((x - 2.5).square() + (y - 2.5).square())?;
///
/// // x before y, and x first of all in the middle of its range.
/// let halve = |node: &NodeView<'_>| {
///     let range = node.bounds(x).ok()?;
///     (range.upper - range.lower >= 8.0).then_some(SplitAt::new(x, 4.0))
/// };
/// let guidance = Guidance::default().with_priority(x, 1).with_branching(&halve);
/// let mut control = Control::default().with_guidance(guidance);
/// let solution = BranchAndBound::default().solve_with(&model, &mut control)?;
/// assert!(solution.is_optimal());
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Clone, Default)]
#[must_use]
pub struct Guidance<'a> {
    priorities: Vec<(Variable, i32)>,
    branching: Option<&'a dyn Branching>,
    proposals: Vec<&'a dyn Proposal>,
}

impl<'a> Guidance<'a> {
    /// Sets the branching priority of an integer variable: it is split before variables with a
    /// lower priority if its relaxed value is fractional. The default priority is 0, and the last
    /// call counts. Priorities of continuous variables are ignored.
    pub fn with_priority(mut self, variable: Variable, priority: i32) -> Self {
        self.priorities.push((variable, priority));
        self
    }

    /// Sets the branching rule, which is called at every node that is to be split.
    pub fn with_branching(mut self, branching: &'a dyn Branching) -> Self {
        self.branching = Some(branching);
        self
    }

    /// Adds a source of integer values to try, at the root and occasionally below it. Several
    /// sources take turns.
    pub fn with_proposal(mut self, proposal: &'a dyn Proposal) -> Self {
        self.proposals.push(proposal);
        self
    }

    /// Priorities by variable, in the order of creation, for backends; empty if there are none.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`] for a variable of another model.
    pub fn priorities(&self, model: &Model) -> Result<Vec<i32>, Error> {
        if self.priorities.is_empty() {
            return Ok(Vec::new());
        }
        let mut priorities = vec![0; model.variable_count()];
        for &(variable, priority) in &self.priorities {
            let known = variable.tag == model.tag();
            let entry = priorities.get_mut(variable.index()).filter(|_| known);
            *entry.ok_or_else(|| foreign(variable, "a priority"))? = priority;
        }
        Ok(priorities)
    }

    /// The branching rule, for backends.
    pub fn branching(&self) -> Option<&'a dyn Branching> {
        self.branching
    }

    /// The sources of values to try, for backends.
    pub fn proposals(&self) -> &[&'a dyn Proposal] {
        &self.proposals
    }
}

impl fmt::Debug for Guidance<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Guidance")
            .field("priorities", &self.priorities)
            .field("branching", &self.branching.is_some())
            .field("proposals", &self.proposals.len())
            .finish()
    }
}

/// A rule for splitting nodes; closures are rules too.
///
/// It may be called from several threads at the same time. For a deterministic search, its answer
/// must depend only on the node.
pub trait Branching: Sync {
    /// Where to split a node, or `None` for the backend's own rule.
    ///
    /// A split that does not divide the node is refused: if the variable is continuous, fixed or of
    /// another model, or if the value is NaN or outside the bounds. Refused splits are counted in
    /// [`Statistics::refused_splits`](crate::solution::Statistics::refused_splits).
    fn split(&self, node: &NodeView<'_>) -> Option<SplitAt>;
}

impl<F: Fn(&NodeView<'_>) -> Option<SplitAt> + Sync> Branching for F {
    fn split(&self, node: &NodeView<'_>) -> Option<SplitAt> {
        self(node)
    }
}

/// A source of points: values of integers to try, such as the modes of a simulated roll-out;
/// closures are sources too.
///
/// The backend fixes the values one after the other unless they contradict each other, completes
/// the rest, and verifies the point. The results are counted in
/// [`Statistics::heuristics`](crate::solution::Statistics::heuristics), under
/// [`Heuristic::Proposal`](crate::solution::Heuristic::Proposal).
pub trait Proposal: Sync {
    /// Values for some integers, in the order in which to fix them. Fractional values are rounded.
    /// Entries with continuous variables, variables of another model or NaN are ignored.
    fn propose(&self, node: &NodeView<'_>) -> Vec<(Variable, f64)>;
}

impl<F: Fn(&NodeView<'_>) -> Vec<(Variable, f64)> + Sync> Proposal for F {
    fn propose(&self, node: &NodeView<'_>) -> Vec<(Variable, f64)> {
        self(node)
    }
}

/// A split of a node into `variable <= floor(value)` and `variable >= floor(value) + 1`.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SplitAt {
    /// An integer variable.
    pub variable: Variable,
    /// The largest value of the lower part, rounded down. At the upper bound, the last integer
    /// below it is used.
    pub value: f64,
}

impl SplitAt {
    /// A split of `variable` at `value`.
    pub fn new(variable: Variable, value: f64) -> Self {
        SplitAt { variable, value }
    }
}

/// A node as a rule sees it.
#[derive(Debug, Clone, Copy)]
pub struct NodeView<'a> {
    tag: ModelTag,
    bounds: &'a [[f64; 2]],
    values: &'a [f64],
    depth: usize,
    bound: f64,
}

impl<'a> NodeView<'a> {
    /// A node, for backends.
    ///
    /// # Arguments
    ///
    /// * `bounds`, `values`: of the variables, in the order of creation; further entries are
    ///   ignored
    /// * `depth`: decisions from the root
    /// * `bound`: proved bound of the node's objective, in the model's own sense
    pub fn new(
        model: &Model,
        bounds: &'a [[f64; 2]],
        values: &'a [f64],
        depth: usize,
        bound: f64,
    ) -> Self {
        let count = model.variable_count();
        let bounds = bounds.get(..count).unwrap_or(bounds);
        NodeView { tag: model.tag(), bounds, values, depth, bound }
    }

    /// The bounds of a variable at the node, after propagation.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`] for a variable of another model.
    pub fn bounds(&self, variable: Variable) -> Result<Interval, Error> {
        let entry = self.bounds.get(variable.index()).filter(|_| variable.tag == self.tag);
        let [lower, upper] = *entry.ok_or_else(|| foreign(variable, "a node"))?;
        Ok(Interval { lower, upper })
    }

    /// The value of a variable in the node's relaxation, clamped to its bounds, which may have
    /// become tighter since; the middle of its bounds if the relaxation has no value.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::ForeignHandle`] for a variable of another model.
    pub fn value(&self, variable: Variable) -> Result<f64, Error> {
        let bounds = self.bounds(variable)?;
        let middle = 0.5 * (bounds.lower + bounds.upper);
        let value = self.values.get(variable.index()).copied().unwrap_or(middle);
        Ok(value.max(bounds.lower).min(bounds.upper))
    }

    /// Decisions from the root to the node.
    pub fn depth(&self) -> usize {
        self.depth
    }

    /// Proved bound of the objective at the node, in the model's own sense; infinite if there is
    /// none.
    pub fn bound(&self) -> f64 {
        self.bound
    }

    /// The column of a variable of this node's model.
    pub(crate) fn column(&self, variable: Variable) -> Option<usize> {
        let known = variable.tag == self.tag && variable.index() < self.bounds.len();
        known.then(|| variable.index())
    }
}

fn foreign(variable: Variable, place: &str) -> Error {
    let (kind, index) = ("variable", variable.index());
    Error::from(ErrorKind::ForeignHandle { kind, index, place: place.to_owned() })
}
