//! MIP starts: values of integers from which a search begins.

use crate::model::Variable;
use crate::solution::Solution;

/// A MIP start: values of some integers, from an earlier solve or a guess.
///
/// It is not trusted. The values are fixed as far as they do not contradict the model, the rest is
/// completed, and the point is verified like any other. So a start never changes the status or the
/// optimum, only the search. [`Solution::start_report`] tells what became of it.
///
/// A controller with a receding horizon repeatedly solves nearly the same program. It shifts the
/// result of the previous solve by one step:
///
/// ```
/// use carom::prelude::*;
/// use carom::solution::StartStatus;
/// use carom::solver::MipStart;
///
/// /// Reach the goal with few switches; the state at the beginning is a parameter.
/// let mut model = Model::new("horizon");
/// let steps = 8;
/// let x = model.continuous_family("x", steps + 1, -20.0, 20.0)?;
/// let up = model.binary_family("up", steps)?;
/// let start = model.parameter("start", 4.0, -10.0, 10.0)?;
/// model.add("start", (x[0] - start).equals(0.0))?;
/// for t in 0..steps {
///     model.add(("step", t), (x[t + 1] - x[t] - 3.0 * up[t]).equals(-1.2))?;
/// }
/// model.minimize((0..=steps).map(|t| (x[t] - 0.3).square()).sum::<Quadratic>())?;
///
/// let mut solver = BranchAndBound::default();
/// let first = solver.solve(&model)?;
///
/// // One step later: the plan's second state is the first one, and all decisions move by one.
/// let next = first.value(x[1])?;
/// model.set_parameter(start, next)?;
/// let earlier = |v: Variable| up.iter().position(|u| u == v)?.checked_sub(1).map(|t| up[t]);
/// let moved = MipStart::of(&first, up.iter()).mapped(earlier);
/// let mut control = Control::default().with_start(&moved);
/// let second = solver.solve_with(&model, &mut control)?;
///
/// assert!(second.is_optimal());
/// let report = second.start_report().unwrap();
/// assert_eq!(report.status, Some(StartStatus::Accepted));
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MipStart {
    /// Values of some integer variables, the most certain ones first. If all of them together lead
    /// to no point, the first half is tried, and then the first quarter.
    pub values: Vec<(Variable, f64)>,
}

impl MipStart {
    /// An empty start.
    pub fn new() -> Self {
        MipStart::default()
    }

    /// A start from a solution: the values of the given integer variables at its point, if there is
    /// one.
    pub fn of(solution: &Solution, integers: impl IntoIterator<Item = Variable>) -> Self {
        let value = |variable| Some((variable, solution.value(variable).ok()?));
        MipStart { values: integers.into_iter().filter_map(value).collect() }
    }

    /// Sets the values.
    #[must_use]
    pub fn with_values(mut self, values: impl IntoIterator<Item = (Variable, f64)>) -> Self {
        self.values = values.into_iter().collect();
        self
    }

    /// The start over other variables: `to` maps each variable to its replacement, or to `None` to
    /// drop its value.
    #[must_use]
    pub fn mapped(&self, to: impl Fn(Variable) -> Option<Variable>) -> Self {
        let moved = |&(variable, value): &(Variable, f64)| Some((to(variable)?, value));
        MipStart { values: self.values.iter().filter_map(moved).collect() }
    }
}
